// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "evaluate/simulation/operated_session.h"

namespace plumbline {

TargetShape bentBoard(double bend_mm) {
  TargetShape shape;
  if (bend_mm == 0) return shape;  // even, with the size that it states
  const auto set = [&](const std::string& name, double value) {
    const auto found = std::find(kTargetTermNames.begin(), kTargetTermNames.end(), name);
    shape.terms[found - kTargetTermNames.begin()] = value;
  };
  // Terms have unit RMS over the corners, so that a bow of bend_mm is its RMS.
  set("z_xx", 1e-3 * bend_mm);
  set("z_yy", -0.5e-3 * bend_mm);
  set("stretch", 0.1e-3);
  return shape;
}

std::string suggestionsCsv(const std::vector<Suggestion>& suggestions) {
  std::string text = "#t_ns,stage,id,tx [m],ty [m],tz [m],qx,qy,qz,qw,camera\n";
  for (const Suggestion& s : suggestions) {
    const Eigen::Quaterniond q = s.T_FC0.quaternion();
    fmt::format_to(std::back_inserter(text),
                   "{},{},{},{:.9g},{:.9g},{:.9g},{:.12g},{:.12g},{:.12g},{:.12g},{}\n", s.t,
                   toString(s.stage), s.id, s.T_FC0.t.x(), s.T_FC0.t.y(), s.T_FC0.t.z(), q.x(),
                   q.y(), q.z(), q.w(), s.camera);
  }
  return text;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/trajectory/trajectory_writer.h"

#include <iterator>
#include <string>

#include <fmt/format.h>

#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

// Seconds with nine decimals from the integer; the sign stands before both parts.
void appendStamp(std::string& out, TimeNs t) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  const std::uint64_t magnitude =
      t < 0 ? 0 - static_cast<std::uint64_t>(t) : static_cast<std::uint64_t>(t);
  fmt::format_to(std::back_inserter(out), "{}{}.{:09}", t < 0 ? "-" : "", magnitude / kSecond,
                 magnitude % kSecond);
}

}  // namespace

void writeTum(const std::filesystem::path& path, const Trajectory& trajectory) {
  std::string out = "# timestamp [s] tx ty tz qx qy qz qw\n";
  out.reserve(out.size() + trajectory.poses.size() * 190);
  for (const StampedPose& pose : trajectory.poses) {
    appendStamp(out, pose.t);
    fmt::format_to(std::back_inserter(out),
                   " {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", pose.p.x(),
                   pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
  }
  writeFileAtomically(path.string(), out);
}

}  // namespace plumbline

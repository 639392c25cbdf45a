// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's poses-cam0.csv, under EuRoC's header, which is wrong about their quaternions.
#include <algorithm>
#include <string_view>
#include <vector>

#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

/// Kalibr writes the quaternion with a scalar that is not negative: where that passes zero, the
/// other three change sign between two rows. In an honest file the last column changes with them.
bool lastIsScalar(const std::vector<StampedPose>& poses) {
  const auto jumps = [](const StampedPose& a, const StampedPose& b) { return a.q.dot(b.q) < 0; };
  const auto negative = [](const StampedPose& pose) { return pose.q.z() < 0; };
  return std::ranges::none_of(poses, negative) &&
         std::ranges::adjacent_find(poses, jumps) != poses.end();
}

}  // namespace

bool isKalibrPosesHeader(std::string_view line) {
  return line.starts_with("#timestamp, p_RS_R_x ") && csvCells(line).size() == 8;
}

void readAsKalibrs(std::vector<StampedPose>& poses) {
  // The columns a, b, c, d, taken as w, x, y, z, are x, y, z, w of the conjugate.
  for (StampedPose& pose : poses) {
    pose.q = {pose.q.z(), -pose.q.w(), -pose.q.x(), -pose.q.y()};
  }
}

void correctKalibrPoses(const TrajectorySource& source, TrajectoryFile& file) {
  TextLines lines(source.text);
  if (!lines.next() || !isKalibrPosesHeader(lines.text())) return;
  if (!lastIsScalar(file.trajectory.poses)) return;
  readAsKalibrs(file.trajectory.poses);
  file.remarks.push_back(
      "quaternions are read as Kalibr writes them under this header: x y z w of the conjugate, "
      "since only the last column never changes sign");
}

}  // namespace plumbline

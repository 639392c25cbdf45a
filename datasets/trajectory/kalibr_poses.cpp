// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's poses-cam0.csv, under EuRoC's header, which is wrong about their quaternions.
#include <algorithm>
#include <string_view>
#include <vector>

#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

bool lastIsNegative(const StampedPose& pose) { return pose.q.z() < 0; }

bool jumps(const StampedPose& a, const StampedPose& b) { return a.q.dot(b.q) < 0; }

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
  std::vector<StampedPose>& poses = file.trajectory.poses;
  // Kalibr writes a scalar that is not negative: where that passes zero, the other three change
  // sign between two rows. In an honest file the last column changes with them.
  if (std::ranges::any_of(poses, lastIsNegative)) return;
  if (std::ranges::adjacent_find(poses, jumps) == poses.end()) {
    file.remarks.push_back(
        "quaternions are read as the header says, w x y z, which nothing confirms: Kalibr writes x "
        "y z w of the conjugate under the same header, and no change of sign tells which; if this "
        "file is Kalibr's, the orientations are wrong");
    return;
  }
  readAsKalibrs(poses);
  file.remarks.push_back(
      "quaternions are read as Kalibr writes them under this header: x y z w of the conjugate, "
      "since only the last column never changes sign");
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/files/bad_input.h"
#include "datasets/trajectory/trajectory_reader.h"

namespace plumbline {
namespace {

constexpr double kLooking = 0.8;  // share of poses that must look at the target
constexpr double kSharper = 0.5;  // an order that brings the aims this much closer is the right one

// Where the optical axis meets the target's plane; nothing where it points away from it.
std::optional<Eigen::Vector2d> aimOf(const StampedPose& pose) {
  const Eigen::Vector3d axis = pose.transform().R.col(2);
  // The target's plane is z = 0 in F.
  const double depth = -pose.p.z() / axis.z();
  if (!(depth > 0)) return std::nullopt;
  return (pose.p + depth * axis).head<2>();
}

// How the optical axes meet the target's plane: how many do, and how far apart.
struct Aim {
  double share = 0;
  double spread_m = 0;  // median distance from the median point
};

Aim aimOf(const std::vector<StampedPose>& poses) {
  std::vector<double> x;
  std::vector<double> y;
  for (const StampedPose& pose : poses) {
    if (const auto at = aimOf(pose)) {
      x.push_back(at->x());
      y.push_back(at->y());
    }
  }
  if (x.empty()) return {};
  const Eigen::Vector2d centre(median(x), median(y));
  std::vector<double> distances;
  for (std::size_t i = 0; i < x.size(); ++i) {
    distances.push_back((Eigen::Vector2d(x[i], y[i]) - centre).norm());
  }
  return {static_cast<double>(x.size()) / static_cast<double>(poses.size()), median(distances)};
}

// Cameras that see the target aim at it, more or less at one place. Smoothness would not tell: both
// readings of the columns turn by the same angles between poses, as a quaternion's components only
// change place and sign.
void requireLooking(const std::string& path, const Aim& aim, const Aim& other) {
  const bool other_is_better = other.share >= kLooking && other.spread_m < kSharper * aim.spread_m;
  if (aim.share >= kLooking && !other_is_better) return;
  throw badInput(
      path,
      {InputFault::kContradiction,
       fmt::format("{:.0f} % of the camera poses look at the target, at points {:.2f} m apart{}",
                   100 * aim.share, aim.spread_m,
                   other_is_better
                       ? fmt::format("; read as the header says, {:.2f} m apart", other.spread_m)
                       : std::string()),
       "quaternions as Kalibr writes them: x, y, z, w of the conjugate, under a header that says "
       "w, x, y, z",
       "if another tool wrote this file, or its columns were corrected, read it as a trajectory"});
}

}  // namespace

TrajectoryFile readKalibrPoses(const std::string& path) {
  // By the header, or as EuRoC has the columns where there is none.
  TrajectoryFile file =
      readTrajectory(path, {.format = TrajectoryFormat::kEuroc, .gaps_are_usual = true});
  std::vector<StampedPose>& poses = file.trajectory.poses;
  const Aim as_stated = aimOf(poses);
  readAsKalibrs(poses);
  requireLooking(path, aimOf(poses), as_stated);
  return file;
}

}  // namespace plumbline

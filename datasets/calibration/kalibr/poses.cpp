// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"

namespace plumbline {
namespace {

constexpr const char* kRow = "stamp [ns], p x y z [m] and a quaternion, separated by commas";
constexpr double kUnitTolerance = 1e-3;
constexpr double kLooking = 0.8;  // share of poses that must look at the target
constexpr double kSharper = 0.5;  // an order that brings the aims this much closer is the right one

StampedPose poseOf(TextTable& table) {
  const NumberRow row = table.numbers();
  table.expectColumns(row, 8, kRow);
  const auto t = parseStamp(row.stamp, 0);
  if (!t) throw table.fault({InputFault::kBadNumber, "the stamp is not a time", kRow});
  const double* const v = &row.values[1];
  if (!std::all_of(v, v + 7, [](double value) { return std::isfinite(value); })) {
    throw table.fault({InputFault::kNotFinite, "the pose is not finite (nan or inf)", kRow});
  }
  // The quaternion: x, y, z, w of the conjugate, whatever the header says.
  const StampedPose pose{*t, {v[0], v[1], v[2]}, {v[6], -v[3], -v[4], -v[5]}};
  if (std::abs(pose.q.norm() - 1) > kUnitTolerance) {
    throw table.fault({InputFault::kNotRigid,
                       fmt::format("the quaternion's length is {:.4f}", pose.q.norm()), "1"});
  }
  return pose;
}

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

// The four columns taken as the header names them: w, x, y, z.
std::vector<StampedPose> asTheHeaderSays(std::vector<StampedPose> poses) {
  for (StampedPose& pose : poses) {
    const Eigen::Quaterniond& q = pose.q;
    // poseOf() undone: the columns a, b, c, d are w = d and (x, y, z) = (-a, -b, -c) there.
    pose.q = Eigen::Quaterniond(-q.x(), -q.y(), -q.z(), q.w());
  }
  return poses;
}

// Cameras that see the target aim at it, more or less at one place. Smoothness would not tell: both
// readings of the columns turn by the same angles between poses, as a quaternion's components only
// change place and sign.
void requireLooking(const std::string& path, const Trajectory& trajectory) {
  const Aim aim = aimOf(trajectory.poses);
  const Aim other = aimOf(asTheHeaderSays(trajectory.poses));
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

Trajectory readKalibrPoses(const std::string& path) {
  const MappedFile file(path);
  TextTable table(path, file.text(), kRow);
  Trajectory trajectory;
  trajectory.name = std::filesystem::path(path).stem().string();
  while (table.nextRow()) {
    trajectory.poses.push_back(poseOf(table));
    const auto& poses = trajectory.poses;
    if (poses.size() > 1 && poses.back().t <= poses[poses.size() - 2].t) {
      throw table.fault({InputFault::kBadOrder, "the stamps do not ascend", "ascending stamps"});
    }
  }
  if (trajectory.poses.empty())
    throw badInput(path, {InputFault::kEmpty, "contains no poses", kRow});
  requireLooking(path, trajectory);
  return trajectory;
}

}  // namespace plumbline

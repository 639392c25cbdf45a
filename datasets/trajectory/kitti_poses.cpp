// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

constexpr int kPoseColumns = 12;
// Poses that were written with few digits pass; a scaled matrix, or one in another order, is far
// beyond.
constexpr double kOrthonormal = 1e-2;  // largest entry of R^T R - I

std::vector<TimeNs> readTimes(const std::string& path) {
  const MappedFile file(path);
  TextTable table(path, file.text());
  std::vector<TimeNs> times;
  while (table.nextRow()) {
    const std::optional<TimeNs> t = parseStamp(table.row(), 9);
    if (!t) {
      throw table.fault({InputFault::kBadNumber, "is not a stamp", "one number of seconds a line",
                         "give KITTI's times.txt of the same sequence"});
    }
    times.push_back(*t);
  }
  return times;
}

// The upper three rows of T_WB, row by row: the camera's pose in its first frame (readme of KITTI's
// odometry devkit).
StampedPose poseOf(const TextTable& table, const NumberRow& row) {
  table.expectColumns(row, kPoseColumns, "the 3x4 matrix of KITTI's poses");
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(row.values.data());
  const Eigen::Matrix3d R = T.leftCols<3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!T.allFinite()) {
    throw table.fault({InputFault::kNotFinite, "the pose is not finite (nan or inf)",
                       "12 finite numbers", "the estimator diverged here: delete these rows"});
  }
  if (!(deviation <= kOrthonormal && R.determinant() > 0)) {
    throw table.fault({InputFault::kNotRigid, "the 3x3 block is not a rotation",
                       "an orthonormal matrix", "are the numbers the 3x4 matrix row by row?"});
  }
  // The stamp comes with readKitti(), which knows the row's place.
  return {0, T.col(3), Eigen::Quaterniond(R).normalized()};
}

/// KITTI's poses have no stamps: those of times.txt [s], or a second a frame, which is said.
std::vector<TimeNs> stampsFor(const TrajectorySource& source, std::size_t poses,
                              const std::string& times_path) {
  constexpr TimeNs kSecond = 1'000'000'000;
  std::vector<TimeNs> times;
  if (!times_path.empty()) times = readTimes(times_path);
  while (times_path.empty() && times.size() < poses) times.push_back(std::ssize(times) * kSecond);
  if (times.size() == poses) return times;
  throw badInput(
      times_path,
      {InputFault::kContradiction,
       fmt::format("has {} stamps for the {} poses of {}", times.size(), poses, source.path),
       "one stamp for each pose", "give the times.txt of the same sequence"});
}

}  // namespace

TrajectoryFile readKitti(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  std::vector<std::pair<StampedPose, int>> rows;  // with their lines
  TextTable table(source.path, source.text);
  while (table.nextRow()) rows.emplace_back(poseOf(table, table.numbers()), table.line());
  const std::vector<TimeNs> times = stampsFor(source, rows.size(), options.times.string());
  TrajectoryBuilder builder(source, TrajectoryFormat::kKitti, true);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [pose, line] = rows[i];
    builder.add({times[i], pose.p, pose.q}, line);
  }
  if (options.times.empty()) {
    builder.remark("the poses have no stamps: frame i is taken at i seconds");
  }
  // Seconds by the format alone, and no header can state another unit.
  StampUnit seconds;
  seconds.has_header = false;
  const TrajectorySource stamps{options.times.string(), {}};
  if (!options.times.empty()) checkPoseIntervals(stamps, builder.poses(), seconds, 1);
  return std::move(builder).finish();
}

}  // namespace plumbline

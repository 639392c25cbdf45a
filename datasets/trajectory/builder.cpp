// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

constexpr TimeNs kGapFactor = 10;  // a gap is so many times the median interval

/// The gaps of a trajectory in a sentence, by its own median interval; "" where there is none.
std::string gapRemark(const std::vector<StampedPose>& poses) {
  // Two poses have one interval, which is its own median.
  if (poses.size() < 3) return {};
  const TimeNs shortest = kGapFactor * medianInterval(poses);
  int gaps = 0;
  std::size_t longest = 1;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].t - poses[i - 1].t > shortest) ++gaps;
    if (poses[i].t - poses[i - 1].t > poses[longest].t - poses[longest - 1].t) longest = i;
  }
  if (gaps == 0 || shortest == 0) return {};
  return fmt::format(
      "{} gap{} longer than {} usual intervals; the longest is {:.3f} s, {:.3f} s "
      "after the first pose",
      gaps, gaps == 1 ? "" : "s", kGapFactor,
      secondsBetween(poses[longest - 1].t, poses[longest].t),
      secondsBetween(poses.front().t, poses[longest - 1].t));
}

bool isFinite(const StampedPose& pose) { return pose.p.allFinite() && pose.q.coeffs().allFinite(); }

}  // namespace

TimeNs medianInterval(const std::vector<StampedPose>& poses) {
  std::vector<TimeNs> intervals(poses.size() - 1);
  for (std::size_t i = 1; i < poses.size(); ++i) intervals[i - 1] = poses[i].t - poses[i - 1].t;
  return middleOf(std::move(intervals));
}

TrajectoryBuilder::TrajectoryBuilder(const TrajectorySource& source, TrajectoryFormat format,
                                     bool has_orientation)
    : source_(source) {
  file_.format = format;
  file_.trajectory.name = std::filesystem::path(source.path).stem().string();
  file_.trajectory.has_orientation = has_orientation;
}

void TrajectoryBuilder::add(const StampedPose& pose, int line) {
  if (!isFinite(pose)) {
    throw source_.fault(line, {InputFault::kNotFinite, "the pose is not finite (nan or inf)",
                               "seven finite numbers",
                               "the estimator diverged or lost track here: delete these rows"});
  }
  const double norm = pose.q.norm();
  // Before the length, as its cause is another: a source without an orientation here.
  if (norm == 0) {
    throw source_.fault(line,
                        {InputFault::kNotRigid, "the quaternion is all zeros", "a unit quaternion",
                         "the source had no orientation here: delete these rows"});
  }
  if (!(std::abs(norm - 1) <= kQuaternionTolerance)) {
    throw source_.fault(
        line, {InputFault::kNotRigid, fmt::format("the quaternion's length is {:.6g}", norm),
               fmt::format("a unit quaternion within {}", kQuaternionTolerance),
               "are the columns in another order, or are these Euler angles?"});
  }
  checkOrder(pose, line);
  if (first_line_ == 0) first_line_ = line;
  file_.trajectory.poses.push_back(pose);
}

void TrajectoryBuilder::checkOrder(const StampedPose& pose, int line) {
  constexpr TimeNs kFarthest = TimeNs{1} << 62;  // so that every difference of two is a TimeNs
  if (pose.t < -kFarthest || pose.t > kFarthest) {
    throw source_.fault(line, {InputFault::kOutOfRange, "the stamp is not a time",
                               "a stamp within 146 years of 0", "repair or delete this line"});
  }
  // Equal stamps pass with a remark; one that goes back is refused.
  if (poses().empty() || pose.t > poses().back().t) return;
  if (pose.t < poses().back().t) {
    throw source_.fault(line,
                        {InputFault::kBadOrder,
                         fmt::format("the stamp is {:.9f} s before that of the pose before it",
                                     secondsBetween(pose.t, poses().back().t)),
                         "stamps that do not descend",
                         "sort the rows by time; or were two runs written into one file?"});
  }
  if (equal_stamps_++ == 0) equal_line_ = line;
}

TrajectoryFile TrajectoryBuilder::finish() && {
  if (poses().empty()) {
    throw source_.fault(
        0, {InputFault::kEmpty, source_.text.empty() ? "is empty" : "has no poses", "rows of poses",
            "was the recording or the copy interrupted? Export the file again"});
  }
  if (equal_stamps_ > 0) {
    remark(fmt::format("{} pose{} the stamp of the pose before (first in line {})", equal_stamps_,
                       equal_stamps_ == 1 ? " has" : "s have", equal_line_));
  }
  if (std::string gaps = gapRemark(poses()); !gaps.empty()) remark(std::move(gaps));
  return std::move(file_);
}

}  // namespace plumbline

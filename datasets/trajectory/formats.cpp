// SPDX-License-Identifier: BSD-3-Clause
// What all formats share: taking poses, and the unit of their stamps.
#include "datasets/trajectory/formats.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"

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

constexpr double kEarliest = 6.3e8;  // 1990 in seconds since 1970
constexpr double kLatest = 4.2e9;    // 2103
// The range is narrower than the factor between two units: no interval is usual in more than one.
constexpr double kUsualRateNs[] = {1e6, 5e8};
constexpr TimeNs kShortestInterval = 200'000;        // 5000 poses a second
constexpr TimeNs kLongestInterval = 20'000'000'000;  // 20 s
// An hour, where the unit is certain: a header may state another, and stamps that count from a
// start of their own may look like a time since 1970.
constexpr TimeNs kLongestRareInterval = 3'600'000'000'000;

struct TimeUnit {
  const char* name;
  const char* sign;
};

/// Of 10^power nanoseconds.
const TimeUnit& unitOf(int power) {
  static constexpr TimeUnit kUnits[] = {
      {"nanoseconds", "ns"}, {"microseconds", "us"}, {"milliseconds", "ms"}, {"seconds", "s"}};
  return kUnits[power / 3];
}

// The unit in which a stamp lies in our century.
std::optional<int> powerOfEpoch(double stamp) {
  for (const int power : {9, 6, 3, 0}) {
    const double seconds = stamp * std::pow(10.0, power - 9);
    if (seconds > kEarliest && seconds < kLatest) return power;
  }
  return std::nullopt;
}

// The unit in which an interval is that of a usual rate.
std::optional<int> powerOfRate(double interval) {
  for (const int power : {9, 6, 3, 0}) {
    const double ns = interval * std::pow(10.0, power);
    if (ns >= kUsualRateNs[0] && ns <= kUsualRateNs[1]) return power;
  }
  return std::nullopt;
}

std::string headerCure(int power, bool has_header = true) {
  if (!has_header) return "convert them to seconds";
  return fmt::format(
      "convert them, or state the unit in a first line '# timestamp [{}] tx ty tz qx qy qz qw'",
      unitOf(power).sign);
}

// Coarser units make a short interval longer: the first that is a rate of poses.
int powerForShort(TimeNs interval, int power) {
  while (power < 9 && interval < kShortestInterval) {
    interval *= 1000;
    power += 3;
  }
  return power;
}

// Finer units make a long interval shorter: the first in which poses come at 0.5 Hz or more.
int powerForLong(TimeNs interval, int power) {
  while (power > 0 && interval > kLongestInterval / 10) {
    interval /= 1000;
    power -= 3;
  }
  return power;
}

TimeNs longestInterval(const StampUnit& unit) {
  return unit.certain ? kLongestRareInterval : kLongestInterval;
}

void checkInterval(const TrajectorySource& source, TimeNs interval, const StampUnit& unit,
                   int line) {
  const int power = unit.power;
  const TimeNs longest = longestInterval(unit);
  if (interval >= kShortestInterval && interval <= longest) return;
  if (interval == 0 && power == 9) {
    throw source.fault(line, {InputFault::kWrongUnit, "most stamps are equal to the one before",
                              "stamps with at least six decimals of a second",
                              "the stamps lost their digits when they were written: export them "
                              "again with more"});
  }
  const bool too_short = interval < kShortestInterval;
  const int likely = too_short ? powerForShort(interval, power) : powerForLong(interval, power);
  if (likely == power) {
    throw source.fault(line, {InputFault::kWrongUnit,
                              fmt::format("read in {}, the poses are {:.3g} s apart",
                                          unitOf(power).name, static_cast<double>(interval) * 1e-9),
                              fmt::format("0.2 ms to {} s between poses", longest / 1'000'000'000),
                              too_short || unit.certain ? "check the unit of the stamps"
                                                        : headerCure(power, unit.has_header)});
  }
  throw source.fault(
      line,
      {InputFault::kWrongUnit,
       fmt::format("read in {}, the poses are {:.3g} s apart, so the stamps look like {}",
                   unitOf(power).name, static_cast<double>(interval) * 1e-9, unitOf(likely).name),
       fmt::format("stamps in {}", unitOf(power).name), headerCure(likely, unit.has_header)});
}

/// Stamps of a much finer unit than theirs do not fit a TimeNs: the row where they no longer do
/// would be blamed.
void refuseLong(const TrajectorySource& source, const FirstStamps& stamps, const StampUnit& unit) {
  const double interval_ns = *stamps.interval * std::pow(10.0, unit.power);
  if (!(interval_ns > static_cast<double>(longestInterval(unit)))) return;
  constexpr double kMost = 4e18;  // a TimeNs has 9.2e18
  checkInterval(source, static_cast<TimeNs>(std::min(interval_ns, kMost)), unit, stamps.line);
}

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

TrajectoryFile TrajectoryBuilder::finish(bool gaps_are_usual) && {
  if (poses().empty()) {
    throw source_.fault(
        0, {InputFault::kEmpty, source_.text.empty() ? "is empty" : "has no poses", "rows of poses",
            "was the recording or the copy interrupted? Export the file again"});
  }
  if (equal_stamps_ > 0) {
    remark(fmt::format("{} pose{} the stamp of the pose before (first in line {})", equal_stamps_,
                       equal_stamps_ == 1 ? " has" : "s have", equal_line_));
  }
  if (gaps_are_usual) return std::move(file_);
  if (std::string gaps = gapRemark(poses()); !gaps.empty()) remark(std::move(gaps));
  return std::move(file_);
}

StampUnit decideStampUnit(const TrajectorySource& source, const FirstStamps& stamps,
                          std::optional<int> stated, int usual) {
  const int power = stated.value_or(usual);
  std::optional<int> epoch = powerOfEpoch(stamps.first);
  const std::optional<int> of_rate = stamps.interval ? powerOfRate(*stamps.interval) : std::nullopt;
  if (epoch && *epoch != power && of_rate && *of_rate != *epoch) epoch.reset();
  // Without an epoch the stamps count from some start of their own, and nothing but their intervals
  // speaks against the unit.
  if (!epoch || *epoch == power) {
    const StampUnit unit{power, {}, stated || epoch};
    if (stamps.interval) refuseLong(source, stamps, unit);
    return unit;
  }
  const std::string what = fmt::format(
      "the stamp {:.17g} is not a time of this century in {}: it looks like {} since 1970",
      stamps.first, unitOf(power).name, unitOf(*epoch).name);
  if (stated) {
    throw source.fault(stamps.line, {InputFault::kWrongUnit, what,
                                     fmt::format("{}, as the header states", unitOf(power).name),
                                     "correct the header's unit or convert the stamps"});
  }
  // Seconds and nanoseconds are each the unit of one of the formats, and are mixed up between them.
  // Milliseconds and microseconds are neither's, so that somebody has to vouch for them.
  if (*epoch == 3 || *epoch == 6) {
    throw source.fault(stamps.line,
                       {InputFault::kWrongUnit, what, unitOf(power).name, headerCure(*epoch)});
  }
  return {*epoch,
          fmt::format("stamps are read as {} where the format has {}", unitOf(*epoch).name,
                      unitOf(power).name),
          true};
}

// The second look at the unit, for stamps that no epoch could tell: by the rate of the poses.
void checkPoseIntervals(const TrajectorySource& source, const std::vector<StampedPose>& poses,
                        const StampUnit& unit, int line) {
  if (poses.size() >= 3) checkInterval(source, medianInterval(poses), unit, line);
}

}  // namespace plumbline

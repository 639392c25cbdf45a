// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <fmt/format.h>

#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

constexpr double kEarliest = 6.3e8;                  // 1990 in seconds since 1970
constexpr double kLatest = 4.2e9;                    // 2103
constexpr TimeNs kShortestInterval = 200'000;        // 5000 poses a second
constexpr TimeNs kLongestInterval = 20'000'000'000;  // 20 s
// An hour, where the unit is certain: a header may state another, and stamps that count from a
// start of their own may look like a time since 1970.
constexpr TimeNs kLongestRareInterval = 3'600'000'000'000;

const char* unitName(int power) {
  if (power == 0) return "nanoseconds";
  if (power == 3) return "microseconds";
  return power == 6 ? "milliseconds" : "seconds";
}

const char* unitSign(int power) {
  if (power == 0) return "ns";
  if (power == 3) return "us";
  return power == 6 ? "ms" : "s";
}

// The unit in which a stamp lies in our century.
std::optional<int> powerOfEpoch(double stamp) {
  for (const int power : {9, 6, 3, 0}) {
    const double seconds = stamp * std::pow(10.0, power - 9);
    if (seconds > kEarliest && seconds < kLatest) return power;
  }
  return std::nullopt;
}

std::string headerCure(int power, bool has_header = true) {
  if (!has_header) return "convert them to seconds";
  return fmt::format(
      "convert them, or state the unit in a first line '# timestamp [{}] tx ty tz qx qy qz qw'",
      unitSign(power));
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

}  // namespace

StampUnit decideStampUnit(const TrajectorySource& source, const StampEvidence& evidence) {
  const int power = evidence.stated.value_or(evidence.usual);
  const std::optional<int> epoch = powerOfEpoch(evidence.first);
  // Without an epoch the stamps count from some start of their own, and nothing speaks against the
  // unit.
  if (!epoch || *epoch == power) return {power, {}, evidence.stated || epoch};
  const std::string what = fmt::format(
      "the stamp {:.17g} is not a time of this century in {}: it looks like {} since 1970",
      evidence.first, unitName(power), unitName(*epoch));
  if (evidence.stated) {
    throw source.fault(evidence.line, {InputFault::kWrongUnit, what,
                                       fmt::format("{}, as the header states", unitName(power)),
                                       "correct the header's unit or convert the stamps"});
  }
  // Seconds and nanoseconds are each the unit of one of the formats, and are mixed up between them.
  // Milliseconds and microseconds are neither's, so that somebody has to vouch for them.
  if (*epoch == 3 || *epoch == 6) {
    throw source.fault(evidence.line,
                       {InputFault::kWrongUnit, what, unitName(power), headerCure(*epoch)});
  }
  return {*epoch,
          fmt::format("stamps are read as {} where the format has {}", unitName(*epoch),
                      unitName(power)),
          true};
}

// The second look at the unit, for stamps that no epoch could tell: by the rate of the poses.
void checkPoseIntervals(const TrajectorySource& source, const std::vector<StampedPose>& poses,
                        const StampUnit& unit, int line) {
  if (poses.size() < 3) return;
  const int power = unit.power;
  const TimeNs interval = medianInterval(poses);
  const TimeNs longest = unit.certain ? kLongestRareInterval : kLongestInterval;
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
                                          unitName(power), static_cast<double>(interval) * 1e-9),
                              fmt::format("0.2 ms to {} s between poses", longest / 1'000'000'000),
                              too_short || unit.certain ? "check the unit of the stamps"
                                                        : headerCure(power, unit.has_header)});
  }
  throw source.fault(
      line, {InputFault::kWrongUnit,
             fmt::format("read in {}, the poses are {:.3g} s apart, so the stamps look like {}",
                         unitName(power), static_cast<double>(interval) * 1e-9, unitName(likely)),
             fmt::format("stamps in {}", unitName(power)), headerCure(likely, unit.has_header)});
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/stamps.h"

#include <numeric>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

// The unit in which the interval would be that of a usual sensor.
const char* likelyUnit(TimeNs interval, TimeNs shortest) {
  // Read in microseconds an interval is a thousand times as long, in milliseconds a million.
  if (interval * 1000 >= shortest) return "microseconds";
  return interval * 1'000'000 >= shortest ? "milliseconds" : "seconds";
}

}  // namespace

std::string duplicateCure(TimeNs t) {
  constexpr TimeNs kNanosecondsFromHere = 10'000'000'000'000;  // as milliseconds: the year 2286
  // Seconds and milliseconds since 1970 lie between these; nanoseconds since 1970 are far above.
  const bool perhaps_other_unit = t > 1'000'000'000 && t < kNanosecondsFromHere;
  return perhaps_other_unit ? "delete one of the two rows; or, if the stamps are seconds or "
                              "milliseconds, write them in nanoseconds with all their digits"
                            : "delete one of the two rows";
}

void checkAscending(const TextTable& table, TimeNs t, TimeNs before, const char* cure) {
  if (t > before) return;
  // A last stamp that lost digits is a smaller number.
  if (table.truncatedHere()) {
    throw table.fault({InputFault::kTruncated, fmt::format("the last line, '{}', is cut", t),
                       "a whole last line",
                       "the file is truncated: copy it again or delete this line"});
  }
  const bool twice = t == before;
  throw table.fault({InputFault::kBadOrder,
                     twice ? fmt::format("the stamp {} is given twice", t)
                           : fmt::format("the stamp {} is earlier than that of the row above", t),
                     twice ? "stamps that ascend strictly" : "ascending stamps",
                     twice ? duplicateCure(t) : cure});
}

// By the intervals and not by the stamps themselves, which may count from any start.
void checkStampUnit(const std::string& path, const std::vector<TimeNs>& intervals, TimeNs shortest,
                    const std::string& things) {
  if (intervals.empty()) return;
  const TimeNs middle = middleOf(intervals);
  // Samples that are stamped in bursts come at the right rate all the same.
  const TimeNs mean = std::reduce(intervals.begin(), intervals.end()) / std::ssize(intervals);
  if (middle >= shortest || mean >= shortest) return;
  throw badInput(path, {InputFault::kWrongUnit,
                        fmt::format("the {} are {} ns apart, so the stamps look like {}", things,
                                    middle, likelyUnit(middle, shortest)),
                        "stamps in nanoseconds", "convert them to nanoseconds"});
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibrator/base/time.h"
#include "datasets/files/table.h"

namespace plumbline {

/// The times from each of the stamped items to the next [ns].
template <class Stamped>
std::vector<TimeNs> intervalsOf(const std::vector<Stamped>& items) {
  std::vector<TimeNs> intervals;
  for (std::size_t i = 1; i < items.size(); ++i) intervals.push_back(items[i].t - items[i - 1].t);
  return intervals;
}

/// Throws InputError where the median interval is below `shortest` [ns]: no sensor of that kind is
/// so fast, so the stamps are microseconds, milliseconds or seconds. `things` are what the stamps
/// count, for the message ("frames", "samples").
void checkStampUnit(const std::string& path, const std::vector<TimeNs>& intervals, TimeNs shortest,
                    const std::string& things);

/// What to do about a stamp that is given twice: delete a row, or, where it is so small that it may
/// be whole seconds or milliseconds since 1970, write nanoseconds.
std::string duplicateCure(TimeNs t);

/// Throws InputError where the current row's stamp is not later than that of the row before it;
/// `cure` is for a stamp that is earlier.
void checkAscending(const TextTable& table, TimeNs t, TimeNs before, const char* cure);

constexpr TimeNs kShortestFrameInterval = 1'000'000;  ///< [ns]: 1000 frames a second
constexpr TimeNs kShortestImuInterval = 25'000;       ///< [ns]: 40 000 samples a second

}  // namespace plumbline

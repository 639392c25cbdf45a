// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/time.h"

namespace plumbline {

/// Throws InputError where the median interval between ascending stamps is below `shortest` [ns]:
/// no sensor of that kind is so fast, so the stamps are microseconds, milliseconds or seconds.
/// `things` are what the stamps count, for the message ("frames", "samples").
void checkStampUnit(const std::string& path, const std::vector<TimeNs>& stamps, TimeNs shortest,
                    const std::string& things);

/// What to do about a stamp that is given twice: delete a row, or, where it is so small that it may
/// be whole seconds or milliseconds since 1970, write nanoseconds.
std::string duplicateCure(TimeNs t);

constexpr TimeNs kShortestFrameInterval = 1'000'000;  ///< [ns]: 1000 frames a second
constexpr TimeNs kShortestImuInterval = 25'000;       ///< [ns]: 40 000 samples a second

}  // namespace plumbline

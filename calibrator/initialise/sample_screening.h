// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calibrator/base/results/screening.h"
#include "calibrator/base/session.h"

namespace plumbline {

// Measurements that contradict their neighbours or the target's geometry, found before anything is
// estimated from them.

/// Isolated readings: with d_k the distance of a reading from the cubic through its two neighbours
/// on either side, |d_k| above 12 times the standard deviation of d around it (robust, from the
/// median over 100 to 150 samples, and not below a third of what the stated density of white noise
/// gives), while the neighbours agree with each other once the reading is left out. A jump, a
/// knock that lasts, vibration and noise of any size are none. Ascending in time; O(n).
std::vector<ImuSpike> findSpikes(std::span<const ImuSample> samples, const ImuNoise& noise);

/// The samples without those at the spikes' stamps: between their neighbours the readings are
/// taken as linear.
std::vector<ImuSample> withoutSpikes(std::span<const ImuSample> samples,
                                     std::span<const ImuSpike> spikes);

/// One channel whose readings are cut off at the end of the sensor's range.
struct CutOff {
  int channel = 0;  ///< as in ImuSpike
  double limit = 0;
  std::vector<std::size_t> samples;  ///< indices
};
/// Channels whose largest reading (magnitude, to 1e-9) repeats at least five times, twice in a row,
/// and more than three times as often as any of the ten levels below it: those of a coarse
/// converter repeat as well, but the largest of them the least. One of fewer levels may rest there.
std::vector<CutOff> findCutOff(std::span<const ImuSample> samples);

/// The samples without those that are cut off, and two on either side, so that what is missing
/// counts as a gap. All of them where that would be 40 % and more.
std::vector<ImuSample> withoutCutOff(std::span<const ImuSample> samples,
                                     std::span<const CutOff> cut_off);

}  // namespace plumbline

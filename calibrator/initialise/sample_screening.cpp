// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/sample_screening.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/initialise/angular_rates.h"

namespace plumbline {
namespace {

// ---- spikes
constexpr std::size_t kReach = 2;        // samples on either side that predict a reading
constexpr double kSpikeSigmas = 12;      // a heavy tail of real noise reaches 6 to 8
constexpr double kLeastNoise = 0.3;      // of the stated white noise: densities are often padded
constexpr double kSettled = 0.15;        // of the spike, what neighbours may keep without it
constexpr std::size_t kScaleBlock = 50;  // samples over which the noise is taken, on either side
constexpr double kGaussian = 1.4826;     // standard deviation over median of |x|
// Standard deviation of d for white noise of 1: the root of 1 + (1 + 16 + 16 + 1) / 36.
constexpr double kNoiseOfDistance = 1.394;

double reading(const ImuSample& s, int channel) {
  return channel < 3 ? s.gyro(channel) : s.accel(channel - 3);
}

/// Distance from the cubic (Lagrange at equal steps) through the neighbours.
double distanceAt(const std::vector<double>& x, std::size_t k) {
  return x[k] - (4 * (x[k - 1] + x[k + 1]) - x[k - 2] - x[k + 2]) / 6;
}

/// Robust standard deviation of the distances, one for each block of samples, from the block and
/// those beside it.
std::vector<double> blockScales(const std::vector<double>& distances, double least) {
  const std::size_t blocks = distances.size() / kScaleBlock + 1;
  std::vector<double> scales;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t from = b > 0 ? (b - 1) * kScaleBlock : 0;
    const std::size_t to = std::min(distances.size(), (b + 2) * kScaleBlock);
    std::vector<double> sizes;
    for (std::size_t k = from; k < to; ++k) sizes.push_back(std::abs(distances[k]));
    scales.push_back(sizes.empty() ? least
                                   : std::max(least, kGaussian * middleOf(std::move(sizes))));
  }
  return scales;
}

/// Whether the samples around k come at equal steps, so that the cubic holds.
bool isRegular(std::span<const ImuSample> samples, std::size_t k, double interval_s) {
  for (std::size_t i = k - kReach; i < k + kReach; ++i) {
    const double step = secondsBetween(samples[i].t, samples[i + 1].t);
    if (std::abs(step - interval_s) > 0.5 * interval_s) return false;
  }
  return true;
}

/// A spike shows in the distances of its neighbours as well, by 2/3 and 1/6 of its size (the
/// weights of the cubic); the largest is itself.
bool isLargest(const std::vector<double>& distances, std::size_t k) {
  for (std::size_t i = k - kReach; i <= k + kReach; ++i) {
    if (std::abs(distances[i]) > std::abs(distances[k])) return false;
  }
  return true;
}

/// Whether the neighbours of k agree with each other once x_k is what they say. `around` holds x_k
/// in the middle with 2 kReach samples on either side. After a jump they do not.
bool settlesWithout(std::vector<double> around, double distance) {
  constexpr std::size_t kMiddle = 2 * kReach;
  around[kMiddle] -= distance;
  for (std::size_t i = kReach; i <= 3 * kReach; ++i) {
    if (std::abs(distanceAt(around, i)) > kSettled * std::abs(distance)) return false;
  }
  return true;
}

/// Where neighbours are missing, at the ends, nothing is found.
void findInChannel(std::span<const ImuSample> samples, int channel, double least, double interval_s,
                   std::vector<ImuSpike>& spikes) {
  const std::size_t n = samples.size();
  std::vector<double> x(n);
  for (std::size_t k = 0; k < n; ++k) x[k] = reading(samples[k], channel);
  std::vector<double> distances(n, 0);
  for (std::size_t k = kReach; k + kReach < n; ++k) distances[k] = distanceAt(x, k);
  const std::vector<double> scales = blockScales(distances, least);
  for (std::size_t k = 2 * kReach; k + 2 * kReach < n; ++k) {
    const double d = distances[k];
    if (std::abs(d) < kSpikeSigmas * scales[k / kScaleBlock] || !isLargest(distances, k)) continue;
    if (!isRegular(samples, k, interval_s)) continue;
    const auto first = x.begin() + static_cast<std::ptrdiff_t>(k - 2 * kReach);
    if (!settlesWithout({first, first + 4 * kReach + 1}, d)) continue;
    spikes.push_back({samples[k].t, channel, d});
  }
}

// ---- readings that are cut off
constexpr double kSame = 1e-9;             // relative: the same reading
constexpr std::size_t kFewestRepeats = 5;  // at the limit in all,
constexpr int kFewestNeighbours = 2;       // of which so many twice in a row,
constexpr std::size_t kTimesMore = 3;      // and so many times more than any
constexpr std::size_t kNextLevels = 10;    // of the next levels
constexpr std::size_t kBeside = 2;         // samples left out beside one that is cut off
constexpr double kMostCutOff = 0.4;        // of all samples

/// The largest count of equal values among the ten levels that follow the first, in descending
/// order; 0 where there are fewer.
std::size_t mostOfNextLevels(std::vector<double> sizes) {
  std::sort(sizes.rbegin(), sizes.rend());
  std::size_t most = 0;
  std::size_t count = 0;
  std::size_t level = 0;
  for (std::size_t k = 1; k < sizes.size() && level <= kNextLevels; ++k) {
    const bool same = sizes[k] >= sizes[k - 1] * (1 - kSame);
    level += same ? 0 : 1;
    count = same ? count + 1 : 1;
    if (level > 0) most = std::max(most, count);
  }
  return level >= kNextLevels ? most : 0;
}

}  // namespace

std::vector<ImuSpike> findSpikes(std::span<const ImuSample> samples, const ImuNoise& noise) {
  std::vector<ImuSpike> spikes;
  if (samples.size() < 4 * kReach + 1) return spikes;
  const double interval_s = medianSampleInterval(samples);
  const double root_rate = std::sqrt(1 / interval_s);
  for (int channel = 0; channel < 6; ++channel) {
    const double density = channel < 3 ? noise.gyro_density : noise.accel_density;
    // Discrete noise of a density is density * sqrt(rate).
    findInChannel(samples, channel, kLeastNoise * kNoiseOfDistance * density * root_rate,
                  interval_s, spikes);
  }
  std::ranges::sort(spikes, {}, [](const ImuSpike& s) { return std::pair(s.t, s.channel); });
  return spikes;
}

std::vector<ImuSample> withoutSpikes(std::span<const ImuSample> samples,
                                     std::span<const ImuSpike> spikes) {
  std::vector<ImuSample> out;
  out.reserve(samples.size());
  auto spike = spikes.begin();
  for (const ImuSample& s : samples) {
    while (spike != spikes.end() && spike->t < s.t) ++spike;
    if (spike == spikes.end() || spike->t != s.t) out.push_back(s);
  }
  return out;
}

std::vector<CutOff> findCutOff(std::span<const ImuSample> samples) {
  std::vector<CutOff> out;
  for (int channel = 0; channel < 6 && !samples.empty(); ++channel) {
    std::vector<double> sizes;
    for (const ImuSample& s : samples) sizes.push_back(std::abs(reading(s, channel)));
    CutOff found{channel, *std::max_element(sizes.begin(), sizes.end()), {}};
    int neighbours = 0;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      if (sizes[k] < found.limit * (1 - kSame)) continue;
      if (!found.samples.empty() && found.samples.back() + 1 == k) ++neighbours;
      found.samples.push_back(k);
    }
    // 0: a channel that is dead, or rests on one of few levels.
    const std::size_t below = mostOfNextLevels(std::move(sizes));
    if (found.samples.size() >= kFewestRepeats && neighbours >= kFewestNeighbours && below > 0 &&
        found.samples.size() > kTimesMore * below) {
      out.push_back(std::move(found));
    }
  }
  return out;
}

std::vector<ImuSample> withoutCutOff(std::span<const ImuSample> samples,
                                     std::span<const CutOff> cut_off) {
  std::vector<bool> keep(samples.size(), true);
  for (const CutOff& channel : cut_off) {
    for (const std::size_t k : channel.samples) {
      const std::size_t last = std::min(k + kBeside, samples.size() - 1);
      for (std::size_t i = k > kBeside ? k - kBeside : 0; i <= last; ++i) keep[i] = false;
    }
  }
  // One sample and kBeside on either side leave a step of six intervals, more than the
  // kGapIntervals (5) that count as none. Fewer, and the integral would go straight through what
  // was cut off.
  const auto left_out = static_cast<double>(std::count(keep.begin(), keep.end(), false));
  const bool too_many = left_out >= kMostCutOff * static_cast<double>(samples.size());
  std::vector<ImuSample> out;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (keep[k] || too_many) out.push_back(samples[k]);
  }
  return out;
}

}  // namespace plumbline

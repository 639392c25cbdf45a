// SPDX-License-Identifier: BSD-3-Clause
// Faults of single samples: readings cut off at the sensor's range, and instants at which the
// inertial residuals are far off all others.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

// A reading that is cut off repeats in a row, and far more often than the next ones below it: those
// of a coarse converter repeat as well, but the largest of them the least.
constexpr double kSame = 1e-9;           // relative: the same reading
constexpr int kFewestRepeats = 5;        // at the limit in all,
constexpr int kFewestNeighbours = 2;     // of which so many twice in a row,
constexpr int kTimesMore = 3;            // and so many times more than any
constexpr std::size_t kNextLevels = 10;  // of the next levels

constexpr double kLeastRedundancy = 50;  // of residuals that judge noise

struct Clipping {
  std::string channel;
  double limit = 0;
  int samples = 0;
};

/// The largest count of equal values among the levels that follow the first, in descending order.
int mostOfNextLevels(std::vector<double> sizes) {
  std::sort(sizes.rbegin(), sizes.rend());
  int most = 0;
  int count = 0;
  std::size_t level = 0;
  for (std::size_t k = 1; k < sizes.size() && level <= kNextLevels; ++k) {
    const bool same = sizes[k] >= sizes[k - 1] * (1 - kSame);
    level += same ? 0 : 1;
    count = same ? count + 1 : 1;
    if (level > 0) most = std::max(most, count);
  }
  return most;
}

/// Samples of one channel that stand at its largest magnitude, if they look cut off.
Clipping clippingOf(const std::vector<double>& values, std::string channel) {
  std::vector<double> sizes;
  for (const double value : values) sizes.push_back(std::abs(value));
  const double limit = *std::max_element(sizes.begin(), sizes.end());
  int samples = 0;
  int neighbours = 0;
  bool before = false;
  for (const double size : sizes) {
    const bool here = size >= limit * (1 - kSame);
    samples += here ? 1 : 0;
    neighbours += here && before ? 1 : 0;
    before = here;
  }
  const int below =
      mostOfNextLevels(std::move(sizes));  // 0: one level only, a channel that is dead
  const bool clipped = samples >= kFewestRepeats && neighbours >= kFewestNeighbours && below > 0 &&
                       samples > kTimesMore * below;
  return {std::move(channel), limit, clipped ? samples : 0};
}

/// The rows of a whitened interval that one sensor's samples decide.
struct RowGroup {
  const char* name;
  int first, count;
};
constexpr std::array<RowGroup, 4> kRowGroups{{{"rotation (gyroscope)", 0, 3},
                                              {"velocity and position (accelerometer)", 3, 6},
                                              {"walk of the gyroscope's bias", 9, 3},
                                              {"walk of the accelerometer's bias", 12, 3}}};

}  // namespace

Findings judgeSamples(const std::vector<ImuSample>& samples, const VerdictThresholds& t) {
  std::string list;
  int worst = 0;
  for (const bool gyro : {false, true}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const ImuSample& s : samples) values.push_back((gyro ? s.gyro : s.accel)(axis));
      const Clipping clipping = clippingOf(
          values, fmt::format("{} {}", gyro ? "gyroscope" : "accelerometer", "xyz"[axis]));
      if (clipping.samples == 0) continue;
      worst = std::max(worst, clipping.samples);
      list += fmt::format("{}{} at {:.4g} ({} samples)", list.empty() ? "" : ", ", clipping.channel,
                          clipping.limit, clipping.samples);
    }
  }
  return {
      above({"Readings at the end of the sensor's range", "-", t.clipped_samples,
             "Move more gently, or set the IMU to a wider range: readings that are cut off bias "
             "T_SC0."},
            worst, list.empty() ? "no channel repeats its largest reading" : list)};
}

Findings judgeIsolatedResiduals(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  if (stage.imu_residuals.empty()) return {};
  double worst = 0;
  std::string evidence;
  for (const RowGroup& group : kRowGroups) {
    std::vector<double> sizes;
    for (const ImuIntervalResidual& r : stage.imu_residuals) {
      sizes.push_back(r.normalised.segment(group.first, group.count).norm());
    }
    const auto largest = std::max_element(sizes.begin(), sizes.end());
    const ImuIntervalResidual& at =
        stage.imu_residuals[static_cast<std::size_t>(largest - sizes.begin())];
    const double ratio = *largest / std::max(quantile(sizes, 0.5), 1e-12);
    if (!(ratio > worst)) continue;
    worst = ratio;
    evidence = fmt::format(
        "the largest residual of {} is {:.1f} times their median, {:.2f} s after "
        "the first frame",
        group.name, ratio, secondsBetween(stage.frames.front().t, at.t));
  }
  return {above({"Isolated inertial residuals", "-", t.isolated_residual,
                 "Look at the samples around that instant: a spike, a jump of a bias, a knock, or "
                 "stamps that are wrong there; record again, or cut it out."},
                worst, evidence)};
}

Findings judgeLongResiduals(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  const ImuResidualSummary& summary = stage.imu_summary;
  const auto add = [&](const char* sensor, double rms, const ImuNoiseCheck& check) {
    if (check.redundancy < kLeastRedundancy) return;
    const double ratio = rms / (check.expected_rms * check.factor);
    findings.push_back(above(
        {fmt::format("Residuals of the {} over the whole recording", sensor), "-", t.long_residuals,
         "The recording does not hang together though its segments do: look for a jump of a "
         "bias, a knock, a mount that gave way, a moving target; calibrate its parts apart."},
        ratio, fmt::format("{:.1f} times what its noise within segments explains", ratio)));
  };
  add("gyroscope", summary.gyro_normalised_rms, summary.noise.gyro);
  add("accelerometer", summary.accel_normalised_rms, summary.noise.accel);
  return findings;
}

}  // namespace plumbline

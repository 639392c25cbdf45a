// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/resampled_readings.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

constexpr std::size_t kFewest = 200;
constexpr double kOnLine = 0.01;      // of the 99 % quantile of the distances
constexpr double kCoarseSteps = 5;    // of a converter, in the median change
constexpr double kSameValue = 1e-12;  // relative: equal up to rounding

/// Smallest step between two values of a channel, the largest of the three.
double stepOf(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*sensor) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const ImuSample& s : samples) values.push_back((s.*sensor)(axis));
    std::ranges::sort(values);
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < values.size(); ++i) {
      const double between = values[i] - values[i - 1];
      if (between > kSameValue * std::abs(values[i])) step = std::min(step, between);
    }
    if (std::isfinite(step)) largest = std::max(largest, step);
  }
  return largest;
}

}  // namespace

std::optional<Resampling> findResampling(std::span<const ImuSample> samples,
                                         Eigen::Vector3d ImuSample::*sensor) {
  if (samples.size() < kFewest) return std::nullopt;
  std::vector<double> changes, distances;
  for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
    const Eigen::Vector3d &a = samples[k - 1].*sensor, &b = samples[k + 1].*sensor;
    const double w = secondsBetween(samples[k - 1].t, samples[k].t) /
                     secondsBetween(samples[k - 1].t, samples[k + 1].t);
    changes.push_back((b - a).norm());
    distances.push_back((samples[k].*sensor - (1 - w) * a - w * b).norm());
  }
  // Between copies nothing changes.
  std::vector<double> real_changes;
  std::ranges::copy_if(changes, std::back_inserter(real_changes), [](double c) { return c > 0; });
  if (real_changes.empty()) return std::nullopt;
  const double moved = middleOf(std::move(real_changes));
  if (!(moved > kCoarseSteps * stepOf(samples, sensor))) return std::nullopt;
  const double near = kOnLine * quantile(distances, 0.99);
  double judged = 0, held = 0, on_line = 0;
  for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
    if (changes[k - 1] < moved) continue;
    const Eigen::Vector3d& x = samples[k].*sensor;
    judged += 1;
    if (x == samples[k - 1].*sensor || x == samples[k + 1].*sensor) {
      held += 1;
    } else if (distances[k - 1] < near) {
      on_line += 1;
    }
  }
  return Resampling{held / judged, on_line / judged};
}

}  // namespace plumbline

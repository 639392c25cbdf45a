// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace plumbline {

struct BootstrapOptions {
  double confidence = 0.95;  ///< of the interval, (0, 1)
  int resamples = 20'000;
  std::uint64_t seed = 1;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

struct BootstrapInterval {
  double estimate = 0;
  double low = 0, high = 0;
};

/// Bias-corrected and accelerated bootstrap (Efron, 1987) of a statistic of independent groups,
/// which are resampled each within itself. The acceleration is that of the leave-one-out values
/// over all groups (each group's scaled by its size, Davison and Hinkley, 1997, eq. 5.25 and
/// ex. 3.5 for strata). Empty where a group has fewer than two values or nothing varies.
using Groups = std::vector<std::vector<double>>;
std::optional<BootstrapInterval> bcaInterval(const Groups& groups,
                                             const std::function<double(const Groups&)>& statistic,
                                             const BootstrapOptions& options = {});

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace plumbline {

/// Wall seconds.
class Stopwatch {
 public:
  /// Since it was made.
  double seconds() const { return between(start_, Clock::now()); }

  /// Since the last lap, or since it was made.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = between(last_, now);
    last_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }

  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace plumbline {

/// Nanoseconds since the epoch of the session's clock. A double of seconds keeps only about 0.2 us
/// at epoch scale, so differences are taken on integers first and converted afterwards.
using TimeNs = std::int64_t;

/// (later - earlier) in seconds; exact to double precision for spans below 104 days.
inline double secondsBetween(TimeNs earlier, TimeNs later) {
  return static_cast<double>(later - earlier) * 1e-9;
}

/// A span in seconds as nanoseconds, rounded to the nearest.
inline TimeNs toNanoseconds(double seconds) {
  return static_cast<TimeNs>(std::llround(seconds * 1e9));
}

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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace plumbline

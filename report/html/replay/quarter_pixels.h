// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "calibrator/base/session.h"

namespace plumbline::html_internal {

/// u and v of each corner in quarter pixels; what lies beyond 8191 px is put there.
inline std::vector<std::int16_t> quarterPixels(const std::vector<Corner>& corners) {
  std::vector<std::int16_t> values;
  values.reserve(2 * corners.size());
  for (const Corner& c : corners) {
    for (const double x : c.uv) {
      values.push_back(
          static_cast<std::int16_t>(std::lround(std::clamp(4 * x, -32767.0, 32767.0))));
    }
  }
  return values;
}

}  // namespace plumbline::html_internal

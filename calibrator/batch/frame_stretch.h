// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace plumbline {

/// A stretch of consecutive frames of an earlier result and how often it counts: the unit of a
/// bootstrap over time segments.
struct FrameStretch {
  int first = 0;
  int count = 0;
  double weight = 1;  ///< > 0; residuals of its frames count that often
};

}  // namespace plumbline

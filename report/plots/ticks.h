// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/plots/plot_data.h"

namespace plumbline {

/// About `target` ticks (0.6 to 1.5 times as many) at round numbers (1, 2 or 5 times a power of
/// ten) inside [range.min, range.max], ascending, labelled with just the digits that tell them
/// apart. range.min < range.max; target >= 2.
std::vector<AxisTick> roundTicks(const Range& range, int target);

/// Smallest range over the finite values with `margin` (a share of the span) on either side; never
/// empty: a single value gets a span of its own, no value gives [0, 1].
Range rangeOf(const std::vector<const std::vector<double>*>& columns, double margin);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/plots/plot_data.h"

namespace plumbline::internal {

/// Deep blue to yellow, lightness rising steadily; 0 <= u <= 1 (clamped).
Colour sequentialColour(double u);

/// Blue over white (u = 0.5) to red; clamped.
Colour divergingColour(double u);
Colour errorColour(double u);  ///< green to dark violet: lines on white

}  // namespace plumbline::internal

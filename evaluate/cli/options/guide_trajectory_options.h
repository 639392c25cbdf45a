// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <CLI/App.hpp>

#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// When a guide stops, its trajectories and the operator's speed: of `replay` and `simulate
/// operator`. `first_trajectory`: a word of FirstTrajectory.
void declareTrajectoriesAndStops(CLI::App& app, GuideOptions& guide, std::string& first_trajectory);

}  // namespace plumbline

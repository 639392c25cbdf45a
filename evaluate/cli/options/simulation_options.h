// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <CLI/App.hpp>

namespace plumbline {

/// --corner-sigma [px], --board-bend-mm and --guide-board (a word of GuideBoard) of recordings that
/// a simulated operator makes.
void declareSimulatedBoard(CLI::App& app, double& corner_sigma_px, double& board_bend_mm,
                           std::string& guide_board);

}  // namespace plumbline

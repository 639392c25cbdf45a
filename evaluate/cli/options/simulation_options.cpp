// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/simulation_options.h"

#include <CLI/CLI.hpp>

#include "evaluate/cli/options/session_options.h"

namespace plumbline {

void declareSimulatedBoard(CLI::App& app, double& corner_sigma_px, double& board_bend_mm,
                           std::string& guide_board) {
  addWithDefault(app, "--corner-sigma", corner_sigma_px, "Noise of corners [px]");
  addWithDefault(app, "--board-bend-mm", board_bend_mm,
                 "Bow of the board along x, RMS [mm]; along y half of it the other way, and x is "
                 "stretched by 0.1 mm (0: an even board of the size stated)")
      ->check(CLI::Range(0.0, 20.0));
  addWithDefault(app, "--guide-board", guide_board,
                 "Board shape that the guide assumes: measured (the true one) or flat")
      ->check(CLI::IsMember({"measured", "flat"}));
}

}  // namespace plumbline

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

void declareTrajectoriesAndStops(CLI::App& app, GuideOptions& guide,
                                 std::string& first_trajectory) {
  addWithDefault(app, "--stop-projection-px", guide.views.stop_projection_px,
                 "Finish the camera stage exactly when the predicted projection error over the "
                 "image (RMS) is at most this [px] (0: use the criterion)")
      ->check(numberWithin(0, 100));
  addWithDefault(
      app, "--stop-reprojection-px", guide.trajectories.stop_reprojection_px,
      "Finish the camera-IMU stage exactly when the expected reprojection error of points "
      "predicted by the IMU is at most this [px] (0: use the criterion)")
      ->check(numberWithin(0, 100));
  addWithDefault(app, "--trajectory-s", guide.trajectories.duration_s,
                 "Duration of a trajectory [s]")
      ->check(positiveNumber());
  addWithDefault(app, "--trajectory-amplitude", guide.trajectories.amplitude,
                 "Scale factor of the trajectories")
      ->check(positiveNumber());
  addWithDefault(app, "--trajectory-held-s", guide.trajectories.reached_s,
                 "Time at a trajectory's start until it counts as reached [s]")
      ->check(numberFrom(0));
  addWithDefault(app, "--first-trajectory", first_trajectory,
                 "Ask for the first trajectory at-once, with the camera-IMU stage's first frame, "
                 "or when it can be scored");
  addWithDefault(app, "--operator-speed", guide.pace.speed_m_s,
                 "Rank suggestions by gain per second at this hand speed [m/s] (0: by gain alone)")
      ->check(numberWithin(0, 10));
}

}  // namespace plumbline

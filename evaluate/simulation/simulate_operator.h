// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "calibrator/base/enum_words.h"
#include "evaluate/simulation/operator_convergence.h"
#include "evaluate/simulation/simulate_study.h"
#include "evaluate/simulation/stop_hindsight.h"

namespace plumbline {

/// How a simulated person records.
enum class OperatorMethod {
  kGuided,  ///< in closed loop with the guide
  kFree,    ///< views around the board, then faster motion for the IMU
  kDance,   ///< OwnViewsKind::kDance, then the same faster
};
constexpr std::array<const char*, 3> enumWords(OperatorMethod /*of*/) {
  return {"guided", "free", "dance"};
}

/// One recording that a simulated person makes.
struct OperatorSimulationOptions {
  std::string rig = "d435i";
  OperatorMethod method = OperatorMethod::kGuided;
  OperatorSkill skill = personSkill(0.5);
  GuideOptions guide;
  std::uint64_t seed = 1;   ///< of the person and of all noise
  double duration_s = 120;  ///< of a recording without guide; a guided one is over then at last
  double corner_sigma_px = 0.2;
  double board_bend_mm = 0.3;                      ///< see bentBoard()
  GuideBoard guide_board = GuideBoard::kMeasured;  ///< what guide and judgement know of it
  int trajectories = 0;  ///< guided: done after so many, if the guide is not before; 0: no limit
  bool judge = false;    ///< also say when the recording was enough (operator_convergence.h)

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// What was recorded.
struct OperatorSimulationSummary {
  bool finished = true;
  double camera_s = 0, camera_imu_s = 0;
  int suggestions = 0;  ///< that ended before the recording did
  int reached = 0;      ///< of them
  bool open = false;    ///< one was when the recording ended
  std::optional<OperatedConvergence> convergence;
  OperatedStops stops;  ///< of the stages that ended by a bar in pixels
};

/// Writes into `folder`, which is there and empty:
///   mav0/, target.yaml, imu.yaml        the recording with corners, as sessionFiles() has it
///   suggestions.csv                     of a guided recording
///   truth/truth.json                    rig, skill, options, what became of every suggestion, and
///                                       with `judge` the convergence and the stops in hindsight
///   truth/camchain-imucam.yaml          Kalibr's format
///   truth/target_shape.yaml             the board's own shape, which target.yaml does not state
///   truth/poses.csv                     T_FC0 with every frame: t_ns, tx, ty, tz, qx, qy, qz, qw
/// The recordings are those of recordGuided() and recordFreely(), which `simulate study` writes.
/// Equal options give equal bytes.
OperatorSimulationSummary simulateOperator(const OperatorSimulationOptions& options,
                                           const std::filesystem::path& folder);

/// For people, lines on when the recording was sufficient and on the guide's stops; empty unless
/// that was judged.
std::string judgementText(const OperatorSimulationSummary& made);

}  // namespace plumbline

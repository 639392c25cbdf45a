// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/simulate/operator/rig_sensors.h"
#include "calibrator/simulate/operator/simulated_operator.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// Spacing of a person's control poses [s]: a hand's motion has little above 5 Hz.
inline constexpr double kControlSpacing_s = 0.1;

/// A recording that a simulated person made.
struct OperatedSession {
  Session session;
  SplineMotion motion{kControlSpacing_s};  ///< of camera 0, in the IMU's time
  std::vector<Transform> T_FC0;            ///< where camera 0 was, frame by frame
  std::vector<Decision> decisions;         ///< of the guide, frame by frame, without rounds' scores
  std::vector<Suggestion> suggestions;     ///< shown, in their order; none without a guide
  int reached = 0;                         ///< of them, by the guide's own rule
  bool finished = true;                    ///< false: gave up, or the time was over
  double camera_s = 0;                     ///< spent for the cameras ...
  double camera_imu_s = 0;                 ///< ... and for the IMU [s]
};

struct OperatedOptions {
  SimulationOptions
      simulation;  ///< duration_s: of a free recording, or after which a guided one ends
  OperatorSkill skill;
  GuideOptions guide;
  TargetShape guide_shape;  ///< the board's own shape as far as the guide knows it; default: flat
  int trajectories = 0;     ///< guided: done after so many, if the guide is not before; 0: no limit
  double arrival_s = 0.05;  ///< as GuideFramesOptions has it
  double camera_share = 0.5;  ///< of a free recording, before the motion for the IMU begins
  std::uint64_t operator_seed = 1;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// As people record for an offline calibrator: views all around for a part of the time, then faster
/// motion for the IMU. Ends after simulation.duration_s, or when patience does.
OperatedSession recordFreely(const SimulatedRig& rig, const OperatedOptions& options);

/// In closed loop: every frame goes to the Guide as it is taken, and the person sees what the guide
/// suggests and moves accordingly, which makes the next frames. Ends when the guide is done or the
/// trajectories that were agreed on are, when patience ends, or at simulation.duration_s
/// (unfinished, too).
OperatedSession recordGuided(const SimulatedRig& rig, const OperatedOptions& options);

/// The decision with which a suggestion ended; null: it was open when the recording ended.
const Decision* endOf(const OperatedSession& made, int suggestion);

/// How many suggestions ended before the recording did; at most the last did not.
int endedSuggestions(const OperatedSession& made);

/// A board bent across by so much (RMS), half as much the other way along, and a little stretched
/// by its printer (0.1 mm); 0: an even board, not stretched either.
TargetShape bentBoard(double bend_mm);

/// suggestions.csv as readSuggestions() reads it.
std::string suggestionsCsv(const std::vector<Suggestion>& suggestions);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "evaluate/results/progress.h"
#include "evaluate/simulation/study_participants.h"

namespace plumbline {

/// What was made of a study.
struct StudySimulationSummary {
  int sessions = 0, gave_up = 0;
  int suggestions = 0, reached = 0;
  double free_s = 0, guided_s = 0;  ///< median lengths of finished sessions
};

/// Writes a user study into `folder`, which is there and empty:
///   STUDY.yaml                     as `plumbline study` reads it
///   truth.json                     rig, board, participants, effects, what every session was
///   sessions/NAME/                 recordings with corners; guided ones with suggestions.csv
///   evaluation/evalNN/             recordings of the rig that no method saw
///   sequences/seqNN/               likewise, with mav0/mocap0/data.csv, truth/ and, if asked for,
///                                  images in place of corners (of a flat board)
/// The rig is "d435i" (stereo 15 Hz, IMU 400 Hz, the paper's noise densities). All recordings show
/// one board that is bent and not quite even, which target.yaml does not say. Free recordings and
/// guided ones are those of operated_session.h. Equal options give equal bytes.
StudySimulationSummary simulateStudy(const StudySimulationOptions& options,
                                     const std::filesystem::path& folder,
                                     const ProgressSink& progress);

}  // namespace plumbline

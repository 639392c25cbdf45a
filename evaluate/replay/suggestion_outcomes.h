// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluate/replay/frames.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// What became of each suggestion of the guide: read off its decisions, with the corners that
/// `cameras` would see at it.
std::vector<SuggestionOutcome> suggestionOutcomes(const ReplayRun& run,
                                                  const std::vector<CameraCalibration>& cameras);

/// How the operator of a guided recording followed the suggestions that were shown to him: each is
/// open from its time until the next one (or the recording's end), and reached by the guide's own
/// rule of its stage. Distances of poses need the poses of the frames: those of `full`.
OperatorCompliance operatorCompliance(const ReplayRun& run,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras);

/// The same of a recording that is not replayed; its suggestions are those that it has beside it.
OperatorCompliance operatorCompliance(const Session& session,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline

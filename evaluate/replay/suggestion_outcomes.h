// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "evaluate/replay/frames.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// What became of each suggestion of the guide: read off its decisions, with the corners that
/// `cameras` would see at it.
std::vector<SuggestionOutcome> suggestionOutcomes(const ReplayRun& run,
                                                  const std::vector<CameraCalibration>& cameras);

/// How the operator of a guided recording followed the suggestions that were shown to him: each is
/// open from its time until the next one, and reached by the guide's own rule of its stage, in the
/// camera that it was made for; one that is not has expired after the guide's limit, or was
/// withdrawn for the next one before; the last has no event where the frames end before that.
/// Those shown before the first frame or after the
/// last are left out. Distances of poses need the poses of the frames: those of `full`.
OperatorCompliance operatorCompliance(const ReplayRun& run,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras);

/// Where a file of suggestions comes from: an option, or beside the recording.
enum class SuggestionsFile { kGiven, kFound };

/// Throws InputError where none of the file's suggestions was shown within a minute of a frame of a
/// whole recording: they are another recording's, or of another clock. A frame without another one
/// so near does not count, for its stamp may be wrong.
void checkShownWithin(const std::vector<GuideFrame>& frames,
                      const std::vector<Suggestion>& suggestions, const std::string& path,
                      SuggestionsFile file);

/// The compliance in a recording that is not replayed; its suggestions are those that it has beside
/// it.
OperatorCompliance operatorCompliance(const Session& session,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline

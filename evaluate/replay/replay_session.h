// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/guidance/guide_options.h"
#include "evaluate/replay/counterfactuals.h"
#include "evaluate/replay/stops/stopping_rule.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// Fills ReplayFrame::jpeg where the recording has images: grey, made smaller by a whole factor to
/// at most 400 pixels of width (mean over blocks), of JPEG quality 60. A frame's images are those
/// of the views that `paired`, one for each of `frames`, puts together. `threads` 0: all cores.
void addImages(const LoadedSession& loaded, const std::vector<Frame>& paired,
               std::vector<ReplayFrame>& frames, int threads, const ProgressSink& progress);

/// What `plumbline replay` is asked to do.
struct ReplayRequest {
  LoadRequest load;
  GuideOptions guide;
  double arrival_s = 0.05;                  ///< see GuideFramesOptions
  CameraStageOptions camera;                ///< models, noise and loss of the batches
  CameraImuOptions camera_imu;              ///< likewise
  std::optional<std::string> cameras_file;  ///< used as they are: the camera stage is skipped
  /// What the recording's operator was asked for; empty: suggestions.csv in the session's folder if
  /// there is one.
  std::optional<std::string> suggestions;
  StoppingRuleOptions audit;
  std::optional<CounterfactualOptions> counterfactuals;  ///< noise and models are those of `camera`
  bool images = true;     ///< keep small copies of the recording's images for the page
  Provenance provenance;  ///< input and hash are filled in

  /// Throws InputError for values out of range.
  void check() const;
};

/// Plays the recording through the guide, frame by frame, and judges what it decided. What the
/// recording does not allow (too short to start, no IMU, ...) is said in the record: there is no
/// failure beside bad input, which throws InputError.
ReplayRecord replaySession(const ReplayRequest& request, const ProgressSink& progress);

/// What a replay's figures say of the recording and of the guide, stage by stage: whether it could
/// start, whether it stopped and rightly so, how far its calibration is from that of all frames.
/// First what was found of cameras and a board's shape that were given.
Verdict replayVerdict(const ReplayRecord& record, const ReplayRequest& request,
                      std::vector<Finding> of_what_was_given = {});

/// One decision as one line of decisions.jsonl, with its line end: its fields (guide_fields.h),
/// null where there is no value. Suggestions and rounds of candidates appear on the line of the
/// frame that brought them.
std::string decisionLine(const Decision& decision);

/// All of them.
std::string decisionLog(const std::vector<Decision>& decisions);

/// The same for a terminal, in short.
std::string replaySummary(const ReplayRecord& record);

}  // namespace plumbline

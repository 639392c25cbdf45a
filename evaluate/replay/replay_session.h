// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/guidance/guide_options.h"
#include "evaluate/replay/counterfactuals.h"
#include "evaluate/replay/stopping_rule.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "report/records/replay_record.h"

namespace plumbline {

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

}  // namespace plumbline

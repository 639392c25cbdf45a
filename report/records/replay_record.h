// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/guide_decision.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// A frame as the operator would have seen it.
struct ReplayFrame {
  TimeNs t = 0;
  std::vector<std::vector<Corner>> corners;  ///< per camera
  /// Per camera, a small JPEG of its image; empty where the recording has none.
  std::vector<std::string> jpeg;
};

/// How a suggestion ended.
struct SuggestionOutcome {
  Suggestion suggestion;
  /// Reached, expired, withdrawn; none: open at the end.
  SuggestionEvent end = SuggestionEvent::kNone;
  TimeNs ended = 0;
  std::optional<double> closest_px;   ///< least mean corner distance while it was open
  std::optional<double> mean_px;      ///< mean of the distance over its frames
  std::optional<double> closest_m;    ///< least distance of the camera's position
  std::optional<double> closest_rad;  ///< and of its orientation, at that instant
  /// Per camera, what it would see at suggestion.T_FC0, by the cameras that the guide had then:
  /// what the operator would have been shown. Empty: nothing is overlaid.
  std::vector<std::vector<Corner>> overlay;
};

/// What a guided recording says of its operator: suggestions as they were shown at recording time.
struct OperatorCompliance {
  std::vector<SuggestionOutcome> suggestions;
  int reached = 0;
  double median_seconds_to_reach = 0;
};

/// Was the guide's "finish" right? Judged by the held-out error of the batch over the views kept.
struct StopAudit {
  enum class Verdict { kNeverStopped, kEarly, kLate, kRight, kNotJudged };
  GuideStage stage = GuideStage::kCamera;
  Verdict verdict = Verdict::kNeverStopped;
  std::optional<TimeNs> finished;     ///< the guide's "finish"
  std::optional<TimeNs> enough;       ///< first instant at which the views kept were good enough
  double seconds = 0;                 ///< early: missing; late: wasted; right or never: 0
  double saved_s = 0;                 ///< of the recording, after "finish"
  double entropy_at_finish_nats = 0;  ///< of the calibration parameters
  double entropy_of_all_nats = 0;     ///< had every frame been used
  std::string explanation;            ///< a sentence with the numbers that decided it
};

/// One stage in figures.
struct ReplayStageSummary {
  GuideStage stage = GuideStage::kCamera;
  bool ran = false;
  std::string problem;  ///< why it did not run, or not to its end; empty otherwise
  int frames_offered = 0;
  int frames_dropped = 0;  ///< came while the guide was busy
  int views_used = 0;
  int views_redundant = 0;  ///< used, though in hindsight each gains less than the threshold
  int views_missed = 0;     ///< not used, though in hindsight each gains more than it
  int suggestions = 0;
  int reached = 0;
  std::optional<TimeNs> started;
  std::optional<TimeNs> finished;
  /// Batch over the kept views, and over all frames of the recording.
  std::optional<StageSummary> kept_batch;
  std::optional<StageSummary> full_batch;
  double information_after_finish_nats = 0;  ///< what the recording after "finish" added
};

/// One order in which the frames of a pool could have been used.
struct CounterfactualCurve {
  std::string strategy;  ///< "recorded", "random", "greedy-mi", "coverage", "guide"
  std::uint64_t seed = 0;
  std::vector<int> order;  ///< frames of the pool, as positions in the recording's frames
  std::vector<int> views;  ///< abscissa: how many were used
  std::vector<std::optional<double>> entropy_nats;  ///< at each; empty: not determined yet
  std::vector<std::optional<double>> held_out_px;   ///< RMSE on frames outside the pool
  /// The same over the corners near the image's border, and over the others.
  std::vector<std::optional<double>> held_out_border_px;
  std::vector<std::optional<double>> held_out_centre_px;
  /// Over all of them under the batch's robust loss, sqrt(mean rho(|e|^2)): what the batch means to
  /// make small, while the RMSE counts gross errors fully. Equal to held_out_px without a loss.
  std::vector<std::optional<double>> held_out_loss_px;
  /// held_out_px less that of the best strategy at the same number of views; a strategy with seeds
  /// stands there with its median. Negative where one seed beats every strategy.
  std::vector<std::optional<double>> regret_px;
  /// To come within 10 % of the full pool's held-out error and stay there with more views.
  std::optional<int> views_needed;
};

struct Quartiles {
  double lower = 0, median = 0, upper = 0;
};

/// The curves of one strategy over its seeds; of a strategy without, all three quartiles agree.
struct CounterfactualBand {
  std::string strategy;
  int seeds = 0;                                       ///< curves
  std::vector<int> views;                              ///< abscissa
  std::vector<std::optional<Quartiles>> entropy_nats;  ///< empty: not all seeds have a value
  std::vector<std::optional<Quartiles>> held_out_px;
  std::vector<std::optional<double>> regret_px;  ///< of the median
  std::optional<Quartiles> views_needed;         ///< empty: not all seeds get there
};

struct Counterfactuals {
  std::vector<CounterfactualCurve> curves;
  std::vector<CounterfactualBand> bands;  ///< one per strategy, in the order of the curves
  int pool_frames = 0;
  int held_out_frames = 0;
  double full_pool_entropy_nats = 0;
  double full_pool_held_out_px = 0;
  std::string other_model;  ///< "pinhole-equidistant", ...; empty: none was tried
  std::vector<CounterfactualBand> other_model_bands;  ///< greedy-mi and random under it
  std::vector<std::string> remarks;  ///< where and why a strategy loses, from the numbers
  std::string problem;  ///< why there are no curves (one line, with its cure); empty otherwise
};

/// A replay: every decision of the guide on a recording, and how good they were.
struct ReplayRecord {
  std::string name;
  Provenance provenance;
  Assumptions assumptions;
  Verdict verdict;
  AprilGrid target;
  std::vector<CameraCalibration> cameras;  ///< for drawing: the best that is known at the end
  std::vector<ReplayFrame> frames;         ///< all of the recording
  std::vector<Decision> decisions;         ///< one per frame
  std::vector<ReplayStageSummary> stages;
  std::vector<SuggestionOutcome> suggestions;
  std::optional<OperatorCompliance> compliance;
  std::vector<StopAudit> stop_audits;
  std::optional<Counterfactuals> counterfactuals;
};

}  // namespace plumbline

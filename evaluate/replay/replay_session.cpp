// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/replay_session.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/guidance/guide.h"
#include "datasets/session/suggestions_reader.h"
#include "evaluate/metrics/calibration/held_cameras.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/replay/frames.h"
#include "evaluate/replay/stage_summary.h"
#include "evaluate/replay/suggestion_outcomes.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

std::vector<Decision> play(Guide& guide, const std::vector<GuideFrame>& frames,
                           const ProgressSink& progress) {
  std::vector<Decision> decisions;
  for (const GuideFrame& frame : frames) {
    progress("replaying the recording",
             static_cast<double>(decisions.size()) / static_cast<double>(frames.size()));
    Decision& decision = decisions.emplace_back(guide.step(frame));
    if (decision.failure) note(decision, textOf(*decision.failure).message);
  }
  return decisions;
}

/// A recording played, by a guide that still has its views.
struct Played {
  Guide guide;
  GuideOptions options;
  std::vector<Decision> decisions;
  CameraStageEnd camera_end = CameraStageEnd::kItself;
};

Played playedWith(const ReplayRequest& request, const GuideRig& rig,
                  const std::vector<GuideFrame>& frames, const GuideOptions& options,
                  const std::optional<std::vector<CameraCalibration>>& given,
                  const ProgressSink& progress) {
  Played played{Guide(rig, options, given), options, {}};
  played.decisions = play(played.guide, frames, progress);
  if (played.guide.cameraStageEnded()) {
    // By the request's, as `options` hold half of the recording where nobody asked for a time.
    const bool asked = request.guide.camera_stage_s > 0;
    played.camera_end = asked ? CameraStageEnd::kTime : CameraStageEnd::kHalf;
  }
  return played;
}

/// Where the camera stage would take the whole recording, it is ended at half of it, as a person
/// with so much time would do: otherwise nothing would be known of the camera-IMU stage.
Played playBothStages(const ReplayRequest& request, const GuideRig& rig,
                      const std::vector<GuideFrame>& frames,
                      const std::optional<std::vector<CameraCalibration>>& given,
                      const ProgressSink& progress) {
  Played played = playedWith(request, rig, frames, request.guide, given, progress);
  if (request.guide.camera_stage_s > 0) return played;  // its user decides
  // Only where an IMU waits for it: without one the camera stage may well take all.
  const bool stuck = !played.decisions.empty() && rig.imu && !given &&
                     played.decisions.back().stage == GuideStage::kCamera &&
                     played.decisions.back().mode != GuideMode::kFinished;
  if (!stuck) return played;
  GuideOptions half = request.guide;
  // From where the guide counts, which a wrong stamp of the first frame is not.
  const TimeNs since = played.guide.since().value_or(frames.front().t);
  half.camera_stage_s = 0.5 * secondsBetween(since, frames.back().t);
  if (!(half.camera_stage_s > 0)) return played;
  Played again = playedWith(request, rig, frames, half, given, progress);
  // Where half of the views determine no cameras, the second play would lose the first stage and
  // not gain the other.
  return again.guide.cameraBatch().ok() ? std::move(again) : std::move(played);
}

GuideRule ruleOf(const ViewGuideOptions& views) {
  GuideRule rule{views.criterion == ViewCriterion::kPredictedError, {}};
  if (rule.by_error && !(views.stop_projection_px > 0)) rule.stop_excess = views.stop_excess;
  return rule;
}

/// What both stages left behind, and what is made of it.
class Judge {
 public:
  Judge(const ReplayRequest& request, const ReplayRun& run, const Guide& guide,
        std::optional<std::vector<CameraCalibration>> given,
        std::optional<std::vector<Suggestion>> suggestions, const ProgressSink& progress)
      : request_(request),
        run_(run),
        guide_(guide),
        given_(given.has_value()),
        used_cameras_(std::move(given).value_or(std::vector<CameraCalibration>())),
        suggestions_(std::move(suggestions)),
        tell_(progress) {}

  void write(ReplayRecord& record) {
    if (given_) {
      notJudged(GuideStage::kCamera, "the cameras are given", record);
    } else {
      cameraStage(record);
    }
    if (run_.session.imu) {
      cameraImuStage(record);
    } else {
      notJudged(GuideStage::kCameraImu,
                request_.load.read.read_imu ? "the recording has no IMU"
                                            : "the IMU is left out (--no-imu)",
                record);
    }
    // After the stages: outcomes of suggestions are drawn with the best cameras.
    record.cameras = batches_.full ? batches_.full->cameras : used_cameras_;
    record.suggestions = suggestionOutcomes(run_, record.cameras);
    // Without cameras nobody knows what a suggestion would have shown.
    if (suggestions_ && !record.cameras.empty()) {
      record.compliance = operatorCompliance(run_, *suggestions_, record.cameras);
    }
    counterfactualCurves(record);
  }

 private:
  void cameraStage(ReplayRecord& record) {
    tell_("judging the camera stage", -1);
    const Result<CameraStageResult> guides_own = guide_.cameraBatch();
    // Before the camera-IMU stage is judged, which ran with these.
    if (guides_own) used_cameras_ = guides_own->cameras;
    batches_ = cameraBatches(run_, guides_own);
    record.stages.push_back(summariseCameraStage(run_, batches_));
    record.stop_audits.push_back(judgeCameraStop(run_, batches_, request_.audit));
  }

  void cameraImuStage(ReplayRecord& record) {
    tell_("judging the camera-IMU stage", -1);
    const auto batches = cameraImuBatches(run_, used_cameras_);
    record.stages.push_back(summariseCameraImuStage(run_, batches));
    if (!record.stages.back().ran) {
      return notJudged(GuideStage::kCameraImu, record.stages.back().problem, record);
    }
    record.stop_audits.push_back(judgeCameraImuStop(run_, used_cameras_, batches, request_.audit));
  }

  /// A stage that was not played, or never started.
  static void notJudged(GuideStage stage, const std::string& why, ReplayRecord& record) {
    StopAudit audit;
    audit.stage = stage;
    audit.verdict = StopAudit::Verdict::kNotJudged;
    audit.explanation = "not judged: " + why;
    record.stop_audits.push_back(std::move(audit));
  }

  void counterfactualCurves(ReplayRecord& record) const {
    if (!request_.counterfactuals) return;
    tell_("computing counterfactual view orders", -1);
    CounterfactualOptions options = *request_.counterfactuals;
    options.camera = run_.camera;
    if (given_) {
      // The frames are tried out as these cameras, from their values.
      options.camera.start = used_cameras_;
      options.camera.models = modelsOf(used_cameras_);
    }
    options.threads = threadCount(request_.load.threads);
    // Frames as they were played, whose positions the decisions have; counterfactuals() counts
    // those with enough corners.
    const Session session = run_.sessionFrom();
    const std::vector<int> recorded = recordedFrames(session);
    record.counterfactuals = counterfactuals(session, keptFrames(recorded), options);
    // Back to positions in the recording, as decisions have them.
    for (CounterfactualCurve& curve : record.counterfactuals->curves) {
      curve.order = itemsAt(recorded, curve.order);
    }
  }

  /// Of each frame as counterfactuals() counts those of `session`, its position in the recording.
  std::vector<int> recordedFrames(const Session& session) const {
    std::map<TimeNs, int> position;
    for (const GuideFrame& frame : run_.frames) position.emplace(frame.t, frame.index);
    std::vector<int> recorded;
    for (const Frame& frame : pairFrames(session.cameras, run_.camera.frames)) {
      recorded.push_back(position.at(frame.t));
    }
    return recorded;
  }

  /// The frames that the camera stage kept, as counterfactuals() counts them.
  std::vector<int> keptFrames(const std::vector<int>& recorded) const {
    const std::vector<int> accepted = run_.accepted(GuideStage::kCamera);
    std::vector<int> kept;
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      const bool is_kept = std::binary_search(accepted.begin(), accepted.end(), recorded[i]);
      if (is_kept) kept.push_back(static_cast<int>(i));
    }
    return kept;
  }

  const ReplayRequest& request_;
  const ReplayRun& run_;
  const Guide& guide_;
  const bool given_;
  std::vector<CameraCalibration> used_cameras_;  // those that the camera-IMU stage ran with
  std::optional<std::vector<Suggestion>> suggestions_;
  const ProgressSink& tell_;
  StageBatches<CameraStageResult> batches_;
};

Finding untested(const std::string& what, const Failure& why) {
  return {what, VerdictLevel::kCaution, "not tested: " + textOf(why).message};
}

std::vector<Finding> judgeCameras(const Session& session, const CameraStageOptions& camera,
                                  const std::vector<CameraCalibration>& cameras) {
  const auto held = scoreCameras(session, cameras, camera);
  if (!held) return {untested("Cameras that were given", held.failure())};
  ScoreOptions options;
  options.camera = camera;
  return judgeHeldCameras(*held, session, options);
}

std::vector<Finding> judgeShape(const Session& session, CameraStageOptions camera,
                                const std::optional<std::vector<CameraCalibration>>& cameras) {
  camera.target = TargetMode::kKnown;
  if (cameras) camera.start = *cameras;
  const auto stage = calibrateCameras(session, camera);
  if (!stage) return {untested("Shape of the target", stage.failure())};
  std::vector<Finding> findings = judgeTargetShape(*stage, {});
  for (Finding& f : findings) {
    if (f.level == VerdictLevel::kGood || f.advice.empty()) continue;
    f.advice =
        "leave out --target-shape, or give the file that plumbline calibrate --target-shape auto "
        "writes for this recording";
  }
  return findings;
}

/// Whether cameras and a board's shape that were given are the recording's: with others the guide
/// is judged by what the recording is not.
std::vector<Finding> judgeGiven(const ReplayRequest& request, const ReplayRun& run,
                                const std::optional<std::vector<CameraCalibration>>& cameras,
                                const ProgressSink& progress) {
  if (!cameras && !request.load.target_shape) return {};
  progress("testing what was given", -1);
  const Session session = run.sessionFrom();
  std::vector<Finding> findings;
  if (cameras) findings = judgeCameras(session, run.camera, *cameras);
  if (request.load.target_shape) {
    std::ranges::move(judgeShape(session, run.camera, cameras), std::back_inserter(findings));
  }
  return findings;
}

}  // namespace

void ReplayRequest::check() const {
  load.check();
  audit.check();
  if (counterfactuals) counterfactuals->check();
  if (!(arrival_s >= 0) || std::isinf(arrival_s)) {
    throw InputError(
        fmt::format("images arrive {} s after their stamps: expected 0 or more", arrival_s));
  }
}

ReplayRecord replaySession(const ReplayRequest& asked, const ProgressSink& progress) {
  asked.check();
  ReplayRequest request = asked;
  const auto shown =
      request.suggestions ? request.suggestions : findSuggestions(request.load.session);
  // Files that decide the result belong to its input hash.
  for (const auto& file : {request.cameras_file, shown}) {
    if (file) request.load.others.push_back(*file);
  }
  std::optional<std::vector<Suggestion>> suggestions;
  // Before the recording, whose images take long: a file that is wrong is told at once.
  if (shown) suggestions = readSuggestions(*shown);
  const LoadedSession loaded = loadSession(request.load, progress);
  const Session& session = loaded.session;
  auto& models = request.camera.models;
  // One model is meant for all cameras.
  if (models.size() == 1) models.resize(session.cameras.size(), models.front());
  GuideFramesOptions arrival;
  arrival.tolerance = request.load.read.sync_tolerance;
  arrival.arrival_s = request.arrival_s;
  const std::vector<Frame> paired = pairedFrames(session, arrival);
  const std::vector<GuideFrame> frames = guideFrames(session, arrival);
  // In a part of a recording there may have been none.
  const bool whole = request.load.read.from_s == 0 && std::isinf(request.load.read.to_s);
  if (suggestions && whole) {
    checkShownWithin(frames, *suggestions, *shown,
                     request.suggestions ? SuggestionsFile::kGiven : SuggestionsFile::kFound);
  }
  std::optional<std::vector<CameraCalibration>> given;
  if (request.cameras_file) given = readCameras(*request.cameras_file, session);
  Played played = playBothStages(request, guideRig(session, models), frames, given, progress);

  ReplayRecord record;
  attribute(record, request.provenance, loaded);
  record.target = session.target;
  record.assumptions = assumptionsOf(request.camera, request.camera_imu, &session);
  record.begin = played.guide.since();
  record.rule = ruleOf(request.guide.views);
  record.decisions = std::move(played.decisions);
  for (const GuideFrame& frame : frames) record.frames.push_back({frame.t, frame.corners, {}});
  if (request.images) {
    addImages(loaded, paired, record.frames, request.load.threads, progress);
  }
  // Frames stay as they were played: other stamps than equal ones are of different frames.
  request.camera.frames.tolerance = request.camera_imu.frames.tolerance = 0;
  const ReplayRun run{session,           frames,         record.decisions,
                      played.options,    request.camera, request.camera_imu,
                      played.camera_end, record.begin};
  Judge(request, run, played.guide, given, suggestions, progress).write(record);
  record.verdict = replayVerdict(record, request, judgeGiven(request, run, given, progress));
  return record;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/stage_summary.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "evaluate/replay/frame_shares.h"
#include "evaluate/replay/view_hindsight.h"

namespace plumbline {
namespace {

/// Why a stage did not get to its start, from its last decision that says so.
std::string startProblem(const ReplayRun& run, GuideStage stage) {
  for (const bool failed_start : {true, false}) {
    for (auto d = run.decisions.rbegin(); d != run.decisions.rend(); ++d) {
      if (d->stage != stage || d->detail.empty()) continue;
      if (failed_start && d->reason != GuideReason::kInitialiseFailed) continue;
      return fmt::format("frame {}: {}", d->frame, d->detail);
    }
  }
  return "the recording ended before the guide had enough frames to start from";
}

/// All that can be read off the decisions.
ReplayStageSummary counted(const ReplayRun& run, GuideStage stage) {
  ReplayStageSummary s;
  s.stage = stage;
  bool entered = false;
  for (const Decision& d : run.decisions) {
    if (d.stage != stage || d.reason == GuideReason::kFinished) continue;
    entered = true;
    ++s.frames_offered;
    if (d.reason == GuideReason::kBusy) ++s.frames_dropped;
    if (d.reason == GuideReason::kInitialised && !s.started) s.started = d.t;
    if (d.opened) ++s.suggestions;
    if (d.event == SuggestionEvent::kReached) ++s.reached;
  }
  s.views_used = static_cast<int>(run.accepted(stage).size());
  s.ran = s.started.has_value();
  if (const Decision* finish = run.finish(stage)) s.finished = finish->t;
  if (!s.ran)
    s.problem = entered ? startProblem(run, stage) : "the camera stage took the whole recording";
  return s;
}

/// How the camera stage used each frame, by its stamp.
std::map<TimeNs, FrameUse> frameUses(const ReplayRun& run) {
  std::map<TimeNs, FrameUse> uses;
  for (const Decision& d : run.decisions) {
    const bool passed = d.stage == GuideStage::kCamera && d.reason != GuideReason::kFinished;
    uses[d.t] = passed ? FrameUse::kPassedBy : FrameUse::kAfterFinish;
  }
  for (const int frame : run.accepted(GuideStage::kCamera)) {
    uses[run.frames[static_cast<std::size_t>(frame)].t] = FrameUse::kKept;
  }
  return uses;
}

void addHindsight(const ReplayRun& run, const CameraStageResult& kept, ReplayStageSummary& s) {
  const auto shares = frameShares(run.sessionFrom(), kept.cameras, run.camera);
  if (!shares) return;
  const std::map<TimeNs, FrameUse> use_at = frameUses(run);
  std::vector<FrameUse> uses;
  for (const Frame& frame : shares->frames) uses.push_back(use_at.at(frame.t));
  const ViewHindsight hindsight =
      viewHindsight(shares->information, uses, run.guide.views.threshold_nats);
  s.views_redundant = hindsight.redundant;
  s.views_missed = hindsight.missed;
  s.information_after_finish_nats = hindsight.after_finish_nats;
}

template <class StageResult>
void addBatches(const StageBatches<StageResult>& batches, ReplayStageSummary& s) {
  if (batches.kept) s.kept_batch = batches.kept->summary;
  if (batches.full) s.full_batch = batches.full->summary;
  if (s.problem.empty()) s.problem = batches.problem;
}

}  // namespace

StageBatches<CameraStageResult> cameraBatches(const ReplayRun& run,
                                              const Result<CameraStageResult>& kept) {
  StageBatches<CameraStageResult> out;
  CameraStageOptions options = run.camera;
  if (kept) {
    out.kept = *kept;
    options.start = kept->cameras;
  } else {
    out.problem = "batch over the views kept: " + kept.failure().message;
  }
  auto full = calibrateCameras(run.sessionFrom(), options);
  if (full) {
    out.full = std::move(full).value();
  } else if (out.problem.empty()) {
    out.problem = "batch over all frames: " + full.failure().message;
  }
  return out;
}

StageBatches<CameraImuStageResult> cameraImuBatches(const ReplayRun& run,
                                                    const std::vector<CameraCalibration>& cameras,
                                                    const Result<CameraImuStageResult>& kept) {
  StageBatches<CameraImuStageResult> out;
  if (kept) {
    out.kept = *kept;
  } else {
    out.problem = "batch over the frames kept: " + kept.failure().message;
  }
  const auto first = std::find_if(run.decisions.begin(), run.decisions.end(),
                                  [](const auto& d) { return d.stage == GuideStage::kCameraImu; });
  if (first == run.decisions.end()) return out;
  auto full = calibrateCameraImu(run.sessionFrom(first->frame), cameras, run.camera_imu);
  if (full) {
    out.full = std::move(full).value();
  } else if (out.problem.empty()) {
    out.problem = "batch over all frames: " + full.failure().message;
  }
  return out;
}

ReplayStageSummary summariseCameraStage(const ReplayRun& run,
                                        const StageBatches<CameraStageResult>& batches) {
  ReplayStageSummary s = counted(run, GuideStage::kCamera);
  addBatches(batches, s);
  if (batches.kept) addHindsight(run, *batches.kept, s);
  return s;
}

ReplayStageSummary summariseCameraImuStage(const ReplayRun& run,
                                           const StageBatches<CameraImuStageResult>& batches) {
  ReplayStageSummary s = counted(run, GuideStage::kCameraImu);
  addBatches(batches, s);
  if (s.kept_batch && s.full_batch && s.finished) {
    s.information_after_finish_nats = s.kept_batch->entropy_nats - s.full_batch->entropy_nats;
  }
  return s;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/stage_summary.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/corners.h"
#include "calibrator/information/covariance.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

Eigen::MatrixXd sumOf(const std::vector<Eigen::MatrixXd>& shares, const std::vector<FrameUse>& uses,
                      FrameUse use) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(shares.front().rows(), shares.front().cols());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (uses[i] == use) sum += shares[i];
  }
  return sum;
}

/// Why frames of this reason were no use; "" for reasons that are no refusal.
const char* refusalWords(GuideReason reason) {
  switch (reason) {
    case GuideReason::kNoTarget:
      return "they have too few corners in every camera";
    case GuideReason::kNoPose:
      return "their corners give no plausible pose with these cameras and this board";
    case GuideReason::kBadFit:
      return "their corners fit far worse than those of the views kept";
    case GuideReason::kNotInformative:
      return "they tell too little beside those before";
    case GuideReason::kNoImu:
      return "IMU samples do not cover them";
    case GuideReason::kNotSolved:
      return "the window with them did not converge";
    default:
      return "";
  }
}

/// What most of a stage's frames were refused for; "" where it is less than half of them.
std::string mostRefused(const ReplayRun& run, GuideStage stage) {
  std::map<GuideReason, std::size_t> counts;
  std::size_t all = 0;
  for (const Decision& d : run.decisions) {
    if (d.stage != stage) continue;
    ++counts[d.reason];
    ++all;
  }
  for (const auto& [reason, count] : counts) {
    const std::string words = refusalWords(reason);
    if (2 * count > all && !words.empty()) {
      return fmt::format("; {} of {} were refused: {}", count, all, words);
    }
  }
  return "";
}

/// Why a stage did not get to its start, from its last decision that says so: of a start that
/// failed, if there was one, as frames after it may complain of something lesser.
std::string startProblem(const ReplayRun& run, GuideStage stage) {
  for (const bool failed_start : {true, false}) {
    for (auto d = run.decisions.rbegin(); d != run.decisions.rend(); ++d) {
      if (d->stage != stage || d->detail.empty()) continue;
      if (failed_start && d->reason != GuideReason::kInitialiseFailed) continue;
      return fmt::format("frame {}: {}", d->frame, d->detail);
    }
  }
  return "the recording ended before the guide had enough frames to start from" +
         mostRefused(run, stage);
}

/// Why no frame came to the camera-IMU stage.
std::string entryProblem(const ReplayRun& run) {
  const Decision* finish = run.finish(GuideStage::kCamera);
  if (finish == nullptr) return "the camera stage took the whole recording";
  if (finish == &run.decisions.back()) {
    return "the camera stage finished with the recording's last frame";
  }
  return fmt::format("the camera stage finished with frame {}, but gave no cameras: {}",
                     finish->frame, finish->detail);
}

/// All that can be read off the decisions.
ReplayStageSummary counted(const ReplayRun& run, GuideStage stage) {
  ReplayStageSummary s;
  s.stage = stage;
  bool entered = false;
  for (const Decision& d : run.decisions) {
    // Frames after the finish were offered to nobody.
    if (d.stage != stage || d.reason == GuideReason::kFinished) continue;
    entered = true;
    ++s.frames_offered;
    // Dropped ones are offered ones too: a live guide would have lost them.
    if (d.reason == GuideReason::kBusy) ++s.frames_dropped;
    if (d.reason == GuideReason::kInitialised) s.started = d.t;
    if (d.reason == GuideReason::kInitialiseFailed) s.started.reset();  // it may have begun anew
    if (d.opened) ++s.suggestions;
    if (d.event == SuggestionEvent::kReached) ++s.reached;
  }
  s.views_used = static_cast<int>(run.accepted(stage).size());
  s.ran = s.started.has_value();
  if (const Decision* finish = run.finish(stage)) {
    // A stage that was ended did not say stop itself.
    (run.wasEnded(stage) ? s.ended : s.finished) = finish->t;
  }
  if (!s.ran) s.problem = entered ? startProblem(run, stage) : entryProblem(run);
  return s;
}

/// How the camera stage used each frame, by its stamp.
std::map<TimeNs, FrameUse> frameUses(const ReplayRun& run) {
  std::map<TimeNs, FrameUse> uses;
  for (const Decision& d : run.decisions) {
    // Frames of the camera-IMU stage came after the camera stage's finish.
    const bool passed = d.stage == GuideStage::kCamera && d.reason != GuideReason::kFinished;
    uses[d.t] = passed ? FrameUse::kPassedBy : FrameUse::kAfterFinish;
  }
  for (const int frame : run.accepted(GuideStage::kCamera)) {
    uses[run.frames[frame].t] = FrameUse::kKept;
  }
  return uses;
}

void addHindsight(const ReplayRun& run, const CameraStageResult& kept, ReplayStageSummary& s) {
  // All at the cameras of the frames kept, so that only the choice of frames is judged.
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

/// Both batches, and why one of them is missing.
template <class StageResult>
StageBatches<StageResult> batchesOf(Result<StageResult> kept, Result<StageResult> full) {
  StageBatches<StageResult> out;
  if (!kept) {
    out.problem = "batch over the frames kept: " + textOf(kept.failure()).message;
  } else if (!full) {
    out.problem = "batch over all frames: " + textOf(full.failure()).message;
  }
  if (kept) out.kept = std::move(kept).value();
  if (full) out.full = std::move(full).value();
  return out;
}

template <class StageResult>
void addBatches(const StageBatches<StageResult>& batches, ReplayStageSummary& s) {
  if (batches.kept) s.kept_batch = batches.kept->summary;
  if (batches.full) s.full_batch = batches.full->summary;
  if (s.problem.empty()) s.problem = batches.problem;
}

}  // namespace

Result<FrameShares> frameShares(const Session& session,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraStageOptions& options) {
  const auto scored = scoreCameras(session, cameras, options);
  if (!scored) return scored.failure();
  const std::vector<PackedCorners> corners =
      usedCorners(session, scored->frames, scored->residuals);
  CameraProblem problem;
  problem.corners = corners;
  problem.frames = scored->frames;
  problem.pixel_sigma = options.pixel_sigma;
  problem.gram = {options.cauchy_px, 0};
  problem.threads = options.threads;
  return FrameShares{scored->frames, frameInformation(problem, estimateOf(cameras, scored->T_FC0))};
}

ViewHindsight viewHindsight(const std::vector<Eigen::MatrixXd>& shares,
                            const std::vector<FrameUse>& uses, double threshold_nats) {
  assert(shares.size() == uses.size());
  ViewHindsight out;
  if (shares.empty()) return out;
  const Eigen::MatrixXd kept = sumOf(shares, uses, FrameUse::kKept);
  const Eigen::MatrixXd after = sumOf(shares, uses, FrameUse::kAfterFinish);
  // Nothing can be gained on frames that leave the cameras undetermined. Where those after the stop
  // determine them, they hold infinitely much more.
  if (!logDeterminant(kept)) {
    if (logDeterminant(kept + after)) {
      out.after_finish_nats = std::numeric_limits<double>::infinity();
    }
    return out;
  }
  out.after_finish_nats = mutualInformationNats(kept, kept + after).value_or(0);
  Eigen::MatrixXd fewer = kept;
  Eigen::MatrixXd more = kept;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (uses[i] == FrameUse::kKept) {
      // Without a gain the rest does not determine the cameras: the frame is needed. What went
      // before counts as gone, so that of two alike one stays.
      const auto gain = mutualInformationNats(fewer - shares[i], fewer);
      if (!gain || *gain >= threshold_nats) continue;
      ++out.redundant;
      fewer -= shares[i];
    } else if (uses[i] == FrameUse::kPassedBy) {
      // Likewise what was added counts, so that a second one like it was not missed.
      const auto gain = mutualInformationNats(more, more + shares[i]);
      if (!gain || *gain < threshold_nats) continue;
      ++out.missed;
      more += shares[i];
    }
  }
  return out;
}

StageBatches<CameraStageResult> cameraBatches(const ReplayRun& run,
                                              const Result<CameraStageResult>& guides_own) {
  CameraStageOptions options = run.camera;
  if (guides_own) options.start = guides_own->cameras;
  auto kept = calibrateCameras(run.sessionOfFrames(run.accepted(GuideStage::kCamera)), options);
  // In one minimum: batches in different ones would differ by more than their frames.
  if (kept) options.start = kept->cameras;
  return batchesOf(std::move(kept), calibrateCameras(run.sessionFrom(), options));
}

StageBatches<CameraImuStageResult> cameraImuBatches(const ReplayRun& run,
                                                    const std::vector<CameraCalibration>& cameras) {
  const auto first = std::ranges::find(run.decisions, GuideStage::kCameraImu, &Decision::stage);
  if (first == run.decisions.end()) return {};
  const auto batch = [&](const Session& session) -> Result<CameraImuStageResult> {
    auto stage = calibrateCameraImu(session, cameras, run.camera_imu);
    if (stage && !stage->summary.converged) return notConverged(*stage);
    return stage;
  };
  return batchesOf(batch(run.sessionOfFrames(run.accepted(GuideStage::kCameraImu))),
                   batch(run.sessionFrom(first->frame)));
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
    // What information lowers is entropy, in the same nats.
    s.information_after_finish_nats = s.kept_batch->entropy_nats - s.full_batch->entropy_nats;
  }
  return s;
}

}  // namespace plumbline

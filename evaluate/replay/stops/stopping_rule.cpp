// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/stops/stopping_rule.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/guidance/trajectories/imu_reprojection.h"
#include "calibrator/guidance/views/view_error.h"
#include "calibrator/information/covariance.h"
#include "evaluate/metrics/calibration/distances.h"
#include "evaluate/replay/frame_split.h"
#include "evaluate/replay/frames.h"
#include "evaluate/replay/stops/sufficiency.h"

namespace plumbline {
namespace {

/// Growing numbers from `least` to `most`, `between` among them if it lies there.
std::vector<int> checkpointCounts(int least, int most, int count, int between) {
  std::set<int> counts;
  if (most < least) return {};
  // Geometric, since errors fall by ratios of views; between two of them nothing is tried.
  const double ratio = std::max(1.0, static_cast<double>(most) / least);
  for (int i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 1;
    counts.insert(static_cast<int>(std::lround(least * std::pow(ratio, share))));
  }
  if (between >= least && between <= most) counts.insert(between);
  return {counts.begin(), counts.end()};
}

/// Evenly spread positions of frames with corners that are not in `kept`.
std::vector<int> heldOutFrames(const ReplayRun& run, const std::vector<int>& kept, int most) {
  std::vector<int> others;
  for (const Decision& d : run.decisions) {
    if (d.corners > 0 && !std::binary_search(kept.begin(), kept.end(), d.frame)) {
      others.push_back(d.frame);
    }
  }
  return thinned(others, most);
}

/// The frames kept, then those after "finish" that the same threshold would have taken.
std::vector<int> keptAndContinued(const ReplayRun& run, const CameraStageResult& kept_batch) {
  std::vector<int> order = run.accepted(GuideStage::kCamera);
  const Decision* finish = run.finish(GuideStage::kCamera);
  if (finish == nullptr) return order;
  const auto shares = frameShares(run.sessionFrom(), kept_batch.cameras, run.camera);
  if (!shares) return order;
  std::map<TimeNs, int> position;
  for (const GuideFrame& frame : run.frames) position[frame.t] = frame.index;
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(shares->information.front().rows(), shares->information.front().cols());
  for (std::size_t i = 0; i < shares->frames.size(); ++i) {
    const int frame = position.at(shares->frames[i].t);
    const Eigen::MatrixXd& share = shares->information[i];
    if (shares->frames[i].t > finish->t) {
      // Without a gain the frames so far do not determine the cameras: any is taken.
      const auto gain = mutualInformationNats(information, information + share);
      if (gain && *gain < run.guide.views.threshold_nats) continue;
      order.push_back(frame);
      information += share;
    } else if (std::binary_search(order.begin(), order.end(), frame)) {
      information += share;
    }
  }
  return order;
}

/// The time of the frame from which on the first frames of `order` are enough for good, tried at
/// some numbers of them; empty if even the last one is not.
std::optional<TimeNs> enoughSince(const ReplayRun& run, const std::vector<int>& order,
                                  const std::vector<int>& counts, const auto& is_enough) {
  std::optional<TimeNs> since;
  for (const int count : counts) {
    if (!is_enough(run.sessionOfFrames({order.begin(), order.begin() + count}))) {
      since.reset();
    } else if (!since) {
      since = run.frames[order[count - 1]].t;
    }
  }
  return since;
}

std::string sinceStart(const ReplayRun& run, TimeNs t) {
  return fmt::format("{:.1f} s", secondsBetween(run.begin(), t));
}

/// Until when a guide that did not say stop could have.
std::string beforeEnd(const ReplayRun& run, const StopAudit& audit) {
  if (!audit.ended) {
    return "before the recording ended at " + sinceStart(run, run.frames.back().t);
  }
  const std::string at = sinceStart(run, *audit.ended);
  if (run.camera_end == CameraStageEnd::kTime) return "before its stage was ended at " + at;
  return fmt::format("in the whole recording of {}, so its stage was ended at half of it, {}",
                     sinceStart(run, run.frames.back().t), at);
}

/// Early, late or right, once it is known when the frames were sufficient.
void judge(const ReplayRun& run, const StoppingRuleOptions& options, const std::string& what,
           StopAudit& audit) {
  const TimeNs end = run.frames.back().t;
  const std::string reached =
      audit.enough ? "sufficient from " + sinceStart(run, *audit.enough) + " on"
      : audit.all_suffice.value_or(false)
          ? "never sufficient, while all frames of the recording are"
          : "never sufficient in this recording, the deviations of all frames' calibration alone "
            "exceed the bars";
  if (!audit.finished) {
    audit.verdict = StopAudit::Verdict::kNeverStopped;
    audit.explanation =
        fmt::format("the guide did not say stop {}; {}: {}", beforeEnd(run, audit), what, reached);
    const TimeNs until = audit.ended.value_or(end);
    if (audit.enough && *audit.enough < until) {
      audit.seconds = secondsBetween(*audit.enough, until);
    }
    // Where the stage went on beyond its last frame nobody knows how late its stop would have been.
    if (audit.seconds > options.tolerance_s) {
      audit.explanation +=
          fmt::format(", so that a stop is late by {:.1f} s at least", audit.seconds);
    }
    return;
  }
  const std::string said = "the guide said stop at " + sinceStart(run, *audit.finished);
  audit.saved_s = secondsBetween(*audit.finished, end);
  // What was not enough at the recording's end was stopped too early by that much at least.
  if (!audit.enough || *audit.enough > *audit.finished) {
    audit.verdict = StopAudit::Verdict::kEarly;
    audit.seconds = secondsBetween(*audit.finished, audit.enough.value_or(end));
  } else if (secondsBetween(*audit.enough, *audit.finished) > options.tolerance_s) {
    audit.verdict = StopAudit::Verdict::kLate;
    audit.seconds = secondsBetween(*audit.enough, *audit.finished);
  } else {
    audit.verdict = StopAudit::Verdict::kRight;
  }
  audit.explanation = fmt::format("{}; {}: {}", said, what, reached);
}

template <class StageResult>
StopAudit auditOf(const ReplayRun& run, GuideStage stage,
                  const StageBatches<StageResult>& batches) {
  StopAudit audit;
  audit.stage = stage;
  if (const Decision* finish = run.finish(stage)) {
    (run.wasEnded(stage) ? audit.ended : audit.finished) = finish->t;
  }
  if (batches.kept) audit.entropy_at_finish_nats = batches.kept->summary.entropy_nats;
  if (batches.full) audit.entropy_of_all_nats = batches.full->summary.entropy_nats;
  return audit;
}

/// What a stage predicted last.
std::optional<double> lastOf(const ReplayRun& run, GuideStage stage,
                             std::optional<double> Decision::*prediction) {
  for (auto d = run.decisions.rbegin(); d != run.decisions.rend(); ++d) {
    if (d->stage == stage && (*d).*prediction) return (*d).*prediction;
  }
  return std::nullopt;
}

void measured(const Distance& px, StopAudit& audit) {
  audit.measured_px = px.value;
  audit.reference_std_px = px.std;
}

StopAudit notJudged(StopAudit audit, const std::string& why) {
  audit.verdict = StopAudit::Verdict::kNotJudged;
  audit.explanation = "not judged: " + why;
  return audit;
}

/// The excess that the guide's model predicts of frames like those held out, for the cameras of the
/// views kept: the same frames as the measured one. Empty: it cannot be predicted.
std::optional<double> predictedExcessOn(const ReplayRun& run, const std::vector<int>& held_out,
                                        const std::vector<CameraCalibration>& cameras) {
  ViewErrorOptions options = run.guide.views;
  options.later_use = LaterUseKind::kSeen;
  options.most_seen = std::max(2, static_cast<int>(held_out.size()));
  const AprilGrid& target = run.session.target;
  const CameraEstimate estimate = estimateOf(cameras);
  ViewErrorTracker errors(target, options);
  const auto forPosed = [&](const std::vector<int>& frames, const auto& take) {
    for (const int i : frames) {
      const auto corners =
          usableViews(run.frames[static_cast<std::size_t>(i)], cameras.size(), options.min_corners);
      const auto T_FC0 = poseOf(target, estimate, corners, options.cauchy_px);
      if (T_FC0) take(corners, *T_FC0);
    }
  };
  forPosed(held_out, [&](const auto& corners, const auto& T_FC0) { errors.see(corners, T_FC0); });
  forPosed(run.accepted(GuideStage::kCamera),
           [&](const auto& corners, const auto& T_FC0) { errors.keep(corners, T_FC0); });
  errors.refresh(estimate, cameras, run.guide.threads);
  return errors.isKnown() ? std::optional(errors.excess()) : std::nullopt;
}

}  // namespace

void StoppingRuleOptions::check() const {
  if (!(held_out_factor > 1)) throw InputError("held_out_factor must be above 1");
  if (held_out_frames < 1) throw InputError("at least one frame must be held out");
  if (checkpoints < 2) throw InputError("\"enough\" is searched over 2 or more numbers of frames");
  if (!(tolerance_s >= 0)) throw InputError("the tolerance of a stop must not be negative");
  if (!(projection_px >= 0)) throw InputError("projection_px must not be negative");
  if (!(translation_m > 0 && rotation_rad > 0 && offset_s > 0)) {
    throw InputError("translation_m, rotation_rad and offset_s must be positive");
  }
}

StopAudit judgeCameraStop(const ReplayRun& run, const StageBatches<CameraStageResult>& batches,
                          const StoppingRuleOptions& options) {
  options.check();
  StopAudit audit = auditOf(run, GuideStage::kCamera, batches);
  if (!batches.kept || !batches.full) {
    return notJudged(std::move(audit), batches.problem);
  }
  const int finished_with = static_cast<int>(run.accepted(GuideStage::kCamera).size());
  const std::vector<int> order = keptAndContinued(run, *batches.kept);
  // Frames that no checkpoint uses, so that the error of each is one of prediction. The full batch,
  // which they are held against, has seen them: its error is too small rather than too large.
  const std::vector<int> others = heldOutFrames(run, order, options.held_out_frames);
  const Session held_out = run.sessionOfFrames(others);
  const auto best = heldOutError(held_out, batches.full->cameras, run.camera);
  if (!best) {
    return notJudged(std::move(audit), "no frame with a pose was left to be held out");
  }
  const CameraBars bars = barsOf(run.guide.views.stop_projection_px, *best, options);
  const auto shortfall = [&](const std::vector<CameraCalibration>& cameras) {
    return shortfallOf(cameras, *batches.full, held_out, run.camera);
  };
  CameraStageOptions camera = run.camera;
  // All checkpoints in the minimum of the batch that they are held against.
  camera.start = batches.kept->cameras;
  const auto counts = checkpointCounts(run.guide.views.start_frames, static_cast<int>(order.size()),
                                       options.checkpoints, finished_with);
  audit.enough = enoughSince(run, order, counts, [&](const Session& session) {
    const auto batch = calibrateCameras(session, camera);
    return batch && bars.areMetBy(shortfall(batch->cameras));
  });
  const CameraShortfall kept = shortfall(batches.kept->cameras);
  audit.all_suffice = bars.areMetBy(shortfall(batches.full->cameras));
  if (kept.held_out_px) audit.measured_excess = *kept.held_out_px / *best - 1;
  audit.predicted_excess = lastOf(run, GuideStage::kCamera, &Decision::excess);
  audit.held_out_excess = predictedExcessOn(run, others, batches.kept->cameras);
  audit.predicted_px = lastOf(run, GuideStage::kCamera, &Decision::projection_px);
  measured(kept.projection_px, audit);
  judge(run, options, cameraWords(kept, bars, *best, others.size(), audit), audit);
  return audit;
}

StopAudit judgeCameraImuStop(const ReplayRun& run, const std::vector<CameraCalibration>& cameras,
                             const StageBatches<CameraImuStageResult>& batches,
                             const StoppingRuleOptions& options) {
  options.check();
  StopAudit audit = auditOf(run, GuideStage::kCameraImu, batches);
  if (!batches.kept || !batches.full) {
    return notJudged(std::move(audit), batches.problem);
  }
  const std::vector<int> kept = run.accepted(GuideStage::kCameraImu);
  CameraImuOptions imu = run.camera_imu;
  // Densities do not matter here, and the check costs a part of every batch.
  imu.noise_check = false;
  std::vector<int> order(run.frames.size() - static_cast<std::size_t>(kept.front()));
  std::iota(order.begin(), order.end(), kept.front());
  // In frames of the recording, as `order` counts: those kept and all between them.
  const int finished_with = kept.back() - kept.front() + 1;
  const auto counts =
      checkpointCounts(run.guide.trajectories.start_frames, static_cast<int>(order.size()),
                       options.checkpoints, finished_with);
  const ImuReprojection use(cameras);
  const double bar_px = run.guide.trajectories.stop_reprojection_px;
  const CameraImuStageResult& full = *batches.full;
  const double full_px = std::sqrt(use.expectedErrorUnder(imuCovariance(full), full.imu.T_SC0));
  const auto points = [&](const ImuCalibration& of) {
    return Distance{use.differencePx(of, full.imu), full_px};
  };
  audit.enough = enoughSince(run, order, counts, [&](const Session& session) {
    const auto batch = calibrateCameraImu(session, cameras, imu);
    // Frames that cannot be solved are not enough.
    if (!batch || !batch->summary.converged) return false;
    // As for the cameras, by the measure that the stage stopped by.
    return bar_px > 0 ? points(batch->imu).expectedError() <= bar_px
                      : isNear(imuDistance(batch->imu, full), options);
  });
  audit.predicted_px = lastOf(run, GuideStage::kCameraImu, &Decision::error_px);
  const Distance kept_px = points(batches.kept->imu);
  audit.all_suffice = bar_px > 0 ? full_px <= bar_px : isNear(imuDistance(full.imu, full), options);
  // Of a stage that went on to the end both are calibrations of the same frames.
  if (audit.finished) measured(kept_px, audit);
  judge(run, options,
        bar_px > 0 ? pointsWords(kept_px, audit, bar_px)
                   : armWords(imuDistance(batches.kept->imu, full), options),
        audit);
  return audit;
}

}  // namespace plumbline

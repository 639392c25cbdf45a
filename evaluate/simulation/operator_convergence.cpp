// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/operator_convergence.h"

#include <cmath>
#include <limits>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/trajectories/imu_reprojection.h"
#include "evaluate/compare/projection_difference.h"

namespace plumbline {
namespace {

/// Positions of the frames that a calibration at t_s stands on.
struct Checkpoint {
  double t_s = 0;
  std::vector<int> frames;
};

class ConvergenceJudge {
 public:
  ConvergenceJudge(const OperatedSession& operated, const OperatedOptions& made,
                   const Calibration& truth, const ConvergenceOptions& options)
      : operated_(operated), made_(made), truth_(truth), options_(options) {}

  OperatedConvergence judged() {
    OperatedConvergence c;
    c.cameras = stage(cameraCheckpoints(),
                      [&](const auto& session, auto& point) { camerasAt(session, point); });
    // Without cameras there is nothing to calibrate the IMU against.
    if (!cameras_.empty()) {
      c.camera_imu = stage(everyFrame(GuideStage::kCameraImu),
                           [&](const auto& session, auto& point) { imuAt(session, point); });
    }
    for (const Decision& d : operated_.decisions) {
      if (d.mode != GuideMode::kFinished) continue;
      StageConvergence& s = d.stage == GuideStage::kCamera ? c.cameras : c.camera_imu;
      if (!s.stopped_s) s.stopped_s = secondsAt(d.frame) - beginOf(d.stage);
    }
    return c;
  }

 private:
  double secondsAt(int frame) const {
    const auto& views = operated_.session.cameras.front().views;
    return secondsBetween(views.front().t, views[frame].t);
  }
  int frames() const { return static_cast<int>(operated_.session.cameras.front().views.size()); }
  /// Stages last sums of frames' periods, beside which stamps are rounded: to the nearest frame.
  double halfPeriod() const { return frames() > 1 ? 0.5 * secondsAt(1) : 0; }
  double beginOf(GuideStage stage) const {
    return stage == GuideStage::kCamera ? 0 : operated_.camera_s;
  }

  /// Calibrates at each until it has been right often enough, and at the last.
  template <class At>
  StageConvergence stage(const std::vector<Checkpoint>& checkpoints, const At& at) {
    StageConvergence s;
    int right = 0;
    for (const Checkpoint& checkpoint : checkpoints) {
      const bool last = &checkpoint == &checkpoints.back();
      // Decided: only the end is calibrated besides.
      if (right >= options_.in_a_row && !last) continue;
      ConvergencePoint point;
      point.t_s = checkpoint.t_s;
      point.views = static_cast<int>(checkpoint.frames.size());
      at(recordingOf(checkpoint.frames), point);
      if (last) s.at_end = point;
      if (right >= options_.in_a_row) break;
      s.points.push_back(point);
      right = point.right ? right + 1 : 0;
    }
    // Right at the end, but not so often in a row: from the first of those.
    if (right == 0) return s;
    const ConvergencePoint& first = s.points[s.points.size() - static_cast<std::size_t>(right)];
    s.right_s = first.t_s;
    s.right_views = first.views;
    return s;
  }

  /// Of a guided recording: after views that the guide kept.
  std::vector<Checkpoint> cameraCheckpoints() const {
    if (operated_.decisions.empty()) return everyFrame(GuideStage::kCamera);
    std::vector<Checkpoint> all;
    const std::vector<KeptViews> kept = keptViews(operated_);
    double next = 0;
    for (const KeptViews& k : kept) {
      // A calibration each time that the views have grown by the factor, and at the stop.
      if (static_cast<double>(k.frames.size()) < next && !k.finished) continue;
      all.push_back({k.t_s, k.frames});
      next = options_.growth * static_cast<double>(k.frames.size());
    }
    if (!all.empty() && all.back().frames != kept.back().frames) {
      // The stage may go on after the last view that was kept; what it ended with counts at its
      // end.
      all.push_back({operated_.camera_s, kept.back().frames});
    }
    return all;
  }

  /// All frames of a stage up to times that grow geometrically.
  std::vector<Checkpoint> everyFrame(GuideStage stage) const {
    const double begin = beginOf(stage), half = halfPeriod();
    const double end = stage == GuideStage::kCamera ? operated_.camera_s
                                                    : operated_.camera_s + operated_.camera_imu_s;
    std::vector<Checkpoint> all;
    std::vector<int> taken;
    double next_s = options_.first_s;
    for (int k = 0; k < frames(); ++k) {
      const double t_s = secondsAt(k);
      if (t_s < begin - half || t_s >= end - half) continue;
      taken.push_back(k);
      if (t_s - begin < next_s) continue;
      all.push_back({t_s - begin, taken});
      // Geometric: a recording of any length takes some dozens of calibrations.
      next_s *= options_.growth;
    }
    if (!taken.empty() && (all.empty() || all.back().frames != taken)) {
      all.push_back({end - begin, taken});
    }
    return all;
  }

  Session recordingOf(const std::vector<int>& frames) const {
    Session session = operated_.session;
    session.target.shape = made_.guide_shape;
    for (std::size_t c = 0; c < session.cameras.size(); ++c) {
      session.cameras[c].views.clear();
      const auto& all = operated_.session.cameras[c].views;
      for (const int k : frames) session.cameras[c].views.push_back(all[k]);
    }
    if (session.imu) {
      const auto& views = session.cameras.front().views;
      // What had arrived with the last frame, and as much before the first.
      const TimeNs margin = toNanoseconds(made_.arrival_s);
      std::erase_if(session.imu->samples, [&](const ImuSample& s) {
        return s.t < views.front().t - margin || s.t > views.back().t + margin;
      });
    }
    return session;
  }

  void camerasAt(Session session, ConvergencePoint& point) {
    session.imu.reset();
    const auto found = calibrateCameras(session);
    if (!found) return;
    // In the end those of the last checkpoint that gave any: the camera-IMU stage stands on them.
    cameras_ = found->cameras;
    point.projection_px = 0;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const double px = trueProjectionErrorPx(truth_.cameras[c].intrinsics, cameras_[c].intrinsics);
      if (isLarger(px, *point.projection_px)) point.projection_px = px;
    }
    point.right = *point.projection_px <= options_.projection_px;
  }

  void imuAt(const Session& session, ConvergencePoint& point) const {
    CameraImuOptions stage;
    // Findings about the recording, of which nothing is used here.
    stage.noise_check = stage.diagnose_faults = false;
    const auto found = calibrateCameraImu(session, cameras_, stage);
    // Where it ran out of steps is no calibration.
    if (!found || !found->summary.converged) return;
    const Transform& T_SC0 = truth_.imu->T_SC0;
    point.translation_m = (found->imu.T_SC0.t - T_SC0.t).norm();
    point.rotation_rad = rotationAngle(found->imu.T_SC0.R.transpose() * T_SC0.R);
    point.reprojection_px = ImuReprojection(truth_.cameras).differencePx(found->imu, *truth_.imu);
    point.right = *point.translation_m <= options_.translation_m &&
                  *point.rotation_rad <= options_.rotation_rad;
  }

  const OperatedSession& operated_;
  const OperatedOptions& made_;
  const Calibration& truth_;
  ConvergenceOptions options_;
  std::vector<CameraCalibration> cameras_;  // of the last calibration
};

}  // namespace

void ConvergenceOptions::check() const {
  requireWithin(1e-6, 1e3, "projection_px", projection_px);
  requireWithin(1e-9, 1e3, "translation_m", translation_m);
  requireWithin(1e-9, 4, "rotation_rad", rotation_rad);
  requireWithin(1, 100, "in_a_row", in_a_row);
  requireWithin(0.1, 1e3, "first_s", first_s);
  requireWithin(1.01, 10, "growth", growth);
}

std::vector<KeptViews> keptViews(const OperatedSession& operated, GuideStage stage) {
  std::vector<KeptViews> all;
  std::vector<int> kept;
  std::optional<TimeNs> begin;
  for (const Decision& d : operated.decisions) {
    if (d.stage != stage) continue;
    if (!begin) begin = d.t;
    for (const int gone : d.withdrawn) std::erase(kept, gone);
    if (d.accepted) kept.push_back(d.frame);
    const bool changed = d.accepted || !d.withdrawn.empty();
    const bool stops = d.mode == GuideMode::kFinished && (all.empty() || !all.back().finished);
    if ((!changed && !stops) || d.mode == GuideMode::kInitialising) continue;
    const auto predicted = stage == GuideStage::kCamera ? d.projection_px : d.error_px;
    all.push_back({secondsBetween(*begin, d.t), kept, predicted, d.mode == GuideMode::kFinished});
  }
  return all;
}

double trueProjectionErrorPx(const Intrinsics& truth, const Intrinsics& estimate) {
  DifferenceOptions whole;
  // Every place of the image counts alike, whether corners were seen there or not.
  whole.weights.assign(static_cast<std::size_t>(whole.grid.size()), 1.0);
  const auto difference = projectionDifference(truth, estimate, whole);
  double squares = 0;
  int defined = 0;
  if (difference) {
    for (const Eigen::Vector2d& d : difference->vectors) {
      if (!d.allFinite()) continue;
      squares += d.squaredNorm();
      ++defined;
    }
  }
  // Pixels that the estimate does not see at all must not make it look better.
  if (2 * defined < whole.grid.size()) return std::numeric_limits<double>::infinity();
  return std::sqrt(squares / defined);
}

OperatedConvergence convergenceOf(const OperatedSession& operated, const OperatedOptions& made,
                                  const Calibration& truth, const ConvergenceOptions& options) {
  options.check();
  return ConvergenceJudge(operated, made, truth, options).judged();
}

}  // namespace plumbline

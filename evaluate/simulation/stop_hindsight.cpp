// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/stop_hindsight.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/guidance/trajectories/imu_reprojection.h"
#include "calibrator/information/projection_uncertainty.h"
#include "calibrator/simulate/operator/rig_sensors.h"
#include "evaluate/simulation/operator_convergence.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kDrawSeeds = 1'000'003;  // from one draw's seed to the next

/// The frames as they would have been seen under other noise.
Session seenAgain(const Operation& of, const std::vector<int>& frames,
                  const SimulationOptions& simulation) {
  Session session = of.operated.session;
  session.target.shape = of.made.guide_shape;
  // The camera stage has no use for it.
  session.imu.reset();
  for (CameraStream& camera : session.cameras) camera.views.clear();
  for (const int k : frames) {
    const auto at = static_cast<std::size_t>(k);
    auto corners = cornersAt(of.rig, of.operated.T_FC0[at], k, simulation);
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const TimeNs t = of.operated.session.cameras[c].views[at].t;
      session.cameras[c].views.push_back({t, std::move(corners[c])});
    }
  }
  return session;
}

CameraStageOptions startingAt(const std::vector<CameraCalibration>& truth) {
  CameraStageOptions stage;
  stage.start = truth;
  return stage;
}

/// Mean square over the image of what the covariance says of a camera's projections, for corners
/// of the stage's pixel_sigma.
std::optional<double> unitMeanSquare(const CameraStageResult& found, std::size_t camera) {
  const Intrinsics& intrinsics = found.cameras[camera].intrinsics;
  const CameraLayout layout(estimateOf(found.cameras).intrinsics);
  const int k = layout.intrinsics[camera], size = layout.intrinsics_size[camera];
  const Eigen::MatrixXd& covariance = found.summary.covariance.matrix;
  // Without a covariance of the cameras.
  if (covariance.rows() < layout.camerasSize()) return std::nullopt;
  return imageFitMeanSquare(intrinsics, covariance.block(k, k, size, size));
}

/// The frames' measurements of the camera-IMU stage as they would have been under other noise.
Session recordedAgain(const Operation& of, const std::vector<int>& frames,
                      const SimulationOptions& simulation) {
  RigSensors sensors(of.rig, simulation);
  Session session = sensors.emptySession();
  session.target.shape = of.made.guide_shape;
  for (const int k : frames) {
    auto corners = sensors.corners(of.operated.motion, k);
    for (std::size_t c = 0; c < corners.size(); ++c) {
      session.cameras[c].views.push_back({sensors.stampOf(k), std::move(corners[c])});
    }
  }
  const TimeNs margin = toNanoseconds(of.made.arrival_s);
  const TimeNs begin = sensors.stampOf(frames.front()) - margin;
  session.imu->samples =
      sensors.samplesUntil(of.operated.motion, sensors.stampOf(frames.back()) + margin);
  // The sensors give all samples from the recording's beginning on.
  std::erase_if(session.imu->samples, [begin](const ImuSample& s) { return s.t < begin; });
  return session;
}

/// As the guide's batch has it.
CameraImuOptions imuStageOptions(const Operation& of) {
  CameraImuOptions stage;
  stage.model() = of.made.guide.trajectories.model();
  // Findings about the recording, of which nothing is used here.
  stage.noise_check = stage.diagnose_faults = false;
  return stage;
}

/// What the stage's predicted error is held against [px]; 0: nothing.
template <class Options>
auto& barOf(Options& guide, GuideStage stage) {
  return stage == GuideStage::kCamera ? guide.views.stop_projection_px
                                      : guide.trajectories.stop_reprojection_px;
}

/// First of the sets of views with which the expected error is at most the bar, and the errors of
/// those that were looked at.
class Crossing {
 public:
  Crossing(const Operation& of, GuideStage stage)
      : of_(of), stage_(stage), kept_(keptViews(of.operated, stage)) {}

  const std::vector<KeptViews>& kept() const { return kept_; }
  std::optional<double> expectedPx(std::size_t i) {
    const auto found = known_.find(i);
    if (found != known_.end()) return found->second;
    const auto expected =
        stage_ == GuideStage::kCamera ? expectedProjectionPx : expectedReprojectionPx;
    return known_[i] = expected(of_, kept_[i].frames);
  }
  bool isWithin(std::size_t i) {
    const auto px = expectedPx(i);
    return px && *px <= barOf(of_.made.guide, stage_);
  }
  /// Empty where not even the last is.
  std::optional<std::size_t> first() {
    if (kept_.empty() || !isWithin(kept_.size() - 1)) return std::nullopt;
    std::size_t low = 0, high = kept_.size() - 1;  // high is within, what is before low is not
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      if (isWithin(middle)) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return high;
  }

 private:
  Operation of_;
  GuideStage stage_;
  std::vector<KeptViews> kept_;
  // Each costs a calibration.
  std::map<std::size_t, std::optional<double>> known_;
};

void tellBest(Crossing& crossing, StopHindsight& s) {
  if (crossing.kept().empty()) return;
  const auto best = crossing.first();
  if (!best) {
    s.searched_s = crossing.kept().back().t_s;
    s.expected_at_end_px = crossing.expectedPx(crossing.kept().size() - 1);
    return;
  }
  const KeptViews& kept = crossing.kept()[*best];
  s.best_s = kept.t_s;
  s.best_views = static_cast<int>(kept.frames.size());
  s.predicted_at_best_px = kept.predicted_px;
}

/// The same person, who is not told to stop at the bar yet.
OperatedSession continued(const Operation& of, GuideStage stage, double stopped_s,
                          const HindsightOptions& options) {
  OperatedOptions longer = of.made;
  const double begin_s = stage == GuideStage::kCamera ? 0 : of.operated.camera_s;
  // Of this stage alone: all before its stop is made again as it was.
  barOf(longer.guide, stage) *= options.beyond;
  longer.simulation.duration_s =
      std::min(of.made.simulation.duration_s, begin_s + options.beyond_times * stopped_s);
  return recordGuided(of.rig, longer);
}

}  // namespace

std::optional<double> expectedProjectionPx(const Operation& of, const std::vector<int>& frames) {
  const std::vector<CameraCalibration>& truth = of.rig.calibration.cameras;
  SimulationOptions exact = of.made.simulation;
  exact.corner_sigma_px = 0;
  const auto found = calibrateCameras(seenAgain(of, frames, exact), startingAt(truth));
  if (!found) return std::nullopt;
  const double sigma = of.made.simulation.corner_sigma_px / CameraStageOptions().pixel_sigma;
  // Of the worst camera, as the guide's prediction is.
  double worst = 0;
  for (std::size_t c = 0; c < truth.size(); ++c) {
    const auto unit = unitMeanSquare(*found, c);
    if (!unit) return std::nullopt;
    const double bias = trueProjectionErrorPx(truth[c].intrinsics, found->cameras[c].intrinsics);
    // The covariance is of corners with pixel_sigma; their true noise is `sigma` times that.
    const double square = bias * bias + sigma * sigma * *unit;
    if (isLarger(square, worst)) worst = square;
  }
  return std::sqrt(worst);
}

std::optional<double> drawnProjectionPx(const Operation& of, const std::vector<int>& frames,
                                        int draws) {
  const std::vector<CameraCalibration>& truth = of.rig.calibration.cameras;
  std::vector<double> squares(truth.size(), 0.0);
  for (int draw = 0; draw < draws; ++draw) {
    SimulationOptions again = of.made.simulation;
    again.seed += kDrawSeeds * static_cast<std::uint64_t>(draw + 1);
    const auto found = calibrateCameras(seenAgain(of, frames, again), startingAt(truth));
    if (!found) return std::nullopt;
    for (std::size_t c = 0; c < truth.size(); ++c) {
      // Of each camera over the draws; the worst of these is taken, not the mean over the worst of
      // each draw.
      const double px = trueProjectionErrorPx(truth[c].intrinsics, found->cameras[c].intrinsics);
      squares[c] += px * px / draws;
    }
  }
  double worst = 0;
  for (const double square : squares) {
    if (isLarger(square, worst)) worst = square;
  }
  return std::sqrt(worst);
}

std::optional<double> expectedReprojectionPx(const Operation& of, const std::vector<int>& frames) {
  const Calibration& truth = of.rig.calibration;
  SimulationOptions exact = of.made.simulation;
  exact.corner_sigma_px = 0;
  // Bias walks and white noise; the initial biases stay, as states that the batch estimates.
  exact.imu_noise = false;
  const CameraImuOptions stage = imuStageOptions(of);
  const Session session = recordedAgain(of, frames, exact);
  const auto found = calibrateCameraImu(session, truth.cameras, stage);
  if (!found || !found->summary.converged) return std::nullopt;
  const double sigma = of.made.simulation.corner_sigma_px / stage.pixel_sigma;
  const auto covariance = covarianceUnder(solvedBatch(session, *found, stage), {.corner = sigma});
  if (!covariance) return std::nullopt;
  const ImuReprojection use(truth.cameras);
  // Without noise, what is off is what the model leaves out, as the board's shape.
  const double bias = use.differencePx(found->imu, *truth.imu);
  return std::sqrt(bias * bias + use.expectedErrorUnder(*covariance, truth.imu->T_SC0));
}

std::optional<double> drawnReprojectionPx(const Operation& of, const std::vector<int>& frames,
                                          int draws) {
  const Calibration& truth = of.rig.calibration;
  const ImuReprojection use(truth.cameras);
  double squares = 0;
  int converged = 0;
  for (int draw = 0; draw < draws; ++draw) {
    SimulationOptions again = of.made.simulation;
    again.seed += kDrawSeeds * static_cast<std::uint64_t>(draw + 1);
    const auto found =
        calibrateCameraImu(recordedAgain(of, frames, again), truth.cameras, imuStageOptions(of));
    if (!found) return std::nullopt;
    // Where it ran out of steps it says nothing of the noise.
    if (!found->summary.converged) continue;
    const double px = use.differencePx(found->imu, *truth.imu);
    squares += px * px;
    ++converged;
  }
  if (converged == 0) return std::nullopt;
  return std::sqrt(squares / converged);
}

std::optional<StopHindsight> stopHindsight(const Operation& of, GuideStage stage,
                                           const HindsightOptions& options) {
  Crossing crossing(of, stage);
  const std::vector<KeptViews>& kept = crossing.kept();
  const bool stopped = !kept.empty() && kept.back().finished && kept.back().predicted_px;
  // A stage without a bar ends by its criterion, which is not judged here.
  if (!(barOf(of.made.guide, stage) > 0) || !stopped) return std::nullopt;
  const auto drawn = stage == GuideStage::kCamera ? drawnProjectionPx : drawnReprojectionPx;
  StopHindsight s;
  s.stopped_s = kept.back().t_s;
  s.predicted_px = *kept.back().predicted_px;
  s.views = static_cast<int>(kept.back().frames.size());
  s.expected_px = crossing.expectedPx(kept.size() - 1);
  s.drawn_px = drawn(of, kept.back().frames, options.draws);
  if (crossing.isWithin(kept.size() - 1)) {
    tellBest(crossing, s);
    return s;
  }
  // What the guide would have gone on to ask for, had the bar been lower: the bar that counts is
  // still the first.
  const OperatedSession longer = continued(of, stage, s.stopped_s, options);
  Crossing beyond({longer, of.made, of.rig}, stage);
  tellBest(beyond, s);
  return s;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/noise_watch.h"

#include <algorithm>
#include <cmath>

#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/guidance/trajectories/imu_reprojection.h"

namespace plumbline {
namespace {

// Frames kept at one batch that judges the noise over those at the one before. Geometric, so that
// all batches together cost three times the last one.
constexpr double kFrameGrowth = 1.5;

/// A factor that residuals suggest with a relative standard deviation of `std`, drawn to 1 the more
/// the less it is beyond two of them: what chance makes of a true 1 seldom delays a stop, and what
/// is large stays (positive-part shrinkage of the logarithm after James and Stein, 1961).
double beyondChance(double factor, double std) {
  const double far = std::log(factor);
  const double chance = 4 * std * std;
  return far * far > chance ? std::exp(far * (1 - chance / (far * far))) : 1;
}

double beyondChance(const ImuNoiseCheck& check) {
  if (!(check.redundancy > 0)) return 1;
  return beyondChance(check.factor, 1 / std::sqrt(2 * check.redundancy));
}

/// Empty where there is no batch, or no error that could be compared.
std::optional<StageNoise> noiseOf(const Session& session,
                                  const std::vector<CameraCalibration>& cameras,
                                  const CameraImuOptions& options) {
  const auto found = calibrateCameraImu(session, cameras, options);
  if (!found || !found->summary.converged) return std::nullopt;
  const ImuNoiseChecks& checks = found->imu_summary.noise;
  if (!(checks.gyro.redundancy > 0)) return std::nullopt;  // the check found nothing
  const SolvedCameraImu batch = solvedBatch(session, *found, options);
  const ImuReprojection use(cameras);
  const auto expected = [&](const NoiseFactors& noise) {
    const auto covariance = covarianceUnder(batch, noise);
    return covariance ? use.expectedErrorUnder(*covariance, found->imu.T_SC0) : -1;
  };
  // Of the inertial rows alone.
  const double shown =
      expected({0, beyondChance(checks.gyro), beyondChance(checks.accel),
                beyondChance(checks.gyro_bias), beyondChance(checks.accel_bias), 0});
  const double assumed = expected({0, 1, 1, 1, 1, 0});
  if (!(shown > 0) || !(assumed > 0)) return std::nullopt;
  StageNoise out;
  out.imu_variance = shown / assumed;
  // A pose has six rows, about half of them left by what the IMU says.
  const auto judged = std::min(static_cast<int>(found->frames.size()), kMostNoiseFrames);
  const double of_poses = 1 / std::sqrt(6.0 * judged);
  const double ratio = std::sqrt(2) * checks.pose_pixel_sigma / found->summary.reprojection.rmse_px;
  if (std::isfinite(ratio)) out.shared_px = std::max(1.0, beyondChance(ratio, of_poses));
  return out;
}

}  // namespace

void NoiseWatch::look(TimeNs t, const ImuStageRecording& recording) {
  const std::size_t frames = recording.frames().size();
  if (answer_.valid() || frames < next_frames_) return;
  next_frames_ = static_cast<std::size_t>(std::ceil(kFrameGrowth * static_cast<double>(frames)));
  asked_ = t;
  CameraImuOptions options = recording.batchOptions();
  options.diagnose_faults = false;
  const bool beside = threads_ > 1 && latency_s_ > 0;
  answer_ = std::async(beside ? std::launch::async : std::launch::deferred,
                       [session = recording.session(), cameras = cameras_, options] {
                         return noiseOf(session, cameras, options);
                       });
}

std::optional<StageNoise> NoiseWatch::noiseAt(TimeNs t) {
  if (answer_.valid() && t >= asked_ + toNanoseconds(latency_s_)) {
    if (const auto noise = answer_.get()) noise_ = noise;
  }
  return noise_;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "calibrator/base/frames.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/initialise/angular_rates.h"
#include "calibrator/initialise/inertial_alignment.h"
#include "calibrator/initialise/rate_alignment.h"

namespace plumbline {
namespace {

constexpr TimeNs kSynchronised = 50'000;    // [ns] of median shift between cameras' stamps
constexpr double kLongestDifference = 0.3;  // [s] over which positions still give a velocity

double medianInterval(std::span<const CameraPose> poses) {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    intervals.push_back(secondsBetween(poses[i].t, poses[i + 1].t));
  }
  return median(std::move(intervals));
}

/// Mean specific force in F points up while the sensor moves to and fro.
Eigen::Vector3d downFromMeanForce(std::span<const CameraPose> poses,
                                  std::span<const ImuSample> samples, const CameraImuStart& start) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CameraPose& pose : poses) {
    const TimeNs t = pose.t + toNanoseconds(start.time_offsets.front().s);
    const auto next = std::ranges::lower_bound(samples, t, {}, &ImuSample::t);
    if (next == samples.end()) continue;
    // From S to C0 to F.
    sum += pose.T_FC0.R * (start.T_SC0.R.transpose() * next->accel);
  }
  return sum.norm() > 0 ? Eigen::Vector3d(-sum.normalized()) : start.gravity_direction;
}

/// The least residual [m/s^2] that alignInertially() leaves with the accelerometer's columns in
/// another order or with other signs.
double residualOfOtherAxes(std::span<const CameraPose> poses, std::span<const ImuSample> samples,
                           const RateAlignment& rates, double offset_s, const ImuNoise& noise) {
  std::vector<ImuSample> changed(samples.begin(), samples.end());
  double least = std::numeric_limits<double>::infinity();
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      for (std::size_t i = 0; i < changed.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
          const double reading = samples[i].accel(order[static_cast<std::size_t>(k)]);
          changed[i].accel(k) = (signs >> k) % 2 == 0 ? reading : -reading;
        }
      }
      const auto aligned =
          alignInertially(poses, changed, rates.R_SC0, rates.gyro_bias, offset_s, noise);
      if (aligned) least = std::min(least, aligned->residual_rms);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

}  // namespace

std::optional<Failure> wanderingStamps(const std::optional<PartOffsets>& parts) {
  constexpr double kSigmas = 10;
  constexpr double kLeast = 5e-3;  // [s]
  if (!parts || !(parts->most_s - parts->least_s > std::max(kLeast, kSigmas * parts->std_s))) {
    return std::nullopt;
  }
  return Failure{FailureCode::kStampsWander,
                 {{"from_s", parts->least_s}, {"to_s", parts->most_s}, {"std_s", parts->std_s}}};
}

Result<CameraImuStart> startCameraImu(std::span<const CameraPose> poses,
                                      std::span<const ImuSample> samples, const AprilGrid& target,
                                      const CameraImuOptions& options) {
  // Each step stands on those before it: the offset (rates must be paired before they are aligned),
  // the rotation, then gravity and the lever arm, which need both. What contradicts its description
  // is refused at the first step that shows it.
  SanityOptions sanity = options.sanity;
  // One gravity for the checks and the batch.
  sanity.gravity_m_s2 = options.gravity_m_s2;
  if (const auto failure = checkSampleStamps(samples)) return *failure;
  if (const auto failure = checkSampleUnits(samples, sanity)) return *failure;
  // Across one missing frame, not across two.
  const std::vector<CameraRate> rates = cameraRates(poses, 2.5 * medianInterval(poses));
  const GyroIntegral gyro(samples);
  const auto offset = estimateTimeOffset(rates, gyro, options.offset_search);
  if (!offset) return offset.failure();
  const RateAlignment& alignment = offset->alignment;
  if (const auto failure = checkExcitation(alignment, sanity)) return *failure;
  CameraImuStart start;
  start.parts = offsetsOfParts(rates, gyro, offset->offset_s);
  if (const auto failure = checkRates(alignment, sanity)) {
    const auto wandering = failure->code == FailureCode::kRatesDoNotCorrelate
                               ? wanderingStamps(start.parts)
                               : std::nullopt;
    return wandering ? *wandering : *failure;
  }

  start.time_offsets = {{offset->offset_s}};
  start.T_SC0.R = alignment.R_SC0;
  start.bias.gyro = alignment.gyro_bias;
  // It stands where too few triples are left for the alignment below.
  start.gravity_direction = downFromMeanForce(poses, samples, start);
  // Its failure is none of the start: the batch finds the lever arm from zero.
  const auto inertial = alignInertially(poses, samples, alignment.R_SC0, alignment.gyro_bias,
                                        offset->offset_s, options.noise.value_or(ImuNoise()));
  if (!inertial) return start;
  if (auto failure = checkInertial(*inertial, target, sanity)) {
    if (failure->code == FailureCode::kAccelerometerAxes) {
      const double other = residualOfOtherAxes(poses, samples, alignment, offset->offset_s,
                                               options.noise.value_or(ImuNoise()));
      // Noise leaves something; axes are believed that halve what is left.
      if (other < 0.5 * inertial->residual_rms) failure->values.emplace("other_rms", other);
    }
    return *std::move(failure);
  }
  start.check = {inertial->scale, inertial->scale_std, inertial->gravity_F.norm(),
                 residualRatio(*inertial)};
  start.T_SC0.t = inertial->t_SC0;
  start.gravity_direction = inertial->gravity_F.normalized();
  start.bias.accel = inertial->accel_bias;
  return start;
}

void freeOwnOffsets(const Session& session, const std::vector<Frame>& frames,
                    TimeOffsets& offsets) {
  const std::vector<TimeNs> shifts = stampShifts(session.cameras, frames);
  offsets.resize(session.cameras.size(), {offsets.front().s});
  for (std::size_t c = 1; c < shifts.size(); ++c) {
    // Cameras that trigger together share one offset; one of its own would only take up noise.
    offsets[c].estimated = std::llabs(shifts[c]) > kSynchronised;
  }
}

CameraImuStart startFromCalibration(std::span<const CameraPose> poses,
                                    std::span<const ImuSample> samples, const ImuCalibration& imu) {
  CameraImuStart start;
  start.T_SC0 = imu.T_SC0;
  start.time_offsets = imu.time_offsets;
  start.gravity_direction = downFromMeanForce(poses, samples, start);
  return start;
}

std::vector<ImuState> startStates(std::span<const CameraPose> poses, const CameraImuStart& start) {
  const Transform T_C0S = start.T_SC0.inverse();
  std::vector<ImuState> states(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    states[i].T_FS = poses[i].T_FC0 * T_C0S;
    states[i].gyro_bias = start.bias.gyro;
    states[i].accel_bias = start.bias.accel;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    // A central difference over the neighbours; across a pause that to the nearer neighbour alone.
    // A frame by itself keeps velocity 0.
    std::size_t a = i > 0 ? i - 1 : i;
    std::size_t b = std::min(i + 1, poses.size() - 1);
    if (secondsBetween(poses[a].t, poses[b].t) > kLongestDifference) {
      const bool later_is_nearer =
          secondsBetween(poses[i].t, poses[b].t) < secondsBetween(poses[a].t, poses[i].t);
      const bool only_later = a == i;
      (only_later || (later_is_nearer && b != i) ? a : b) = i;
    }
    if (a == b) continue;
    states[i].v_F = (states[b].T_FS.t - states[a].T_FS.t) / secondsBetween(poses[a].t, poses[b].t);
  }
  return states;
}

}  // namespace plumbline

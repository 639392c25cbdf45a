// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/lint/against_session.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/initialise/imu_sanity.h"
#include "calibrator/initialise/inertial_alignment.h"
#include "calibrator/initialise/rate_alignment.h"
#include "evaluate/metrics/failure_text.h"

namespace plumbline::lint {
namespace {

constexpr double kGaussianQuartile = 0.6745;  // median of |x| for unit normal x

/// Pause between neighbouring poses [s] beyond which they give no rate: two and a half median
/// intervals, so that rates are taken across one lost frame, not across two.
double longestGap(const std::vector<CameraPose>& poses) {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    intervals.push_back(secondsBetween(poses[i].t, poses[i + 1].t));
  }
  return intervals.empty() ? 0 : 2.5 * median(std::move(intervals));
}

/// An upper bound for the white noise of one sample, of the gyroscope [rad/s] or the accelerometer
/// [m/s^2]: by second differences, in which constant and linear motion cancel: of white noise s
/// their variance is (1 + 4 + 1) s^2. The median bears spikes. What motion bends within two
/// intervals stays in.
double sampleNoise(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*column) {
  std::vector<double> differences;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Eigen::Vector3d d =
        samples[i + 1].*column - 2 * (samples[i].*column) + samples[i - 1].*column;
    for (const double component : d) differences.push_back(std::abs(component));
  }
  if (differences.empty()) return 0;
  return median(std::move(differences)) / kGaussianQuartile / std::sqrt(6.0);
}

// What the rates and the forces of the recording say of the rig.
struct Alignment {
  TimeOffsetEstimate rates;
  std::optional<InertialAlignment> inertial;
};

/// Rates of camera 0 against the gyroscope; then gravity and lever arm from the accelerometer,
/// where that has a solution.
std::optional<Alignment> alignmentOf(const std::vector<CameraPose>& poses,
                                     std::span<const ImuSample> samples) {
  const GyroIntegral gyro(samples);
  const auto estimate = estimateTimeOffset(cameraRates(poses, longestGap(poses)), gyro);
  if (!estimate) return std::nullopt;
  Alignment alignment{*estimate, {}};
  const RateAlignment& rates = alignment.rates.alignment;
  alignment.inertial =
      alignInertially(poses, samples, rates.R_SC0, rates.gyro_bias, alignment.rates.offset_s);
  return alignment;
}

std::vector<Finding> gyroFault(const std::string& name, const RateAlignment& rates) {
  const auto failure = checkRates(rates);
  if (!failure) return {};
  const bool degrees = failure->code == FailureCode::kGyroscopeInDegrees;
  const FailureText text = textOf(*failure);
  return {bad(degrees ? "Degrees for radians" : "Gyroscope and cameras",
              fmt::format("{} against the recording: {}", name, text.message), text.cure,
              {rates.gyro_to_camera, 1, "x"})};
}

Finding invertedFinding(const LintedCalibration& linted, const std::string& evidence,
                        const Measured& measured) {
  return bad("Inverted transform", linted.name + ": " + evidence,
             fmt::format("invert T_cam_imu (T_SC0) in {}: Kalibr's maps IMU to camera, ours camera "
                         "to IMU",
                         linted.name),
             measured);
}

/// Whether the lever arm agrees with the recording once T_SC0 is inverted, and better than as it
/// stands. Where the recording gives none it says nothing against it.
bool leverArmAllowsInverse(const Transform& T_SC0,
                           const std::optional<InertialAlignment>& inertial) {
  if (!inertial) return true;
  const double direct = (inertial->t_SC0 - T_SC0.t).norm();
  const double inverse = (inertial->t_SC0 - T_SC0.inverse().t).norm();
  return inverse < std::max(kSameTranslation_m, 0.5 * T_SC0.t.norm()) && inverse < direct;
}

// A rotation near the identity or half a turn is its own inverse: the lever arm decides.
bool leverArmIsInverted(const Transform& T_SC0, const InertialAlignment& inertial) {
  const double direct = (inertial.t_SC0 - T_SC0.t).norm();
  const double inverse = (inertial.t_SC0 - T_SC0.inverse().t).norm();
  return direct > kSameTranslation_m && direct > 3 * inverse;
}

/// The rotation first, which rates determine well; the lever arm only where the rotation says
/// nothing about the direction, as it is its own inverse.
std::vector<Finding> transformFault(const LintedCalibration& linted, const Alignment& alignment) {
  const Transform& T_SC0 = linted.calibration.imu->T_SC0;
  const Eigen::Matrix3d& R = alignment.rates.alignment.R_SC0;
  const double direct = rotationAngle(T_SC0.R.transpose() * R);
  // Of R_SC0^T against the recording's R: (R_SC0^T)^T R.
  const double inverse = rotationAngle(T_SC0.R * R);
  const Measured angle{direct, kRotationTolerance_rad, "rad"};
  if (direct > kRotationTolerance_rad) {
    const std::string text = fmt::format(
        "T_SC0 differs by {:.1f} degrees from the rotation that gyroscope and camera rates give, "
        "its inverse by {:.1f}",
        direct / kDegree, inverse / kDegree);
    // A rotation about the right axis by half a turn more is near the inverse, too: the lever arm
    // and what the file says of its other cameras have to agree with an inversion.
    // Places that agree may be inverted all of them: then the recording has to give the lever arm.
    if (inverse < kRotationTolerance_rad &&
        (!linted.imu_places_agree || alignment.inertial.has_value()) &&
        leverArmAllowsInverse(T_SC0, alignment.inertial)) {
      return {invertedFinding(linted, text, angle)};
    }
    return {
        bad("Contradicting rotation", linted.name + ": " + text,
            fmt::format("T_cam_imu (T_SC0) in {} belongs to another rig, or its axes are renamed",
                        linted.name),
            angle)};
  }
  const bool own_inverse = inverse < kRotationTolerance_rad && !linted.imu_places_agree;
  if (own_inverse && alignment.inertial && leverArmIsInverted(T_SC0, *alignment.inertial)) {
    const Eigen::Vector3d seen = 1e3 * alignment.inertial->t_SC0;
    return {invertedFinding(linted,
                            fmt::format("according to the recording camera 0 is at ({:.0f}, "
                                        "{:.0f}, {:.0f}) mm in the IMU, as in the inverse of T_SC0",
                                        seen.x(), seen.y(), seen.z()),
                            angle)};
  }
  return {};
}

/// Correlation gives t_d in the sign of t_imu = t_cam + t_d. An offset that is milliseconds by its
/// size is a finding of the file alone.
std::vector<Finding> offsetFault(const LintedCalibration& linted, double seen) {
  if (!linted.offset_known) return {};
  // Camera 0's, for the rates that were correlated are camera 0's.
  const double given = linted.calibration.imu->timeOffset();
  const double off = std::abs(given - seen);
  if (off <= kOffsetTolerance_s || std::abs(given) > kMaxOffset_s) return {};
  const bool flipped = std::abs(given + seen) <= kOffsetTolerance_s;
  return {bad(
      flipped ? "Flipped time offset" : "Contradicting time offset",
      fmt::format("{}: the time offset is {:.3f} ms; correlating gyroscope and camera rates "
                  "gives {:.3f} ms",
                  linted.name, 1e3 * given, 1e3 * seen),
      flipped ? fmt::format("negate timeshift_cam_imu (time_offset_s) in {}: t_imu = t_cam + t_d",
                            linted.name)
              : fmt::format("the time offset in {} is not this recording's: stamps of another "
                            "driver or session",
                            linted.name),
      {off, kOffsetTolerance_s, "s"})};
}

std::vector<Finding> scatterFault(const LintedCalibration& linted, const ImuStream& imu) {
  if (!linted.noise_known) return {};
  const ImuNoise& noise = linted.calibration.imu->noise;
  // A density n has samples of deviation n sqrt(rate). Their scatter holds motion and vibration
  // besides noise, so it bounds the noise from above; without any scatter it says nothing.
  const double root = 1 / std::sqrt(medianSampleInterval(imu.samples));
  const auto ratio = [&](double density, Eigen::Vector3d ImuSample::*column) {
    const double scatter = sampleNoise(imu.samples, column);
    return scatter > 0 ? density * root / scatter : 0;
  };
  const double gyro = ratio(noise.gyro_density, &ImuSample::gyro);
  const double accel = ratio(noise.accel_density, &ImuSample::accel);
  const double worst = std::max(gyro, accel);
  if (!(worst > kNoiseFactor)) return {};
  return {bad("Noise densities",
              fmt::format("{}: the stated noise is {:.1f} (gyroscope) and {:.1f} (accelerometer) "
                          "times the upper bound from the samples' scatter",
                          linted.name, gyro, accel),
              fmt::format("check the noise densities in {}: discrete-time ones are too large by "
                          "the root of the rate ({:.1f}), those in degrees by 57",
                          linted.name, root),
              {worst, kNoiseFactor, "x"})};
}

std::vector<Finding> imuFaults(const LintedCalibration& linted, const Session& session) {
  std::vector<Finding> found = scatterFault(linted, *session.imu);
  // A translation in other units is a finding of the file alone; what follows would restate it.
  if (linted.calibration.imu->T_SC0.t.norm() > kMaxBaseline_m) return found;
  const Intrinsics& camera = linted.calibration.cameras[0].intrinsics;
  const auto poses = posesOf(session, 0, camera);
  // A camera that does not explain the corners has wrong poses, and it is not T_SC0 or the offset
  // that these contradict. Its error is the verdict's finding.
  if (reprojectionRms(session, 0, camera, poses) > kPosesFit_px) return found;
  const auto alignment = alignmentOf(poses, session.imu->samples);
  if (!alignment) return found;
  const std::vector<Finding> rates = gyroFault(linted.name, alignment->rates.alignment);
  append(found, rates);
  // With rates that contradict each other, or hardly vary, neither rotation nor offset can be
  // judged.
  if (!rates.empty() || checkExcitation(alignment->rates.alignment)) return found;
  append(found, transformFault(linted, *alignment));
  append(found, offsetFault(linted, alignment->rates.offset_s));
  return found;
}

/// From what poses stand on to what stands on poses: exchanged cameras make the rates wrong; each
/// is reported alone.
std::vector<Finding> faultsOf(const LintedCalibration& linted, const Session& session,
                              bool samples_are_sane) {
  const auto& cameras = linted.calibration.cameras;
  if (cameras.empty() || session.cameras.empty()) return {};
  std::vector<Finding> found = orderFault(linted, session);
  const bool imu = linted.calibration.imu && session.imu && samples_are_sane;
  return found.empty() && imu ? imuFaults(linted, session) : found;
}

}  // namespace
}  // namespace plumbline::lint

namespace plumbline {

std::vector<Finding> lintAgainstSession(std::span<const LintedCalibration> calibrations,
                                        const Session& session) {
  std::vector<Finding> found;
  const auto failure =
      session.imu ? checkSampleUnits(session.imu->samples) : std::optional<Failure>();
  if (failure) {
    const FailureText text = textOf(*failure);
    found.push_back(lint::bad("Columns and units of the IMU", session.name + ": " + text.message,
                              text.cure, {}));
  }
  for (const LintedCalibration& linted : calibrations) {
    // Samples in other units contradict every calibration: its IMU is not asked about then.
    append(found, lint::faultsOf(linted, session, !failure));
  }
  return found;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "calibrator/initialise/imu_alignment.h"
#include "calibrator/initialise/imu_sanity.h"
#include "evaluate/compare/lint/rules.h"
#include "evaluate/metrics/failure_text.h"

namespace plumbline {
namespace {

using lint::bad;

// ---- cameras

// The first two cameras' intrinsics on the first two streams, straight or in turn.
struct Assignment {
  std::optional<Transform> T_C0C1;  // of the calibration's cameras, by the corners
  double rms_px = 0;                // of both
};

/// Poses by each camera's own corners and intrinsics, hence the baseline between paired views, and
/// how well the intrinsics fit the corners.
Assignment assign(const std::vector<CameraCalibration>& cameras, const Session& session,
                  bool in_turn) {
  const std::size_t streams[] = {in_turn ? 1U : 0U, in_turn ? 0U : 1U};
  std::vector<CameraPose> poses[2];
  Assignment assignment;
  for (std::size_t i = 0; i < 2; ++i) {
    const Intrinsics& k = cameras[i].intrinsics;
    poses[i] = lint::posesOf(session, streams[i], k);
    assignment.rms_px += lint::reprojectionRms(session, streams[i], k, poses[i]);
  }
  assignment.T_C0C1 = lint::medianBaseline(poses[0], poses[1]);
  return assignment;
}

/// Within the tolerances of equal transforms; of a long baseline within three tenths of it.
bool isNear(const Transform& a, const Transform& b, const LintOptions& options) {
  const lint::Distance d = lint::distanceBetween(a, b);
  return d.rotation_rad < options.same_rotation_rad &&
         d.translation_m < std::max(options.same_translation_m, 0.3 * a.t.norm());
}

std::vector<Finding> orderFault(const LintedCalibration& linted, const Session& session,
                                const LintOptions& options) {
  const auto& cameras = linted.calibration.cameras;
  if (cameras.size() < 2 || session.cameras.size() < 2) return {};
  const Transform& given = cameras[1].T_C0Ci;
  // Exchanged cameras show an inverse baseline as well, so the exchange is asked about before it.
  const Assignment straight = assign(cameras, session, false);
  if (!straight.T_C0C1 || isNear(given, *straight.T_C0C1, options)) return {};
  // Only now, as every assignment solves for the poses of all views of two cameras.
  const Assignment turned = assign(cameras, session, true);
  const bool swapped =
      turned.T_C0C1 && isNear(given, *turned.T_C0C1, options) && turned.rms_px < straight.rms_px;
  if (!swapped && !lint::isInverse(given, *straight.T_C0C1, options)) return {};
  const Eigen::Vector3d stated = 1e3 * given.t;
  const Eigen::Vector3d seen = 1e3 * straight.T_C0C1->t;
  return {
      bad(swapped ? "Order of cameras" : "Inverted baseline",
          fmt::format("{}: camera 1 is at ({:.1f}, {:.1f}, {:.1f}) mm in camera 0; the corners say "
                      "({:.1f}, {:.1f}, {:.1f}) mm{}",
                      linted.name, stated.x(), stated.y(), stated.z(), seen.x(), seen.y(), seen.z(),
                      swapped ? ", and fit the intrinsics better when exchanged" : ""),
          swapped ? fmt::format("exchange cam0 and cam1 in {}", linted.name)
                  : fmt::format("invert T_cn_cnm1 of cam1 in {}", linted.name),
          {stated.norm(), 1e3 * options.same_translation_m, "mm"})};
}

// ---- IMU

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
  const auto estimate = estimateTimeOffset(cameraRates(poses, lint::longestGap(poses)), gyro);
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
                        const lint::Measured& measured) {
  return bad("Inverted transform", linted.name + ": " + evidence,
             fmt::format("invert T_cam_imu (T_SC0) in {}: Kalibr's maps IMU to camera, ours camera "
                         "to IMU",
                         linted.name),
             measured);
}

/// Whether the lever arm agrees with the recording once T_SC0 is inverted, and better than as it
/// stands. Where the recording gives none it says nothing against it.
bool leverArmAllowsInverse(const Transform& T_SC0, const std::optional<InertialAlignment>& inertial,
                           const LintOptions& options) {
  if (!inertial) return true;
  const double direct = (inertial->t_SC0 - T_SC0.t).norm();
  const double inverse = (inertial->t_SC0 - T_SC0.inverse().t).norm();
  return inverse < std::max(options.same_translation_m, 0.5 * T_SC0.t.norm()) && inverse < direct;
}

// A rotation near the identity or half a turn is its own inverse: the lever arm decides.
bool leverArmIsInverted(const Transform& T_SC0, const InertialAlignment& inertial,
                        const LintOptions& options) {
  const double direct = (inertial.t_SC0 - T_SC0.t).norm();
  const double inverse = (inertial.t_SC0 - T_SC0.inverse().t).norm();
  return direct > options.same_translation_m && direct > 3 * inverse;
}

/// The rotation first, which rates determine well; the lever arm only where the rotation says
/// nothing about the direction, as it is its own inverse.
std::vector<Finding> transformFault(const LintedCalibration& linted, const Alignment& alignment,
                                    const LintOptions& options) {
  const Transform& T_SC0 = linted.calibration.imu->T_SC0;
  const Eigen::Matrix3d& R = alignment.rates.alignment.R_SC0;
  const double direct = rotationAngle(T_SC0.R.transpose() * R);
  // Of R_SC0^T against the recording's R: (R_SC0^T)^T R.
  const double inverse = rotationAngle(T_SC0.R * R);
  const lint::Measured angle{direct, options.rotation_tolerance_rad, "rad"};
  if (direct > options.rotation_tolerance_rad) {
    const std::string text = fmt::format(
        "T_SC0 differs by {:.1f} degrees from the rotation that gyroscope and camera rates give, "
        "its inverse by {:.1f}",
        direct / kDegree, inverse / kDegree);
    // A rotation about the right axis by half a turn more is near the inverse, too: the lever arm
    // and what the file says of its other cameras have to agree with an inversion.
    if (inverse < options.rotation_tolerance_rad && !linted.imu_places_agree &&
        leverArmAllowsInverse(T_SC0, alignment.inertial, options)) {
      return {invertedFinding(linted, text, angle)};
    }
    return {
        bad("Contradicting rotation", linted.name + ": " + text,
            fmt::format("T_cam_imu (T_SC0) in {} belongs to another rig, or its axes are renamed",
                        linted.name),
            angle)};
  }
  const bool own_inverse = inverse < options.rotation_tolerance_rad && !linted.imu_places_agree;
  if (own_inverse && alignment.inertial &&
      leverArmIsInverted(T_SC0, *alignment.inertial, options)) {
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
std::vector<Finding> offsetFault(const LintedCalibration& linted, double seen,
                                 const LintOptions& options) {
  if (!linted.offset_known) return {};
  // Camera 0's, for the rates that were correlated are camera 0's.
  const double given = linted.calibration.imu->timeOffset();
  const double off = std::abs(given - seen);
  if (off <= options.offset_tolerance_s || std::abs(given) > options.max_offset_s) return {};
  const bool flipped = std::abs(given + seen) <= options.offset_tolerance_s;
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
      {off, options.offset_tolerance_s, "s"})};
}

std::vector<Finding> noiseFault(const LintedCalibration& linted, const ImuStream& imu,
                                const LintOptions& options) {
  if (!linted.noise_known) return {};
  const ImuNoise& noise = linted.calibration.imu->noise;
  // A density n has samples of deviation n sqrt(rate). Their scatter holds motion and vibration
  // besides noise, so it bounds the noise from above; without any scatter it says nothing.
  const double root = 1 / std::sqrt(medianSampleInterval(imu.samples));
  const auto ratio = [&](double density, Eigen::Vector3d ImuSample::*column) {
    const double scatter = lint::sampleNoise(imu.samples, column);
    return scatter > 0 ? density * root / scatter : 0;
  };
  const double gyro = ratio(noise.gyro_density, &ImuSample::gyro);
  const double accel = ratio(noise.accel_density, &ImuSample::accel);
  const double worst = std::max(gyro, accel);
  if (!(worst > options.noise_factor)) return {};
  return {bad("Noise densities",
              fmt::format("{}: the stated noise is {:.1f} (gyroscope) and {:.1f} (accelerometer) "
                          "times the upper bound from the samples' scatter",
                          linted.name, gyro, accel),
              fmt::format("check the noise densities in {}: discrete-time ones are too large by "
                          "the root of the rate ({:.1f}), those in degrees by 57",
                          linted.name, root),
              {worst, options.noise_factor, "x"})};
}

/// A translation in other units is a finding of the file alone; what follows would restate it.
bool hasOddTranslation(const LintedCalibration& linted, const LintOptions& options) {
  return linted.calibration.imu->T_SC0.t.norm() > options.max_baseline_m;
}

std::vector<Finding> imuFaults(const LintedCalibration& linted, const ImuStream& imu,
                               const std::vector<CameraPose>& poses, const LintOptions& options) {
  std::vector<Finding> found = noiseFault(linted, imu, options);
  const auto alignment = alignmentOf(poses, imu.samples);
  if (!alignment || hasOddTranslation(linted, options)) return found;
  const std::vector<Finding> rates = gyroFault(linted.name, alignment->rates.alignment);
  append(found, rates);
  // With rates that contradict each other, or hardly vary, neither rotation nor offset can be
  // judged.
  if (!rates.empty() || checkExcitation(alignment->rates.alignment)) return found;
  append(found, transformFault(linted, *alignment, options));
  append(found, offsetFault(linted, alignment->rates.offset_s, options));
  return found;
}

/// From what poses stand on to what stands on poses: exchanged cameras make the rates wrong; each
/// is reported alone.
std::vector<Finding> faultsOf(const LintedCalibration& linted, const Session& session,
                              bool samples_are_sane, const LintOptions& options) {
  const auto& cameras = linted.calibration.cameras;
  if (cameras.empty() || session.cameras.empty()) return {};
  const auto poses = lint::posesOf(session, 0, cameras[0].intrinsics);
  std::vector<Finding> found = orderFault(linted, session, options);
  const bool imu = linted.calibration.imu && session.imu && samples_are_sane;
  if (found.empty() && imu) found = imuFaults(linted, *session.imu, poses, options);
  return found;
}

}  // namespace

std::vector<Finding> lintAgainstSession(std::span<const LintedCalibration> calibrations,
                                        const Session& session, const LintOptions& options) {
  std::vector<Finding> found;
  const auto failure =
      session.imu ? checkSampleUnits(session.imu->samples) : std::optional<Failure>();
  if (failure) {
    const FailureText text = textOf(*failure);
    found.push_back(
        bad("Columns and units of the IMU", session.name + ": " + text.message, text.cure, {}));
  }
  for (const LintedCalibration& linted : calibrations) {
    // Samples in other units contradict every calibration: its IMU is not asked about then.
    append(found, faultsOf(linted, session, !failure, options));
  }
  return found;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/imu_sanity.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics.h"

namespace plumbline {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

bool isNear(double value, double target, double relative) {
  return std::abs(value - target) <= relative * target;
}

/// The two coordinate axes other than the one nearest to `axis`, as words.
std::string otherAxes(const Eigen::Vector3d& axis) {
  int k = 0;
  axis.cwiseAbs().maxCoeff(&k);
  const char* names[] = {"y or z", "x or z", "x or y"};
  return std::abs(axis(k)) > 0.9 ? names[k] : "an axis across it";
}

double medianNorm(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*column) {
  std::vector<double> norms;
  norms.reserve(samples.size());
  for (const ImuSample& s : samples) norms.push_back((s.*column).norm());
  return quantile(std::move(norms), 0.5);
}

}  // namespace

std::string axisName(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d u = axis.normalized();
  const char* names[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    if (std::abs(u(k)) > 0.9) return names[k];
  }
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", u.x(), u.y(), u.z());
}

std::optional<Failure> checkSampleUnits(std::span<const ImuSample> samples,
                                        const SanityOptions& options) {
  if (samples.size() < 2) {
    return Failure{FailureReason::kNoOverlap, "the IMU has fewer than two samples",
                   "record the IMU together with the cameras", FaultyInput::kImuSamples};
  }
  const double g = options.gravity_m_s2;
  const double gyro = medianNorm(samples, &ImuSample::gyro);
  const double accel = medianNorm(samples, &ImuSample::accel);
  const auto fail = [&](const std::string& what, const std::string& cure) {
    return Failure{FailureReason::kImplausible,
                   fmt::format("the accelerometer's median norm is {:.4g} (expected about {:.2f} "
                               "m/s^2), the gyroscope's {:.4g}: {}",
                               accel, g, gyro, what),
                   cure, FaultyInput::kImuSamples};
  };
  if (isNear(gyro, g, 0.3) && !isNear(accel, g, 0.5)) {
    return fail("gyroscope and accelerometer columns are swapped",
                "put the angular rate first and the acceleration second");
  }
  if (isNear(accel, 1, 0.3)) {
    return fail("the accelerometer is in g", "multiply its columns by 9.80665");
  }
  if (isNear(accel, 1000, 0.3)) {
    return fail("the accelerometer is in milli-g", "multiply its columns by 0.00980665");
  }
  if (!isNear(accel, g, 0.4)) {
    return fail("the accelerometer does not measure gravity in m/s^2",
                "check its units and that gravity has not been subtracted");
  }
  return std::nullopt;
}

std::optional<Failure> checkExcitation(const RateAlignment& alignment,
                                       const SanityOptions& options) {
  const Eigen::Vector3d& rms = alignment.excitation;
  if (rms(0) < options.min_excitation_rad_s) {
    return Failure{
        FailureReason::kNotObservable,
        fmt::format("T_SC0 and the time offset are not observable: the sensor's rotation rate "
                    "hardly varies about any axis (RMS {:.2g} rad/s)",
                    rms(0)),
        "turn the sensor to and fro about all its axes while the target stays in view"};
  }
  if (rms(1) < options.min_excitation_rad_s) {
    const Eigen::Vector3d axis = alignment.excitation_axes.col(0);
    return Failure{
        FailureReason::kNotObservable,
        fmt::format("translation along {} of T_SC0 is not observable: no rotation about {} (RMS "
                    "{:.2g} rad/s across {})",
                    axisName(axis), otherAxes(axis), rms(1), axisName(axis)),
        "turn the sensor about at least two axes of the IMU"};
  }
  return std::nullopt;
}

std::optional<Failure> checkRates(const RateAlignment& alignment, const SanityOptions& options) {
  const auto implausible = [](std::string message, std::string cure) {
    return Failure{FailureReason::kImplausible, std::move(message), std::move(cure),
                   FaultyInput::kImuSamples};
  };
  if (std::max(alignment.correlation, alignment.mirrored_correlation) < options.min_correlation) {
    return Failure{FailureReason::kNoOverlap,
                   fmt::format("gyroscope and camera rotation do not correlate under any time "
                               "offset in range (best {:.2f}, expected above {:.2f})",
                               alignment.correlation, options.min_correlation),
                   "check that both are of the same recording, that their stamps are of one clock "
                   "(a larger offset can be given by --imu-shift-ms) and that each gyroscope "
                   "column is what it should be",
                   FaultyInput::kImuSamples};
  }
  if (alignment.mirrored_correlation > options.min_correlation &&
      1 - alignment.mirrored_correlation < 0.5 * (1 - alignment.correlation)) {
    return implausible(
        fmt::format("the gyroscope's axes are permuted or mirrored: its rates fit the camera's "
                    "only after a reflection (correlation {:.3f} against {:.3f} for a rotation)",
                    alignment.mirrored_correlation, alignment.correlation),
        "make its axes right-handed: restore their order or the sign of one column");
  }
  if (isNear(alignment.gyro_to_camera, kDegreesPerRadian, 0.3)) {
    return implausible(fmt::format("the gyroscope turns {:.1f} times as fast as the camera: it is "
                                   "in degrees per second",
                                   alignment.gyro_to_camera),
                       "multiply its columns by pi / 180");
  }
  // Noise of the camera's rates makes the gyroscope seem slower: by the correlation at most.
  const double noise = 1 - alignment.correlation * alignment.correlation;
  if (!isNear(alignment.gyro_to_camera, 1, options.rate_tolerance + noise)) {
    return implausible(fmt::format("the gyroscope turns {:.3g} times as fast as the camera",
                                   alignment.gyro_to_camera),
                       "check the gyroscope's units (rad/s), its scale and the stamps' unit (ns); "
                       "or the cameras' focal lengths, where they were given");
  }
  return std::nullopt;
}

std::optional<Failure> checkInertial(const InertialAlignment& alignment, const AprilGrid& target,
                                     const SanityOptions& options) {
  const double g = alignment.gravity_F.norm();
  const auto implausible = [](std::string message, std::string cure) {
    return Failure{FailureReason::kImplausible, std::move(message), std::move(cure),
                   FaultyInput::kImuSamples};
  };
  if (alignment.residual_rms > options.max_residual_m_s2) {
    return implausible(fmt::format("the accelerometer contradicts the camera's motion by {:.2g} "
                                   "m/s^2 (RMS): its axes do not fit the gyroscope's",
                                   alignment.residual_rms),
                       "check order and signs of the accelerometer's columns");
  }
  if (alignment.scale < 0) {
    return implausible("the accelerometer measures the camera's motion with reversed sign",
                       "negate its three columns: at rest it must read +9.8 m/s^2 upwards; or, "
                       "where the images are mirrored, mirror them back");
  }
  const bool significant =
      std::abs(g - options.gravity_m_s2) > options.significance * alignment.gravity_std;
  if (significant && !isNear(g, options.gravity_m_s2, options.gravity_tolerance)) {
    return implausible(fmt::format("gravity comes out as {:.2f} m/s^2 in place of {:.2f}", g,
                                   options.gravity_m_s2),
                       "check units, scale, order and signs of the accelerometer's columns");
  }
  const double off = std::abs(alignment.scale - 1);
  if (off > options.scale_tolerance && off > options.significance * alignment.scale_std) {
    const bool large = alignment.scale < 1;
    return Failure{
        FailureReason::kImplausible,
        fmt::format("the target's tagSize ({:.4g} m) seems to be {:.3g} times too {}: the IMU says "
                    "about {:.4g} m (+- {:.1g})",
                    target.tag_size, large ? 1 / alignment.scale : alignment.scale,
                    large ? "large" : "small", alignment.scale * target.tag_size,
                    alignment.scale_std * target.tag_size),
        "measure a tag's black square and the gap between tags, and correct tagSize or tagSpacing",
        FaultyInput::kTarget};
  }
  return std::nullopt;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/imu_sanity.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

bool isNear(double value, double target, double relative) {
  return std::abs(value - target) <= relative * target;
}

/// The median, which knocks and motion at its fastest do not move.
double medianNorm(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*column) {
  std::vector<double> norms;
  norms.reserve(samples.size());
  for (const ImuSample& s : samples) norms.push_back((s.*column).norm());
  return median(std::move(norms));
}

}  // namespace

void SanityOptions::check() const {
  requireOption(gravity_m_s2 > 0, "gravity_m_s2", gravity_m_s2, "a positive acceleration");
  requireWithin(0, 1, "min_correlation", min_correlation);
  requireOption(min_excitation_rad_s >= 0, "min_excitation_rad_s", min_excitation_rad_s,
                "0 or more");
  requireOption(rate_tolerance > 0, "rate_tolerance", rate_tolerance, "a positive ratio");
  requireOption(scale_tolerance > 0, "scale_tolerance", scale_tolerance, "a positive ratio");
  requireOption(significance > 0, "significance", significance, "a positive factor");
  requireOption(gravity_tolerance > 0, "gravity_tolerance", gravity_tolerance, "a positive ratio");
  requireOption(noise_floor > 0, "noise_floor", noise_floor, "a positive factor");
  requireOption(max_residual_m_s2 > 0, "max_residual_m_s2", max_residual_m_s2,
                "a positive acceleration");
}

std::optional<Failure> checkSampleStamps(std::span<const ImuSample> samples) {
  constexpr double kShort = 0.2;
  constexpr double kShareInBursts = 0.3;
  if (samples.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(samples.size() - 1);
  // Not the median, which in bursts is an interval within one.
  const double mean = secondsBetween(samples.front().t, samples.back().t) / count;
  std::vector<double> within, between;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const double interval = secondsBetween(samples[k].t, samples[k + 1].t);
    (interval < kShort * mean ? within : between).push_back(interval);
  }
  if (between.empty() || static_cast<double>(within.size()) < kShareInBursts * count) {
    return std::nullopt;
  }
  // Intervals for each pause: as many as samples of a burst.
  const double size = count / static_cast<double>(between.size());
  return Failure{FailureCode::kSamplesInBursts,
                 {{"count", std::lround(size)},
                  {"apart_s", median(std::move(within))},
                  {"pause_s", median(std::move(between))}}};
}

std::optional<Failure> checkSampleUnits(std::span<const ImuSample> samples,
                                        const SanityOptions& options) {
  options.check();
  if (samples.size() < 2) return Failure{FailureCode::kTooFewSamples};
  const double g = options.gravity_m_s2;
  const double gyro = medianNorm(samples, &ImuSample::gyro);
  const double accel = medianNorm(samples, &ImuSample::accel);
  const auto fail = [&](FailureCode code) {
    return Failure{code, {{"accel", accel}, {"gyro", gyro}, {"gravity", g}}};
  };
  // A sensor that is moved to and fro has a median specific force near g; a rate of 10 rad/s in the
  // median is no calibration's. The intervals are wide, for units are wrong by factors.
  if (isNear(gyro, g, 0.3) && !isNear(accel, g, 0.5)) return fail(FailureCode::kColumnsSwapped);
  if (isNear(accel, 1, 0.3)) return fail(FailureCode::kAccelerometerInG);
  if (isNear(accel, 1000, 0.3)) return fail(FailureCode::kAccelerometerInMilliG);
  if (!isNear(accel, g, 0.4)) return fail(FailureCode::kAccelerometerUnits);
  return std::nullopt;
}

std::optional<Failure> checkExcitation(const RateAlignment& alignment,
                                       const SanityOptions& options) {
  const Eigen::Vector3d& rms = alignment.excitation;
  if (rms(0) < options.min_excitation_rad_s) {
    return Failure{FailureCode::kNoRotation, {{"rms", rms(0)}}};
  }
  // Two axes fix a rotation, so that the least of the three may be zero. The axis told is the one
  // that is turned about.
  if (rms(1) < options.min_excitation_rad_s) {
    const Eigen::Vector3d axis = alignment.excitation_axes.col(0);
    return Failure{FailureCode::kRotationAboutOneAxis, {{"axis", axis}, {"rms", rms(1)}}};
  }
  return std::nullopt;
}

std::optional<Failure> checkRates(const RateAlignment& alignment, const SanityOptions& options) {
  // Axes of the wrong hand correlate as a reflection alone: that is the finding below, not this
  // one.
  if (std::max(alignment.correlation, alignment.mirrored_correlation) < options.min_correlation) {
    return Failure{FailureCode::kRatesDoNotCorrelate,
                   {{"correlation", alignment.correlation}, {"needed", options.min_correlation}}};
  }
  // Under noise both fits leave something; a reflection is believed that halves what is left.
  if (alignment.mirrored_correlation > options.min_correlation &&
      1 - alignment.mirrored_correlation < 0.5 * (1 - alignment.correlation)) {
    return Failure{
        FailureCode::kGyroscopeMirrored,
        {{"mirrored", alignment.mirrored_correlation}, {"rotated", alignment.correlation}}};
  }
  const double ratio = alignment.gyro_to_camera;
  if (isNear(ratio, kDegrees, 0.3)) {
    return Failure{FailureCode::kGyroscopeInDegrees, {{"ratio", ratio}}};
  }
  // Noise of the camera's rates makes the gyroscope seem slower: by the correlation at most.
  const double noise = 1 - alignment.correlation * alignment.correlation;
  if (!isNear(ratio, 1, options.rate_tolerance + noise)) {
    return Failure{FailureCode::kGyroscopeScale, {{"ratio", ratio}}};
  }
  return std::nullopt;
}

double residualRatio(const InertialAlignment& alignment) {
  if (!(alignment.noise_rms > 0)) return 0;
  // Both in the camera's units: a larger target has larger noise.
  return alignment.residual_rms / (std::abs(alignment.scale) * alignment.noise_rms);
}

std::optional<Failure> checkInertial(const InertialAlignment& alignment, const AprilGrid& target,
                                     const SanityOptions& options) {
  const double g = alignment.gravity_F.norm();
  // First, for axes that do not fit spoil gravity and scale as well. NaN is no residual that fits.
  if (!(alignment.residual_rms <= options.max_residual_m_s2)) {
    return Failure{FailureCode::kAccelerometerAxes, {{"rms", alignment.residual_rms}}};
  }
  if (alignment.scale < 0) return Failure{FailureCode::kAccelerometerReversed};
  const bool significant =
      std::abs(g - options.gravity_m_s2) > options.significance * alignment.gravity_std;
  if (significant && !isNear(g, options.gravity_m_s2, options.gravity_tolerance)) {
    return Failure{FailureCode::kGravityDisagrees,
                   {{"measured", g}, {"expected", options.gravity_m_s2}}};
  }
  const double off = std::abs(alignment.scale - 1);
  // Where another size explains nearly all that is left, noise need not be known.
  constexpr double kNearlyAll = 5;
  constexpr double kWorse = 1.3;  // what the stated size leaves over what is noise with the other
  const double free_rms = alignment.residual_rms / std::abs(alignment.scale);
  const bool to_noise =
      residualRatio(alignment) < options.noise_floor && alignment.fixed_rms > kWorse * free_rms;
  const bool explains =
      alignment.noise_rms == 0 || to_noise || alignment.fixed_rms > kNearlyAll * free_rms;
  if (explains && off > options.scale_tolerance &&
      off > options.significance * alignment.scale_std) {
    return Failure{FailureCode::kScaleDisagrees,
                   {{"scale", alignment.scale},
                    {"scale_std", alignment.scale_std},
                    {"tag_size", target.tag_size}}};
  }
  return std::nullopt;
}

}  // namespace plumbline

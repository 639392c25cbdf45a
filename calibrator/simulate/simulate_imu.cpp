// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "calibrator/simulate/faults/imu_faults.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

/// Indices of the samples: sample j is stamped start + j / rate; j runs from -before to after
/// (`before` is negative where the samples begin after the first exposure).
struct SampleRange {
  std::int64_t before = 0;
  std::int64_t after = 0;
  std::size_t count() const { return static_cast<std::size_t>(before + after + 1); }
};

/// One triad of sensors: how noisy it is and where its random numbers come from.
struct TriadNoise {
  RandomPurpose white_purpose, walk_purpose;
  double white_sigma, walk_sigma;  ///< of a sample, of a step between samples
  Eigen::Vector3d initial_bias;
};

struct TriadSequence {
  std::vector<Eigen::Vector3d> white, bias;
};

/// Noise of all samples. Numbers are drawn outwards from sample 0, forwards and backwards from a
/// stream each, so that a longer recording or margin keeps the noise of what it had.
TriadSequence triadSequence(const TriadNoise& noise, std::uint64_t seed, const SampleRange& range) {
  TriadSequence s;
  s.white.resize(range.count());
  s.bias.resize(range.count());
  for (const int direction : {1, -1}) {
    const std::uint64_t stream = direction > 0 ? 0 : 1;
    RandomStream white(seed, noise.white_purpose, {stream});
    RandomStream walk(seed, noise.walk_purpose, {stream});
    Eigen::Vector3d bias = noise.initial_bias;
    const std::int64_t last = direction > 0 ? range.after : range.before;
    for (std::int64_t j = 0; j <= last; ++j) {
      if (j > 0) bias += noise.walk_sigma * walk.normalVector();
      const Eigen::Vector3d n = noise.white_sigma * white.normalVector();
      const std::int64_t position = range.before + direction * j;
      if (position < 0 || (j == 0 && direction < 0)) continue;  // 0 belongs to the forward pass
      s.white[position] = n;
      s.bias[position] = bias;
    }
  }
  return s;
}

/// Covers all exposures, first to last, by the margin on both sides: the camera's stamps, moved by
/// the time offset to the IMU's clock.
SampleRange sampleRange(const ImuCalibration& imu, const SimulationOptions& o) {
  const double rate = imu.noise.rate_hz;
  // t_imu = t_cam + t_d: a negative offset asks for earlier samples, a positive one for later ones.
  const double before = o.imu_margin_s + std::max(0.0, -imu.timeOffset());
  const double after = o.duration_s + o.imu_margin_s + std::max(0.0, imu.timeOffset());
  return {static_cast<std::int64_t>(std::ceil(before * rate)),
          static_cast<std::int64_t>(std::ceil(after * rate))};
}

}  // namespace

SimulatedImu simulateImu(const AnalyticTrajectory& trajectory, const ImuCalibration& imu,
                         const Eigen::Vector3d& gravity_F, const SimulationOptions& o) {
  const SampleRange range = sampleRange(imu, o);
  // Densities are of continuous time: white noise of a sample grows with the root of the rate, a
  // step of the walk shrinks with it.
  const double noise = o.imu_noise ? std::sqrt(imu.noise.rate_hz) : 0;  // density to a sample
  const double step = o.imu_noise ? 1 / std::sqrt(imu.noise.rate_hz) : 0;
  const TriadSequence gyro = triadSequence(
      {RandomPurpose::kGyroNoise, RandomPurpose::kGyroWalk, imu.noise.gyro_density * noise,
       imu.noise.gyro_random_walk * step, o.initial_gyro_bias},
      o.seed, range);
  const TriadSequence accel = triadSequence(
      {RandomPurpose::kAccelNoise, RandomPurpose::kAccelWalk, imu.noise.accel_density * noise,
       imu.noise.accel_random_walk * step, o.initial_accel_bias},
      o.seed, range);

  // The exact motion is read faultily, then noise and bias come on top, then what becomes of
  // samples.
  const ImuFaults faults(o.faults);
  SimulatedImu out;
  out.samples.resize(range.count());
  out.biases.resize(range.count());
  for (std::size_t i = 0; i < range.count(); ++i) {
    const double nominal_s =
        static_cast<double>(static_cast<std::int64_t>(i) - range.before) / imu.noise.rate_hz;
    ImuSample& sample = out.samples[i];
    sample.t = o.start_ns + toNanoseconds(nominal_s);
    const ImuReading exact =
        faults.read(trajectory, gravity_F, secondsBetween(o.start_ns, sample.t));
    sample.gyro = exact.gyro + gyro.bias[i] + gyro.white[i];
    sample.accel = exact.accel + accel.bias[i] + accel.white[i];
    out.biases[i] = {gyro.bias[i], accel.bias[i]};
  }
  out.fault_stamps = disturbSamples(out, o.faults, {o.start_ns, imu.noise.rate_hz, o.seed});
  return out;
}

}  // namespace plumbline

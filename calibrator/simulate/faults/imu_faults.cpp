// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/faults/imu_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using enum FaultKind;

/// What the fault does to readings of its triad.
Matrix3d readingMatrix(const Fault& fault) {
  Matrix3d M = Matrix3d::Identity();
  switch (fault.kind) {
    case kAccelScale:
    case kGyroScale:
      for (int i = 0; i < 3; ++i) {
        if (fault.axis.value_or(i) == i) M(i, i) = fault.value;
      }
      return M;
    case kAccelMisalignment:
    case kGyroMisalignment:
      // Exp(v n)^T: a triad that is turned by v n reads the same vector in axes of its own.
      return expSO3(-fault.value * direction(fault));
    case kAxes: {
      const double c = std::cos(fault.value);
      const double s = std::sin(fault.value);
      // Rows are the unit vectors along which the three sensors read.
      M << c, s, 0, 0, c, s, 0, 0, 1;
      return M;
    }
    default:
      return M;
  }
}

/// Number of a sample, the same however long the recording is.
std::int64_t sampleNumber(const ImuSample& sample, const ImuTiming& timing) {
  return std::llround(secondsBetween(timing.start_ns, sample.t) * timing.rate_hz);
}

TimeNs instantOf(const Fault& fault, const ImuTiming& timing) {
  return timing.start_ns + toNanoseconds(fault.at_s);
}

void jumpBiases(ImuRecording& r, const Fault& fault, const ImuTiming& timing) {
  const Vector3d jump = fault.value * direction(fault);
  const bool of_gyro = fault.kind == kBiasJump;
  for (std::size_t i = 0; i < r.samples.size(); ++i) {
    if (r.samples[i].t < instantOf(fault, timing)) continue;
    (of_gyro ? r.samples[i].gyro : r.samples[i].accel) += jump;
    // The jump is part of the truth: it is in the samples for good.
    (of_gyro ? r.biases[i].gyro : r.biases[i].accel) += jump;
  }
}

void clip(std::vector<ImuSample>& samples, const Fault& fault) {
  for (ImuSample& sample : samples) {
    Vector3d& v = fault.kind == kGyroClip ? sample.gyro : sample.accel;
    v = v.cwiseMax(-fault.value).cwiseMin(fault.value);
  }
}

/// Returns the numbers of the samples that were struck.
std::vector<std::int64_t> spike(std::vector<ImuSample>& samples, const NumberedFault& fault,
                                const ImuTiming& timing) {
  std::vector<std::int64_t> struck;
  for (ImuSample& sample : samples) {
    const std::int64_t number = sampleNumber(sample, timing);
    // A stream for each sample: a spike stays where it is in a longer recording, or at another
    // margin.
    RandomStream random = fault.random(timing.seed, 0, static_cast<std::uint64_t>(number));
    if (random.uniform() >= fault->value / timing.rate_hz) continue;
    const double sign = random.uniform() < 0.5 ? -1 : 1;
    const int axis = fault->axis.value_or(static_cast<int>(3 * random.uniform()));
    (fault->kind == kSpike ? sample.gyro : sample.accel)[axis] += sign * fault->extent;
    struck.push_back(number);
  }
  return struck;
}

/// The stamp that the IMU's clock and driver give to a sample that was taken at `t`.
TimeNs stampOf(TimeNs t, std::int64_t number, const std::vector<Fault>& faults,
               const ImuTiming& timing) {
  TimeNs stamp = t;
  for (const NumberedFault& burst : faultsOf(faults, {kBurst})) {
    const auto size = static_cast<std::int64_t>(burst->value);
    // Numbers before the first frame are negative, and so are their remainders.
    const std::int64_t before_last = size - 1 - ((number % size) + size) % size;
    // 20 us: a sample of 14 bytes over SPI at some 6 MHz.
    const TimeNs period = toNanoseconds(1 / timing.rate_hz);
    stamp += before_last * (period - std::min<TimeNs>(period, 20'000));
  }
  const TimeNs read = stamp;  // true time at which the clock was read
  for (const NumberedFault& step : faultsOf(faults, {kClockStep})) {
    if (read >= instantOf(*step.fault, timing)) stamp += toNanoseconds(step->value);
  }
  for (const NumberedFault& drift : faultsOf(faults, {kClockDrift})) {
    stamp += toNanoseconds(drift->value * secondsBetween(timing.start_ns, read));
  }
  return stamp;
}

/// Drops lost samples; `keep` tells by position, `r` keeps its pairs.
template <class Keep>
void select(ImuRecording& r, const Keep& keep) {
  ImuRecording kept;
  for (std::size_t i = 0; i < r.samples.size(); ++i) {
    if (!keep(r.samples[i])) continue;
    kept.samples.push_back(r.samples[i]);
    kept.biases.push_back(r.biases[i]);
  }
  r = std::move(kept);
}

}  // namespace

ImuFaults::ImuFaults(const std::vector<Fault>& faults)
    : vibrations_(faultsOf(faults, {kVibration})), slips_(faultsOf(faults, {kSlip})) {
  for (const Fault& fault : faults) {
    // In the order given: each acts on what those before it have made of the reading.
    const Matrix3d M = readingMatrix(fault);
    if (fault.kind == kGyroScale || fault.kind == kGyroMisalignment || fault.kind == kAxes) {
      M_gyro_ = M * M_gyro_;
    }
    if (fault.kind == kAccelScale || fault.kind == kAccelMisalignment || fault.kind == kAxes) {
      M_accel_ = M * M_accel_;
    }
    if (fault.kind == kGyroDelay) gyro_delay_s_ += fault.value;
    if (fault.kind == kAccelDelay) accel_delay_s_ += fault.value;
    if (fault.kind == kGSensitivity) g_sensitivity_ += fault.value;
  }
}

MotionState ImuFaults::motion(const AnalyticTrajectory& trajectory, double t_s) const {
  const MotionState m = trajectory.at(t_s);
  if (slips_.empty()) return m;
  Transform T_SSlipped;
  for (const NumberedFault& slip : slips_) {
    if (t_s >= slip->at_s) T_SSlipped.R *= expSO3(slip->value * direction(*slip.fault));
  }
  return attached(m, T_SSlipped);
}

ImuReading ImuFaults::read(const AnalyticTrajectory& trajectory, const Vector3d& gravity_F,
                           double t_s) const {
  const auto force = [&gravity_F](const MotionState& m) -> Vector3d {
    return m.T_FB.R.transpose() * (m.a_F - gravity_F);
  };
  const double t_accel = t_s - accel_delay_s_;
  const MotionState m_gyro = motion(trajectory, t_s - gyro_delay_s_);
  const MotionState m_accel =
      accel_delay_s_ == gyro_delay_s_ ? m_gyro : motion(trajectory, t_accel);
  Vector3d shaken = force(m_accel);
  for (const NumberedFault& v : vibrations_) {
    // Within M_a and its delay: what shakes is the sensor's input.
    const double sine = std::sin(2 * std::numbers::pi * v->extent * t_accel);
    shaken += direction(*v.fault) * (v->value * sine);
  }
  ImuReading reading{M_gyro_ * m_gyro.omega_B, M_accel_ * shaken};
  if (g_sensitivity_ != 0) reading.gyro += g_sensitivity_ * force(m_gyro);
  return reading;
}

std::vector<std::vector<TimeNs>> disturbSamples(ImuRecording& recording,
                                                const std::vector<Fault>& faults,
                                                const ImuTiming& timing) {
  std::vector<ImuSample>& samples = recording.samples;
  for (const NumberedFault& f : faultsOf(faults, {kBiasJump, kAccelBiasJump})) {
    jumpBiases(recording, *f.fault, timing);
  }
  for (const NumberedFault& f : faultsOf(faults, {kClip, kGyroClip})) clip(samples, *f.fault);
  std::vector<std::vector<std::int64_t>> struck(faults.size());
  for (const NumberedFault& f : faultsOf(faults, {kSpike, kAccelSpike})) {
    struck[f.fault - faults.data()] = spike(samples, f, timing);
  }
  // After the spikes: one within a gap is not told, for its sample is gone.
  for (const NumberedFault& f : faultsOf(faults, {kGap})) {
    const TimeNs from = instantOf(*f.fault, timing);
    select(recording, [&](const ImuSample& sample) {
      return sample.t < from || sample.t >= from + toNanoseconds(f->value);
    });
  }
  std::vector<std::vector<TimeNs>> stamps(faults.size());
  std::optional<TimeNs> last;
  select(recording, [&](ImuSample& sample) {
    // By the true time, before the stamp takes its place.
    const std::int64_t number = sampleNumber(sample, timing);
    sample.t = stampOf(sample.t, number, faults, timing);
    if (last && sample.t <= *last) return false;
    last = sample.t;
    for (std::size_t f = 0; f < faults.size(); ++f) {
      if (std::binary_search(struck[f].begin(), struck[f].end(), number)) {
        stamps[f].push_back(sample.t);
      }
    }
    return true;
  });
  return stamps;
}

}  // namespace plumbline

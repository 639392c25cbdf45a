// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of the pre-integrated motion by faults of the samples, against pre-integrating
// samples from which the fault was removed. Not proven here: that estimates built on them are right
// (camera_imu_diagnosis_test).
#include <functional>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/residuals/imu_test_data.h"

namespace plumbline {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Samples = std::vector<ImuSample>;

constexpr TimeNs kFaultsEpoch = 1'404'733'405'732'800'000;
constexpr double kRate = 1000;
const ImuBias kFaultsBias{{0.01, -0.02, 0.03}, {0.1, 0.05, -0.2}};
const ImuWindow kFaultsWindow{kFaultsEpoch + 103'000'000, kFaultsEpoch + 153'700'000, 0.0123};

/// Central difference of the motion, by samples with the fault of size -h and +h removed.
Vector9 differenceQuotient(const std::function<Samples(double)>& without, double h) {
  const auto low = preintegrate(without(-h), kFaultsWindow, kFaultsBias);
  const auto high = preintegrate(without(h), kFaultsWindow, kFaultsBias);
  Vector9 out;
  out << logSO3(low->R.transpose() * high->R), high->v - low->v, high->p - low->p;
  return out / (2 * h);
}

/// The terms themselves are 0.01 to 1; the midpoint rule at 1 kHz errs by less than 1e-3 of them.
void expectNear(const Vector9& derivative, const Vector9& expected) {
  for (int i = 0; i < 9; ++i)
    EXPECT_NEAR(derivative(i), expected(i), 1e-3 * expected.norm() + 1e-8);
}

class SampleFaultsTest : public ::testing::Test {
 protected:
  const Samples samples_ = test::wavySamples(kFaultsEpoch, kRate, 0.4);
  const Eigen::Matrix<double, 9, SampleFaults::kCount> J_ =
      sampleFaultDerivatives(samples_, kFaultsWindow, kFaultsBias).value();

  /// Samples less a fault that is linear in the unbiased reading.
  Samples less(const std::function<void(ImuSample&, const ImuBias&)>& fault) const {
    Samples out = samples_;
    for (ImuSample& s : out) {
      const ImuBias unbiased{s.gyro - kFaultsBias.gyro, s.accel - kFaultsBias.accel};
      fault(s, unbiased);
    }
    return out;
  }
};

TEST_F(SampleFaultsTest, AccelerometerMatrix) {
  for (int k = 0; k < 9; ++k) {
    expectNear(J_.col(SampleFaults::kAccel + k), differenceQuotient(
                                                     [&](double h) {
                                                       return less([&](ImuSample& s, auto& u) {
                                                         s.accel(k / 3) -= h * u.accel(k % 3);
                                                       });
                                                     },
                                                     1e-4));
  }
}

TEST_F(SampleFaultsTest, GyroscopeMatrix) {
  for (int k = 0; k < 9; ++k) {
    expectNear(J_.col(SampleFaults::kGyro + k), differenceQuotient(
                                                    [&](double h) {
                                                      return less([&](ImuSample& s, auto& u) {
                                                        s.gyro(k / 3) -= h * u.gyro(k % 3);
                                                      });
                                                    },
                                                    1e-4));
  }
}

TEST_F(SampleFaultsTest, SensitivityToAcceleration) {
  for (int k = 0; k < 9; ++k) {
    expectNear(
        J_.col(SampleFaults::kGSensitivity + k),
        differenceQuotient(
            [&](double h) {
              return less([&](ImuSample& s, auto& u) { s.gyro(k / 3) -= h * u.accel(k % 3); });
            },
            1e-5));
  }
}

TEST_F(SampleFaultsTest, DelayOfTheAccelerometer) {
  // A reading that is h late is that of an earlier instant: the right one comes h later.
  const auto without = [&](double h) {
    Samples out = samples_;
    const auto step = static_cast<std::ptrdiff_t>(std::lround(h * kRate));
    for (std::size_t i = 10; i + 10 < out.size(); ++i) {
      out[i].accel =
          samples_[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + step)].accel;
    }
    return out;
  };
  const Vector9 expected = differenceQuotient(without, 1e-3);
  const Vector9 derivative = J_.col(SampleFaults::kDelay);
  // Finite differences of two samples, slopes over five: curvature of the force remains.
  EXPECT_LT((derivative - expected).norm(), 2e-3 * expected.norm());
}

TEST(SampleFaults, AWindowOffTheSamplesHasNoDerivatives) {
  const Samples samples = test::wavySamples(kFaultsEpoch, kRate, 0.1);
  EXPECT_FALSE(sampleFaultDerivatives(samples, kFaultsWindow, kFaultsBias));
  EXPECT_FALSE(sampleFaultDerivatives(
      samples, {kFaultsEpoch - 50'000'000, kFaultsEpoch + 1'000'000, 0}, kFaultsBias));
}

}  // namespace
}  // namespace plumbline

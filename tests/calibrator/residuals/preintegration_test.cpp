// SPDX-License-Identifier: BSD-3-Clause
// Pre-integration: hand values, second order of accuracy, Jacobians three ways, covariance by
// sampling, range edges. Not proven here: anything about gravity or frames (imu_residual_test).
#include <Eigen/LU>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/residuals/imu_test_data.h"

namespace plumbline {
namespace {

using test::ceresJacobian;
using test::wavySamples;

constexpr TimeNs kEpoch = 1'404'733'405'732'800'000;
const ImuBias kBias{{0.01, -0.02, 0.03}, {0.1, 0.05, -0.2}};

TEST(Preintegration, ConstantForceWithoutRotationGivesTheSchoolbookIntegrals) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < 5; ++k) {
    samples.push_back({kEpoch + k * 5'000'000, Eigen::Vector3d::Zero(), {1, 2, 3}});
  }
  const auto m = preintegrate(samples, {kEpoch, kEpoch + 20'000'000, 0}, {});
  ASSERT_TRUE(m);
  EXPECT_DOUBLE_EQ(m->duration_s, 0.02);
  EXPECT_TRUE(m->R.isIdentity(1e-15));
  EXPECT_TRUE(m->v.isApprox(Eigen::Vector3d(0.02, 0.04, 0.06), 1e-14));
  EXPECT_TRUE(m->p.isApprox(Eigen::Vector3d(2e-4, 4e-4, 6e-4), 1e-14));
  EXPECT_TRUE(m->v_ba.isApprox(-0.02 * Eigen::Matrix3d::Identity(), 1e-14));
  EXPECT_TRUE(m->p_ba.isApprox(-2e-4 * Eigen::Matrix3d::Identity(), 1e-14));
}

TEST(Preintegration, ConstantRateGivesItsRotationVector) {
  std::vector<ImuSample> samples;
  const Eigen::Vector3d w(0.3, -1, 2);
  for (int k = 0; k < 21; ++k) samples.push_back({k * 5'000'000, w, {0, 0, 0}});
  const auto m = preintegrate(samples, {10'000'000, 60'000'000, 0.0213}, {});
  ASSERT_TRUE(m);
  EXPECT_TRUE(m->R.isApprox(expSO3(w * 0.05), 1e-14));
}

TEST(Preintegration, TheWindowMovesWithTheOffsetInTheSignOfTheConvention) {
  // a_x = t, so v over [from + t_d, to + t_d] is (T)(mid + t_d).
  std::vector<ImuSample> samples;
  for (int k = 0; k < 100; ++k) samples.push_back({k * 10'000'000, {0, 0, 0}, {k * 0.01, 0, 0}});
  const auto m = preintegrate(samples, {200'000'000, 300'000'000, 0.123}, {});
  ASSERT_TRUE(m);
  EXPECT_NEAR(m->v.x(), 0.1 * (0.25 + 0.123), 1e-14);
  EXPECT_NEAR(m->v_td.x(), 0.1, 1e-13);
}

TEST(Preintegration, IsEmptyWhereSamplesDoNotCoverTheWindow) {
  const auto samples = wavySamples(0, 200, 0.1);  // 0 .. 0.1 s
  EXPECT_TRUE(preintegrate(samples, {0, 100'000'000, 0}, {}));
  EXPECT_FALSE(preintegrate(samples, {0, 100'000'000, 1e-6}, {}));
  EXPECT_FALSE(preintegrate(samples, {0, 100'000'000, -1e-6}, {}));
  EXPECT_FALSE(preintegrationCovariance(samples, {0, 100'000'000, 1e-6}, {}, {}));
  EXPECT_FALSE(preintegrate({}, {0, 100'000'000, 0}, {}));
}

TEST(Preintegration, ShiftingAllStampsShiftsTheOffsetAndNothingElse) {
  auto samples = wavySamples(kEpoch, 200, 1.0);
  const auto a = preintegrate(samples, {kEpoch + 300'000'000, kEpoch + 350'000'000, 0.0}, kBias);
  for (ImuSample& s : samples) s.t += 37'300'000;
  const auto b = preintegrate(samples, {kEpoch + 300'000'000, kEpoch + 350'000'000, 0.0373}, kBias);
  ASSERT_TRUE(a && b);
  EXPECT_TRUE(a->R.isApprox(b->R, 1e-14));
  EXPECT_TRUE(a->v.isApprox(b->v, 1e-13));
  EXPECT_TRUE(a->p.isApprox(b->p, 1e-13));
}

TEST(Preintegration, ErrorFallsWithTheSquareOfTheSampleInterval) {
  const ImuWindow window{100'000'000, 150'000'000, 0.0023};
  const auto fine = preintegrate(wavySamples(0, 25600, 0.3), window, {});
  double previous = 0;
  for (const double rate : {200.0, 400.0, 800.0, 1600.0}) {
    const auto m = preintegrate(wavySamples(0, rate, 0.3), window, {});
    const double error = logSO3(fine->R.transpose() * m->R).norm() + (fine->v - m->v).norm() +
                         (fine->p - m->p).norm();
    if (previous > 0) {
      EXPECT_NEAR(previous / error, 4, 0.5) << rate;
    }
    previous = error;
  }
}

/// (rotation on the right, v, p) of the motion against a base: the tangent of Preintegration.
Vector9d difference(const Preintegration& m, const Preintegration& base) {
  Vector9d d;
  d << logSO3(base.R.transpose() * m.R), m.v - base.v, m.p - base.p;
  return d;
}

Eigen::Matrix<double, 9, 7> analyticJacobian(const Preintegration& m) {
  Eigen::Matrix<double, 9, 7> J = Eigen::Matrix<double, 9, 7>::Zero();
  J.block<3, 3>(0, 0) = m.R_bg;
  J.block<3, 3>(3, 0) = m.v_bg;
  J.block<3, 3>(6, 0) = m.p_bg;
  J.block<3, 3>(3, 3) = m.v_ba;
  J.block<3, 3>(6, 3) = m.p_ba;
  J.col(6) << m.R_td, m.v_td, m.p_td;
  return J;
}

// Windows that start and end inside, on, and within one sample interval.
class PreintegrationJacobian : public ::testing::TestWithParam<ImuWindow> {};
INSTANTIATE_TEST_SUITE_P(Windows, PreintegrationJacobian,
                         ::testing::Values(ImuWindow{100'000'000, 150'000'000, 0.0023},
                                           ImuWindow{100'000'000, 150'000'000, 0.0},
                                           ImuWindow{101'000'000, 103'500'000, 0.0004},
                                           ImuWindow{100'000'000, 107'000'000, -0.001}));

TEST_P(PreintegrationJacobian, EqualsAutomaticDifferentiation) {
  const auto samples = wavySamples(0, 200, 0.3);
  const auto m = preintegrate(samples, GetParam(), kBias);
  ASSERT_TRUE(m);
  EXPECT_LT(
      (analyticJacobian(*m) - ceresJacobian(samples, GetParam(), kBias)).cwiseAbs().maxCoeff(),
      1e-10);
}

TEST_P(PreintegrationJacobian, EqualsCentralDifferences) {
  const auto samples = wavySamples(0, 200, 0.3);
  const auto base = preintegrate(samples, GetParam(), kBias);
  // Where an end lies on a stamp the derivative by t_d has a kink of second order: left out there.
  const int columns = GetParam().time_offset_s == 0 ? 6 : 7;
  Eigen::Matrix<double, 9, 7> numeric = analyticJacobian(*base);
  const double h = 1e-5;  // error h^2 and eps / h, both about 1e-10
  for (int k = 0; k < columns; ++k) {
    Vector9d side[2];
    for (const int s : {0, 1}) {
      ImuWindow window = GetParam();
      ImuBias bias = kBias;
      const double d = s == 0 ? -h : h;
      if (k < 3) bias.gyro(k) += d;
      if (k >= 3 && k < 6) bias.accel(k - 3) += d;
      if (k == 6) window.time_offset_s += d;
      side[s] = difference(*preintegrate(samples, window, bias), *base);
    }
    numeric.col(k) = (side[1] - side[0]) / (2 * h);
  }
  EXPECT_LT((analyticJacobian(*base) - numeric).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(SmoothOffsetDerivative, AgreesWithTheSchemesOwnForSmoothMotion) {
  const auto samples = wavySamples(0, 1600, 0.5);
  const ImuWindow window{200'000'000, 250'000'000, 0.0023};
  const auto m = preintegrate(samples, window, kBias);
  const Vector9d smooth = smoothOffsetDerivative(samples, window, kBias, *m);
  Vector9d exact;
  exact << m->R_td, m->v_td, m->p_td;
  EXPECT_LT((smooth - exact).norm(), 0.02 * exact.norm());
}

// Biases come off the readings before anything turns with them, however large they are.
TEST(SmoothOffsetDerivative, IsThatOfSamplesWithoutBias) {
  const ImuWindow window{200'000'000, 250'000'000, 0.0023};
  const ImuBias bias{{0.8, -0.5, 0.6}, {3, -2, 4}};
  const auto clean = wavySamples(0, 400, 0.5);
  auto biased = clean;
  for (ImuSample& s : biased) {
    s.gyro += bias.gyro;
    s.accel += bias.accel;
  }
  const auto motion = preintegrate(clean, window, {});
  const Vector9d expected = smoothOffsetDerivative(clean, window, {}, *motion);
  EXPECT_LT((smoothOffsetDerivative(biased, window, bias, *motion) - expected).norm(), 1e-12);
}

TEST(SmoothOffsetDerivative, FeelsLessOfTheNoiseOfSingleSamples) {
  const ImuWindow window{200'000'000, 250'000'000, 0.0023};
  auto samples = wavySamples(0, 1600, 0.5);
  const auto clean = preintegrate(samples, window, {});
  const Vector9d reference = smoothOffsetDerivative(samples, window, {}, *clean);
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  for (ImuSample& s : samples) {
    for (int k = 0; k < 3; ++k) s.accel(k) += normal(engine);
  }
  const auto noisy = preintegrate(samples, window, {});
  const Vector9d smooth = smoothOffsetDerivative(samples, window, {}, *noisy);
  const double smooth_error = (smooth - reference).segment<3>(3).norm();
  EXPECT_LT(smooth_error, 0.4 * (noisy->v_td - clean->v_td).norm());
}

TEST(PreintegrationCovariance, OfPureForceNoiseIsTheIntegratedWhiteNoise) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < 21; ++k) samples.push_back({k * 5'000'000, {0, 0, 0}, {0, 0, 0}});
  const ImuNoise noise;
  const auto P = preintegrationCovariance(samples, {0, 100'000'000, 0}, {}, noise);
  ASSERT_TRUE(P);
  const double T = 0.1;
  const double qa = noise.accel_density * noise.accel_density;
  const double qg = noise.gyro_density * noise.gyro_density;
  EXPECT_NEAR((*P)(0, 0), qg * T, 1e-12 * qg * T);
  EXPECT_NEAR((*P)(3, 3), qa * T, 1e-12 * qa * T);
  EXPECT_NEAR((*P)(6, 3), qa * T * T / 2, 1e-12 * qa * T * T);
  EXPECT_NEAR((*P)(6, 6), qa * T * T * T / 3, 1e-12 * qa * T * T * T);
}

// A constant rate noise w turns by w t, so that the force a gives velocity -[a]x w t^2 / 2 and
// position -[a]x w t^3 / 6: what white noise of the gyroscope has in common with both, over one
// interval of samples as well as over many.
TEST(PreintegrationCovariance, NoiseOfTheGyroscopeTurnsTheForce) {
  const ImuNoise noise;
  const double T = 0.1, g = 9.8;
  const double q = noise.gyro_density * noise.gyro_density * T;
  for (const int intervals : {1, 20}) {
    std::vector<ImuSample> samples;
    for (int k = 0; k <= intervals; ++k) {
      samples.push_back({k * (100'000'000 / intervals), {0, 0, 0}, {0, 0, g}});
    }
    const auto P = preintegrationCovariance(samples, {0, 100'000'000, 0}, {}, noise);
    ASSERT_TRUE(P);
    // A turn about y moves the force towards x; one about x, away from y.
    EXPECT_NEAR((*P)(3, 1), q * g * T / 2, 1e-12 * q * g * T);
    EXPECT_NEAR((*P)(4, 0), -q * g * T / 2, 1e-12 * q * g * T);
    EXPECT_NEAR((*P)(6, 1), q * g * T * T / 6, 1e-12 * q * g * T * T);
    EXPECT_NEAR((*P)(7, 0), -q * g * T * T / 6, 1e-12 * q * g * T * T);
  }
}

TEST(PreintegrationCovariance, AgreesWithTheSpreadOfNoisySamples) {
  // Long window, so that the weight of the two end samples does not matter.
  const double rate = 500;
  const ImuWindow window{0, 1'000'000'000, 0};
  const ImuNoise noise{1e-3, 0, 2e-3, 0, rate};
  const auto samples = wavySamples(0, rate, 1.0);
  const auto base = preintegrate(samples, window, {});
  const auto P = preintegrationCovariance(samples, window, {}, noise);
  ASSERT_TRUE(base && P);
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  Matrix9d sampled = Matrix9d::Zero();
  const int runs = 1000;
  for (int run = 0; run < runs; ++run) {
    auto noisy = samples;
    for (ImuSample& s : noisy) {
      for (int k = 0; k < 3; ++k) {
        s.gyro(k) += noise.gyro_density * std::sqrt(rate) * normal(engine);
        s.accel(k) += noise.accel_density * std::sqrt(rate) * normal(engine);
      }
    }
    const Vector9d d = difference(*preintegrate(noisy, window, {}), *base);
    sampled += d * d.transpose() / runs;
  }
  // Relative spread of a sampled variance is sqrt(2 / runs) = 0.045.
  const Matrix9d whitened = P->inverse() * sampled;
  EXPECT_NEAR(whitened.trace(), 9, 9 * 0.06);
  for (int k = 0; k < 9; ++k) EXPECT_NEAR(sampled(k, k) / (*P)(k, k), 1, 0.18) << k;
}

}  // namespace
}  // namespace plumbline

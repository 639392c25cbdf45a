// SPDX-License-Identifier: BSD-3-Clause
// Where each check of units, axes and target draws its line, by figures made up by hand. Not proven
// here: that faults of recordings lead to these figures (camera_imu_failures_test).
#include "calibrator/initialise/imu_sanity.h"

#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

using Code = std::optional<FailureCode>;

Code codeOf(const std::optional<Failure>& failure) {
  return failure ? Code(failure->code) : std::nullopt;
}

/// Samples in groups of `size` that are `apart` ns apart, a group every 20 ms.
std::vector<ImuSample> inBursts(int size, TimeNs apart) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < 100 * size; ++k) {
    samples.push_back({k / size * 20'000'000 + k % size * apart, {0, 0, 0}, {0, 0, 9.8}});
  }
  return samples;
}

TEST(CheckSampleStamps, BurstsAreToldWithTheirSize) {
  const auto failure = checkSampleStamps(inBursts(4, 100'000));
  ASSERT_EQ(codeOf(failure), FailureCode::kSamplesInBursts);
  EXPECT_EQ(failure->number("count"), 4);
  EXPECT_DOUBLE_EQ(failure->number("apart_s"), 1e-4);
  EXPECT_DOUBLE_EQ(failure->number("pause_s"), 0.0197);
}

TEST(CheckSampleStamps, EvenOnesAndAFewThatCrowdAreNone) {
  EXPECT_FALSE(checkSampleStamps(inBursts(1, 0)));
  EXPECT_FALSE(checkSampleStamps(inBursts(4, 5'000'000)));
  // Intervals of a quarter of their mean are short, but above a fifth.
  EXPECT_FALSE(checkSampleStamps(inBursts(2, 2'500'000)));
  // Shares of 2, 3.5 and 5 in ten.
  for (const auto& [short_ones, expected] :
       {std::pair{20, false}, std::pair{35, true}, std::pair{50, true}}) {
    std::vector<ImuSample> samples(1);
    for (int k = 0; k < 100; ++k) {
      samples.push_back({samples.back().t + (k < short_ones ? 100'000 : 10'000'000)});
    }
    EXPECT_EQ(checkSampleStamps(samples).has_value(), expected) << short_ones;
  }
}

Code unitsOf(double gyro, double accel) {
  std::vector<ImuSample> samples(5, {0, {0, gyro, 0}, {0, 0, accel}});
  samples[0].accel.x() = 1e5;  // a knock does not move a median
  return codeOf(checkSampleUnits(samples));
}

TEST(CheckSampleUnits, AreToldByTheMediansOfBothNorms) {
  const struct {
    double gyro, accel;
    Code expected;
  } kCases[] = {
      {0.5, 9.8, std::nullopt},                  // rad/s, m/s^2
      {30, 9.8, std::nullopt},                   // deg/s: the camera's rates tell
      {0.5, 12, std::nullopt},                   // in motion
      {0.5, 1, FailureCode::kAccelerometerInG},  // g
      {0.5, 1000, FailureCode::kAccelerometerInMilliG},
      {0.5, 98, FailureCode::kAccelerometerUnits},     // ten times too much
      {0.5, 16384, FailureCode::kAccelerometerUnits},  // counts
      {0.5, 0, FailureCode::kAccelerometerUnits},      // a dead sensor
      {9.8, 0.5, FailureCode::kColumnsSwapped},
      {9.8, 9.8, std::nullopt},  // spun fast, not swapped
  };
  for (const auto& c : kCases) EXPECT_EQ(unitsOf(c.gyro, c.accel), c.expected) << c.accel;
}

Code excitationOf(double a, double b, double c) {
  RateAlignment rates;
  rates.excitation << a, b, c;
  return codeOf(checkExcitation(rates));
}

TEST(CheckExcitation, TwoAxesAreEnough) {
  EXPECT_EQ(excitationOf(1, 0.5, 0.2), std::nullopt);
  EXPECT_EQ(excitationOf(1, 0.5, 0), std::nullopt);  // the third follows from two
  EXPECT_EQ(excitationOf(0.02, 0.02, 0), std::nullopt);
  EXPECT_EQ(excitationOf(1, 0.019, 0.019), FailureCode::kRotationAboutOneAxis);
  EXPECT_EQ(excitationOf(0.019, 0.019, 0.019), FailureCode::kNoRotation);
}

Code ratesOf(double correlation, double mirrored, double ratio) {
  RateAlignment rates;
  rates.correlation = correlation;
  rates.mirrored_correlation = mirrored;
  rates.gyro_to_camera = ratio;
  return codeOf(checkRates(rates));
}

TEST(CheckRates, TellMotionsHandsAndUnitsApart) {
  EXPECT_EQ(ratesOf(0.999, 0.9, 1), std::nullopt);
  EXPECT_EQ(ratesOf(0.75, 0.7, 1), FailureCode::kRatesDoNotCorrelate);
  // The wrong hand correlates as a reflection alone.
  EXPECT_EQ(ratesOf(0.5, 0.99, 1), FailureCode::kGyroscopeMirrored);
  // Noisy rates about nearly one plane: the reflection is better by chance, not by a half.
  EXPECT_EQ(ratesOf(0.90, 0.93, 1), std::nullopt);
  EXPECT_EQ(ratesOf(0.90, 0.96, 1), FailureCode::kGyroscopeMirrored);
  EXPECT_EQ(ratesOf(0.999, 0.9, kDegrees), FailureCode::kGyroscopeInDegrees);
  EXPECT_EQ(ratesOf(0.999, 0.9, kDegree), FailureCode::kGyroscopeScale);
}

// The camera's noise makes its rates larger, and the gyroscope seem slower: by the correlation.
TEST(CheckRates, AScaleOfTheGyroscopeIsWhatNoiseDoesNotExplain) {
  EXPECT_EQ(ratesOf(1, 0.9, 1.05), std::nullopt);
  EXPECT_EQ(ratesOf(1, 0.9, 0.95), std::nullopt);
  EXPECT_EQ(ratesOf(1, 0.9, 1.07), FailureCode::kGyroscopeScale);
  EXPECT_EQ(ratesOf(1, 0.9, 0.93), FailureCode::kGyroscopeScale);
  EXPECT_EQ(ratesOf(0.95, 0.9, 0.93), std::nullopt);  // 1 - 0.95^2 = 0.0975
  EXPECT_EQ(ratesOf(0.95, 0.9, 0.80), FailureCode::kGyroscopeScale);
}

/// What an alignment of a good recording looks like: noise alone.
InertialAlignment plausible() {
  InertialAlignment a;
  a.gravity_F << 0, 0, -9.81;
  a.gravity_std = 0.01;
  a.scale_std = 0.002;
  a.residual_rms = a.fixed_rms = a.noise_rms = 0.1;
  return a;
}

Code inertialOf(const InertialAlignment& a) { return codeOf(checkInertial(a, AprilGrid())); }

TEST(CheckInertial, AxesAndSignsComeFirst) {
  InertialAlignment a = plausible();
  EXPECT_EQ(inertialOf(a), std::nullopt);
  a.scale = -1;
  EXPECT_EQ(inertialOf(a), FailureCode::kAccelerometerReversed);
  a.residual_rms = 1.6;  // and then gravity and scale mean nothing
  EXPECT_EQ(inertialOf(a), FailureCode::kAccelerometerAxes);
}

TEST(CheckInertial, AResidualThatIsNoNumberDoesNotPass) {
  InertialAlignment a = plausible();
  a.residual_rms = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(inertialOf(a), FailureCode::kAccelerometerAxes);
}

TEST(CheckInertial, GravityMustBeOffByMuchAndByManyDeviations) {
  InertialAlignment a = plausible();
  a.gravity_F *= 0.98;  // by less than 3 %
  EXPECT_EQ(inertialOf(a), std::nullopt);
  a.gravity_F = plausible().gravity_F * 0.95;
  EXPECT_EQ(inertialOf(a), FailureCode::kGravityDisagrees);
  a.gravity_std = 0.1;  // 0.49 m/s^2 is within 6 of them
  EXPECT_EQ(inertialOf(a), std::nullopt);
}

TEST(CheckInertial, TheTargetsSizeMustBeOffByMuchAndByManyDeviations) {
  InertialAlignment a = plausible();
  a.noise_rms = 0;  // not known: a scale that is significant is believed
  a.scale = 0.97;
  EXPECT_EQ(inertialOf(a), std::nullopt);
  a.scale = 0.9;
  EXPECT_EQ(inertialOf(a), FailureCode::kScaleDisagrees);
  a.scale = 1.1;
  EXPECT_EQ(inertialOf(a), FailureCode::kScaleDisagrees);
  a.scale_std = 0.02;
  EXPECT_EQ(inertialOf(a), std::nullopt);
}

// A fault of the IMU changes the scale as well, but no scale makes it noise.
TEST(CheckInertial, TheTargetIsBlamedOnlyWhereAnotherSizeExplainsTheMotion) {
  const struct {
    const char* name;
    double residual, fixed;  // over the noise, in metres of the stated target
    Code expected;
  } kCases[] = {
      {"noise with another size, and much more with the stated one", 1, 2,
       FailureCode::kScaleDisagrees},
      {"noise with either", 1, 1.2, std::nullopt},
      {"far above noise with either", 5, 10, std::nullopt},
      {"nearly all is explained, whatever the noise is", 5, 30, FailureCode::kScaleDisagrees},
  };
  for (const auto& c : kCases) {
    InertialAlignment a = plausible();
    a.scale = 0.5;
    a.residual_rms = c.residual * a.noise_rms * a.scale;  // in true metres
    a.fixed_rms = c.fixed * a.noise_rms;
    EXPECT_NEAR(residualRatio(a), c.residual, 1e-12);
    EXPECT_EQ(inertialOf(a), c.expected) << c.name;
  }
}

// What is told are the figures that the check judged, each under its own name.
TEST(CheckSampleUnits, FiguresAreToldByTheirNames) {
  const std::vector<ImuSample> samples(5, {0, {0, 0.25, 0}, {0, 0, 98}});
  const auto failure = checkSampleUnits(samples);
  ASSERT_EQ(codeOf(failure), FailureCode::kAccelerometerUnits);
  EXPECT_EQ(failure->number("accel"), 98);
  EXPECT_EQ(failure->number("gyro"), 0.25);
  EXPECT_EQ(failure->number("gravity"), SanityOptions().gravity_m_s2);
  EXPECT_EQ(codeOf(checkSampleUnits(std::span(samples).first(1))), FailureCode::kTooFewSamples);
}

TEST(CheckExcitation, NamesTheAxisThatWasTurnedAboutAndTheRateAcross) {
  RateAlignment rates;
  rates.excitation << 1, 0.01, 0.005;
  rates.excitation_axes << 0, 1, 0,  //
      0.6, 0, -0.8,                  //
      0.8, 0, 0.6;
  const auto failure = checkExcitation(rates);
  ASSERT_EQ(codeOf(failure), FailureCode::kRotationAboutOneAxis);
  EXPECT_EQ(toString(*failure), "RotationAboutOneAxis (axis   0 0.6 0.8, rms 0.01)");
}

TEST(CheckInertial, TellsTheSizeThatTheTargetWasStatedTooLarge) {
  InertialAlignment a = plausible();
  a.noise_rms = 0;
  a.scale = 0.5;
  AprilGrid target;
  target.tag_size = 0.176;
  const auto failure = checkInertial(a, target);
  ASSERT_EQ(codeOf(failure), FailureCode::kScaleDisagrees);
  EXPECT_EQ(failure->number("scale"), 0.5);
  EXPECT_EQ(failure->number("scale_std"), 0.002);
  EXPECT_EQ(failure->number("tag_size"), 0.176);
  a = plausible();
  a.gravity_F << 0, 8, -6;
  const auto gravity = checkInertial(a, target);
  ASSERT_EQ(codeOf(gravity), std::nullopt) << "10 m/s^2 is 2 % off";
  a.gravity_F *= 1.1;
  EXPECT_NEAR(checkInertial(a, target)->number("measured"), 11, 1e-12);
}

}  // namespace
}  // namespace plumbline

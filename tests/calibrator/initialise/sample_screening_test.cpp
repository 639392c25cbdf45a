// SPDX-License-Identifier: BSD-3-Clause
// Isolated readings and readings that are cut off are found where they are, and what looks like
// them is not. Not proven here: what they do to a calibration.
#include "calibrator/initialise/sample_screening.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/initialise/angular_rates.h"

namespace plumbline {
namespace {

// A swinging sensor with white noise, 200 Hz for 10 s.
std::vector<ImuSample> swinging(double gyro_sigma, double accel_sigma) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> unit;
  std::vector<ImuSample> samples;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.005 * k;
    ImuSample s{5'000'000LL * k,
                {2 * std::sin(9 * t), std::cos(5 * t), std::sin(12 * t + 1)},
                {4 * std::sin(14 * t), 9.8 + 4 * std::sin(8 * t), 3 * std::cos(11 * t)}};
    for (int i = 0; i < 3; ++i) {
      s.gyro(i) += gyro_sigma * unit(random);
      s.accel(i) += accel_sigma * unit(random);
    }
    samples.push_back(s);
  }
  return samples;
}

TEST(FindSpikes, NoneInMotionNoiseVibrationAndKnocks) {
  EXPECT_TRUE(findSpikes(swinging(0, 0), {}).empty());
  EXPECT_TRUE(findSpikes(swinging(0.0024, 0.03), {}).empty());
  EXPECT_TRUE(findSpikes(swinging(0.05, 0.5), {}).empty());  // ten times what was stated
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].accel.z() += 20 * std::sin(1.9 * static_cast<double>(k));  // 60 Hz
  }
  EXPECT_TRUE(findSpikes(samples, {}).empty());
  samples = swinging(0.0024, 0.03);
  for (std::size_t k = 1000; k < samples.size(); ++k) samples[k].gyro.x() += 0.2;  // a jump
  EXPECT_TRUE(findSpikes(samples, {}).empty());
  for (std::size_t k = 0; k < 8; ++k) {  // a knock of 40 ms
    samples[500 + k].accel.y() += 30 * std::sin(3.14159 * static_cast<double>(k) / 8);
  }
  EXPECT_TRUE(findSpikes(samples, {}).empty());
}

TEST(FindSpikes, FindsStampChannelAndSize) {
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  samples[300].gyro.y() += 0.2;
  samples[700].accel.x() -= 500;
  samples[1500].gyro.z() += 100;
  const std::vector<ImuSpike> spikes = findSpikes(samples, {});
  ASSERT_EQ(spikes.size(), 3U);
  EXPECT_EQ(spikes[0].t, samples[300].t);
  EXPECT_EQ(spikes[0].channel, 1);
  EXPECT_NEAR(spikes[0].size, 0.2, 0.02);
  EXPECT_EQ(spikes[1].channel, 3);
  EXPECT_NEAR(spikes[1].size, -500, 1);
  EXPECT_EQ(spikes[2].t, samples[1500].t);
  const std::vector<ImuSample> kept = withoutSpikes(samples, spikes);
  EXPECT_EQ(kept.size(), samples.size() - 3);
  EXPECT_TRUE(findSpikes(kept, {}).empty());
}

/// A sensor at rest that reads exactly the same, at 200 Hz.
std::vector<ImuSample> atRest(std::size_t count) {
  std::vector<ImuSample> samples(count);
  for (std::size_t k = 0; k < count; ++k) {
    samples[k] = {5'000'000 * static_cast<TimeNs>(k), {0, 0, 0}, {0, 0, 9.8}};
  }
  return samples;
}

// 12 deviations of a distance whose noise is 1.39 times that of a reading, which is density times
// root of the rate; not below a third of what is stated: 0.08 rad/s and 0.8 m/s^2 here.
TEST(FindSpikes, OfQuietSamplesAreMeasuredAgainstTheStatedNoiseOfTheirSensor) {
  ImuNoise noise;
  noise.gyro_density = 1e-3;
  noise.accel_density = 1e-2;
  const auto count = [&](double gyro, double accel) {
    std::vector<ImuSample> samples = atRest(200);
    samples[70].gyro.z() += gyro;
    samples[140].accel.y() += accel;
    return findSpikes(samples, noise).size();
  };
  EXPECT_EQ(count(0.05, 0.5), 0U);
  EXPECT_EQ(count(0.1, 0.5), 1U);
  EXPECT_EQ(count(0.05, 1), 1U);
}

TEST(FindSpikes, ASampleThatWasReadLateIsNone) {
  std::vector<ImuSample> samples = atRest(200);
  samples[100].t += 3'000'000;
  // It turns faster and faster, and every reading is true at its stamp.
  for (ImuSample& s : samples) s.gyro.x() = 20 * secondsBetween(0, s.t);
  ImuNoise noise;
  noise.gyro_density = 1e-4;
  EXPECT_TRUE(findSpikes(samples, noise).empty());
  samples[100].t -= 3'000'000;
  EXPECT_EQ(findSpikes(samples, noise).size(), 1U);
}

TEST(CutOff, IsFoundAndLeavesAGap) {
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  EXPECT_TRUE(findCutOff(samples).empty());
  for (ImuSample& s : samples) s.accel.y() = std::min(s.accel.y(), 13.0);
  const std::vector<CutOff> found = findCutOff(samples);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].channel, 4);
  EXPECT_EQ(found[0].limit, 13);
  for (const std::size_t k : found[0].samples) EXPECT_EQ(samples[k].accel.y(), 13);
  for (const ImuSample& s : withoutCutOff(samples, found)) EXPECT_LT(s.accel.y(), 13);
  // Where most would have to go, all stay.
  for (ImuSample& s : samples) s.accel.y() = std::min(s.accel.y(), 10.0);
  EXPECT_EQ(withoutCutOff(samples, findCutOff(samples)).size(), samples.size());
}

TEST(CutOff, IsNotWhereACoarseSensorRests) {
  std::vector<ImuSample> samples = swinging(0, 0);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].accel.z() = k % 20 == 0 ? -9.7 : -9.8;
  }
  EXPECT_TRUE(findCutOff(samples).empty());
}

TEST(CutOff, IsNotWherePeaksAreAlikeButLastOneSample) {
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  for (std::size_t k = 100; k < 700; k += 100) samples[k].accel.y() = 25;
  EXPECT_TRUE(findCutOff(samples).empty());
  for (std::size_t k = 100; k < 700; k += 100) samples[k + 1].accel.y() = 25;
  EXPECT_EQ(findCutOff(samples).size(), 1U);
}

// Up and down again in steps: all levels repeat alike.
TEST(CutOff, IsNotWhereACoarseSensorPassesItsLevels) {
  std::vector<ImuSample> samples = atRest(2000);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double triangle = std::abs(static_cast<double>(k % 200) - 99.5);  // 99.5 to 0.5
    samples[k].gyro.x() = 0.1 * std::floor(triangle / 5);
  }
  EXPECT_TRUE(findCutOff(samples).empty());
  for (ImuSample& s : samples) s.gyro.x() = std::min(s.gyro.x(), 1.2);
  EXPECT_EQ(findCutOff(samples).size(), 1U);
}

// Else the integral would go straight on through what the sensor did not show.
TEST(CutOff, EvenOneReadingLeavesWhatCountsAsAGap) {
  const std::vector<ImuSample> samples = atRest(100);
  const std::vector<ImuSample> kept = withoutCutOff(samples, {{{0, 0, {0, 20, 50, 51, 99}}}});
  ASSERT_EQ(kept.size(), 100U - 3 - 5 - 6 - 3);
  EXPECT_EQ(kept.front().t, samples[3].t);
  EXPECT_EQ(kept.back().t, samples[96].t);
  const GyroIntegral integral(kept);
  for (const std::size_t k : {20U, 50U}) {
    EXPECT_FALSE(integral.meanRate(samples[k - 5].t, samples[k + 5].t, 0));
  }
  EXPECT_TRUE(integral.meanRate(samples[25].t, samples[45].t, 0));
}

}  // namespace
}  // namespace plumbline

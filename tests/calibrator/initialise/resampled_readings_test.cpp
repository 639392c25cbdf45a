// SPDX-License-Identifier: BSD-3-Clause
// Readings that a driver has held or interpolated are told from a sensor's own.
#include "calibrator/initialise/resampled_readings.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

class ResampledReadings : public testing::Test {
 protected:
  static std::vector<ImuSample> recorded(bool noise = true) {
    SimulationOptions options;
    options.duration_s = 10;
    options.imu_noise = noise;
    return simulateSession(simulatedRig("euroc"), options).session.imu->samples;
  }

  /// The accelerometer's readings at every `every`-th of the stamps alone, in between as `between`
  /// makes them of the readings on either side and the share of the way.
  static std::vector<ImuSample> resampled(std::size_t every, auto between) {
    std::vector<ImuSample> samples = recorded();
    const std::vector<ImuSample> raw = samples;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const std::size_t before = k / every * every, after = before + every;
      if (after >= raw.size()) break;
      const double w = static_cast<double>(k - before) / static_cast<double>(every);
      samples[k].accel = between(raw[before].accel, raw[after].accel, w);
    }
    return samples;
  }

  static Resampling found(const std::vector<ImuSample>& samples,
                          Eigen::Vector3d ImuSample::*sensor) {
    const auto resampling = findResampling(samples, sensor);
    EXPECT_TRUE(resampling);
    return resampling.value_or(Resampling{-1, -1});
  }
  static Resampling accel(const std::vector<ImuSample>& samples) {
    return found(samples, &ImuSample::accel);
  }
};

TEST_F(ResampledReadings, ASensorsOwnAreNeither) {
  for (const bool noise : {true, false}) {
    const std::vector<ImuSample> samples = recorded(noise);
    for (const auto sensor : {&ImuSample::gyro, &ImuSample::accel}) {
      const Resampling r = found(samples, sensor);
      EXPECT_LT(r.held, 0.001) << noise;
      EXPECT_LT(r.on_line, 0.03) << noise;
    }
  }
}

TEST_F(ResampledReadings, CopiesAreHeld) {
  for (const std::size_t every : {2U, 4U, 6U, 10U}) {
    const auto samples =
        resampled(every, [](const auto& a, const auto&, double) { return Eigen::Vector3d(a); });
    EXPECT_GT(accel(samples).held, 0.9) << every;
    EXPECT_LT(found(samples, &ImuSample::gyro).held, 0.001) << every;
  }
}

TEST_F(ResampledReadings, InterpolatedOnesLieOnTheLine) {
  for (const std::size_t every : {2U, 4U, 16U}) {
    const auto samples = resampled(every, [](const auto& a, const auto& b, double w) {
      return Eigen::Vector3d((1 - w) * a + w * b);
    });
    const double between = 1 - 1.0 / static_cast<double>(every);
    EXPECT_NEAR(accel(samples).on_line, between, 0.15) << every;
    EXPECT_LT(accel(samples).held, 0.001) << every;
  }
}

TEST_F(ResampledReadings, ACoarseConverterIsNotJudged) {
  std::vector<ImuSample> samples = recorded();
  for (ImuSample& s : samples) {
    for (double& a : s.accel) a = std::round(a / 2) * 2;
  }
  EXPECT_FALSE(findResampling(samples, &ImuSample::accel));
}

TEST_F(ResampledReadings, FewReadingsSayNothing) {
  std::vector<ImuSample> samples = recorded();
  samples.resize(100);
  EXPECT_FALSE(findResampling(samples, &ImuSample::accel));
}

}  // namespace
}  // namespace plumbline

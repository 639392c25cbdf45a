// SPDX-License-Identifier: BSD-3-Clause
// Rules over single samples and intervals: readings cut off at the range, and residuals far off the
// others. Not proven here: how large a cut or a jump has to be to bias a calibration.
#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

// A swinging sensor, 200 Hz for 10 s: up to 14 m/s^2 and 2 rad/s.
std::vector<ImuSample> swinging() {
  std::vector<ImuSample> samples;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.005 * k;
    samples.push_back({5'000'000LL * k,
                       {2 * std::sin(3 * t), std::cos(5 * t), std::sin(2 * t + 1)},
                       {4 * std::sin(4 * t), 9.8 + 4 * std::sin(2.7 * t), 3 * std::cos(3.1 * t)}});
  }
  return samples;
}

TEST(SampleRules, ASwingingSensorIsNotCutOff) {
  const Findings findings = judgeSamples(swinging(), {});
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].level, VerdictLevel::kGood);
  EXPECT_EQ(findings[1].level, VerdictLevel::kGood) << findings[1].evidence;
}

TEST(SampleRules, CopiesOfReadingsAreNamedByTheirSensor) {
  std::vector<ImuSample> samples = swinging();
  for (std::size_t k = 1; k < samples.size(); k += 2) samples[k].accel = samples[k - 1].accel;
  const Finding found = judgeSamples(samples, {})[1];
  EXPECT_EQ(found.rule, "Readings held or interpolated");
  EXPECT_EQ(found.level, VerdictLevel::kCaution);
  EXPECT_THAT(found.evidence, HasSubstr("accelerometer: 100.0 % repeat a neighbour"));
  EXPECT_THAT(found.evidence, HasSubstr("gyroscope: 0.0 % repeat a neighbour"));
}

TEST(SampleRules, ReadingsCutOffAreFoundWithChannelAndLimit) {
  std::vector<ImuSample> samples = swinging();
  for (ImuSample& s : samples) s.accel.y() = std::clamp(s.accel.y(), -12.0, 12.0);
  const Findings findings = judgeSamples(samples, {});
  EXPECT_EQ(findings.front().level, VerdictLevel::kCaution);
  EXPECT_THAT(findings.front().evidence, HasSubstr("accelerometer y at 12"));
}

TEST(SampleRules, ASensorAtRestRepeatsItsLargestReadingRightly) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < 2000; ++k) {  // three steps of a coarse converter
    const double step = 0.02 * static_cast<double>((k / 3) % 3 - 1);
    samples.push_back({5'000'000LL * k, {step, 0, -step}, {step, 9.8 + step, 0}});
  }
  EXPECT_EQ(judgeSamples(samples, {}).front().level, VerdictLevel::kGood);
}

CameraImuStageResult stageWithResiduals(double largest) {
  CameraImuStageResult stage;
  for (int k = 0; k < 200; ++k) {
    stage.frames.push_back({50'000'000LL * k, {k}});
    ImuIntervalResidual r;
    r.t = 50'000'000LL * k;
    r.dt_s = 0.05;
    r.normalised.setConstant(0.1 + 0.01 * (k % 7));
    if (k == 120) r.normalised(1) = largest;
    stage.imu_residuals.push_back(r);
  }
  return stage;
}

TEST(SampleRules, AnIsolatedResidualIsFoundWithItsInstant) {
  EXPECT_EQ(judgeIsolatedResiduals(stageWithResiduals(1), {}).front().level, VerdictLevel::kGood);
  const Findings findings = judgeIsolatedResiduals(stageWithResiduals(50), {});
  EXPECT_EQ(findings.front().level, VerdictLevel::kCaution);
  EXPECT_THAT(findings.front().evidence, HasSubstr("rotation (gyroscope)"));
  EXPECT_THAT(findings.front().evidence, HasSubstr("6.00 s"));
  EXPECT_TRUE(judgeIsolatedResiduals({}, {}).empty());
}

TEST(SampleRules, AResidualThatIsNotANumberIsBad) {
  CameraImuStageResult stage = stageWithResiduals(1);
  stage.imu_residuals[70].normalised(0) = std::nan("");
  const Findings findings = judgeIsolatedResiduals(stage, {});
  EXPECT_EQ(findings.front().level, VerdictLevel::kBad);
  EXPECT_THAT(findings.front().evidence, HasSubstr("rotation (gyroscope)"));
}

TEST(SampleRules, PartsThatDoNotFitTogetherAreFound) {
  CameraImuStageResult stage;
  stage.imu_summary.gyro_normalised_rms = 0.2;
  stage.imu_summary.noise.gyro = {.expected_rms = 0.22, .factor = 1, .redundancy = 300};
  ASSERT_EQ(judgeLongResiduals(stage, {}).size(), 1U);  // nothing is known of the accelerometer
  EXPECT_EQ(judgeLongResiduals(stage, {}).front().level, VerdictLevel::kGood);
  stage.imu_summary.gyro_normalised_rms = 8;
  EXPECT_EQ(judgeLongResiduals(stage, {}).front().level, VerdictLevel::kCaution);
}

// A sensor that turns about changing axes; frames' stamps err by `jitter_s`, and rotations by noise
// of `noise_rad` on every axis. The residual of an interval is what both do to it.
CameraImuStageResult stageWithJitter(double jitter_s, double noise_rad) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> unit;
  CameraImuStageResult stage;
  constexpr int kFrames = 400;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double before = jitter_s * unit(random);
  for (int k = 0; k < kFrames; ++k) {
    stage.frames.push_back({50'000'000LL * k, {k}});
    ImuState state;
    state.T_FS.R = R;
    stage.states.push_back(state);
    const double t = 0.05 * k;
    const Eigen::Vector3d rate(std::sin(t), std::cos(0.7 * t), 0.5 * std::sin(1.3 * t));
    R *= expSO3(0.05 * rate);
    if (k + 1 == kFrames) break;
    const double after = jitter_s * unit(random);
    ImuIntervalResidual r;
    r.t = 50'000'000LL * k;
    r.dt_s = 0.05;
    r.rotation_rad = (after - before) * rate;
    for (int axis = 0; axis < 3; ++axis) r.rotation_rad(axis) += noise_rad * unit(random);
    stage.imu_residuals.push_back(r);
    before = after;
  }
  return stage;
}

TEST(SampleRules, StampsThatJitterAreFoundWithTheirSize) {
  EXPECT_EQ(judgeStampJitter(stageWithJitter(0, 1e-3), {}).front().level, VerdictLevel::kGood);
  const Findings findings = judgeStampJitter(stageWithJitter(2e-3, 1e-4), {});
  EXPECT_EQ(findings.front().level, VerdictLevel::kCaution);
  EXPECT_NEAR(findings.front().value, 2, 0.3);
  EXPECT_TRUE(judgeStampJitter({}, {}).empty());
}

// Over a gap of the IMU there is no residual; those behind it count, and a handful is too few.
TEST(SampleRules, StampsThatJitterAreFoundBeyondAGapOfTheImu) {
  CameraImuStageResult stage = stageWithJitter(2e-3, 1e-4);
  stage.imu_residuals.erase(stage.imu_residuals.begin() + 10);
  const Findings findings = judgeStampJitter(stage, {});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NEAR(findings.front().value, 2, 0.3);
  for (std::size_t i = 10; i < stage.imu_residuals.size(); ++i) ++stage.imu_residuals[i].t;
  EXPECT_TRUE(judgeStampJitter(stage, {}).empty());
}

TEST(SampleRules, StampsThatJitterAreFoundInTheCornersToo) {
  CameraImuStageResult stage;
  stage.frames.resize(400);
  stage.frame_errors = FrameErrors{0.31, 0.28, 4, 0.1, -0.1, 5e-4};
  const Findings found = judgeStampJitter(stage, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().level, VerdictLevel::kCaution);
  EXPECT_DOUBLE_EQ(found.front().value, 0.5);
  // States take up a part of the shifts.
  EXPECT_NE(found.front().evidence.find("jitter of 0.5 ms at least"), std::string::npos);
  stage.frame_errors->neighbours = 0.9;  // an offset that drifts
  EXPECT_EQ(judgeStampJitter(stage, {}).front().level, VerdictLevel::kGood);
  stage.frame_errors->neighbours = -0.1;
  stage.frame_errors->across = 2;  // frames err in every direction
  EXPECT_EQ(judgeStampJitter(stage, {}).front().level, VerdictLevel::kGood);
}

TEST(SampleRules, FramesThatContradictTheImuAreNotGood) {
  CameraImuStageResult stage;
  EXPECT_TRUE(judgeFramePoses(stage, {}).empty());
  stage.frame_errors = FrameErrors{0.3, std::sqrt(2.0) * 0.2, 1, 1, 0, 0};
  EXPECT_TRUE(judgeFramePoses(stage, {}).empty());  // the noise was not checked
  const auto levelOf = [&](double pose_pixel_sigma) {
    stage.imu_summary.noise.pose_pixel_sigma = pose_pixel_sigma;
    return judgeFramePoses(stage, {}).front().level;
  };
  EXPECT_EQ(levelOf(0.19), VerdictLevel::kGood);
  EXPECT_EQ(levelOf(0.48), VerdictLevel::kCaution);
  EXPECT_EQ(levelOf(2.1), VerdictLevel::kBad);
}

TEST(SampleRules, PosesThatDoNotTellTheirNoiseAreNotJudged) {
  CameraImuStageResult stage;
  stage.frame_errors = FrameErrors{0.3, std::sqrt(2.0) * 0.009, 1, 1, 0, 0};
  stage.imu_summary.noise.gyro.redundancy = 600;
  const Finding f = judgeFramePoses(stage, {}).front();
  EXPECT_EQ(f.level, VerdictLevel::kGood);
  EXPECT_TRUE(f.evidence.starts_with("not judged")) << f.evidence;
}

// As of a simulation: the ratio is to what a detector reaches, and the text says so.
TEST(SampleRules, CornersWithoutNoiseCountAsThoseOfAGoodDetector) {
  CameraImuStageResult stage;
  stage.frame_errors = FrameErrors{0.3, std::sqrt(2.0) * 0.004, 1, 1, 0, 0};
  stage.imu_summary.noise.pose_pixel_sigma = 0.02;
  const Finding f = judgeFramePoses(stage, {}).front();
  EXPECT_DOUBLE_EQ(f.value, 2);
  EXPECT_NE(f.evidence.find("corners have 0.004 px with a free pose for each frame (taken as 0.01 "
                            "px): 2.00 times"),
            std::string::npos)
      << f.evidence;
  stage.frame_errors->free_rmse_px = std::sqrt(2.0) * 0.0101;
  EXPECT_EQ(judgeFramePoses(stage, {}).front().evidence.find("taken as"), std::string::npos);
}

}  // namespace
}  // namespace plumbline

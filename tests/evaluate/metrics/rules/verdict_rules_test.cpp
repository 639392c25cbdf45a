// SPDX-License-Identifier: BSD-3-Clause
// Every rule has its place in the verdict: one thing out of order in a recording that is in order
// otherwise makes that rule's finding, under its subject, and no other.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

/// Both stages in order.
CalibrationRecord bothStages() {
  CalibrationRecord record = test::cameraRecord(0.3, 0.8);
  CameraImuStageResult& stage = record.camera_imu.emplace();
  stage.cameras = record.camera->cameras;
  stage.frames = record.camera->frames;
  stage.residuals = record.camera->residuals;
  stage.summary = record.camera->summary;
  stage.imu.T_SC0.t = {0.03, 0, 0.04};
  stage.imu.time_offsets = {{1e-3}};
  stage.imu.noise.rate_hz = stage.imu_rate_hz = 200;
  stage.imu_summary.gyro_normalised_rms = stage.imu_summary.accel_normalised_rms = 1;
  for (ImuNoiseCheck* check : {&stage.imu_summary.noise.gyro, &stage.imu_summary.noise.accel}) {
    *check = {.expected_rms = 1, .factor = 1, .redundancy = 1000};
  }
  stage.faults.emplace();
  return record;
}

HalvesCheck halvesApart() {
  HalvesBlock block;
  block.chi2 = 40, block.limit = 20, block.parameters = 8;
  return {0, {block}};
}

void reject(std::vector<CornerResidual>& residuals) {
  for (std::size_t i = 0; i < residuals.size(); i += 5) residuals[i].used = false;
}

using Disorder = std::function<void(CameraStageResult&, CameraImuStageResult&)>;

struct RuleCase {
  const char* rule;
  FindingSubject subject;
  Disorder disorder;
};

using Cameras = CameraStageResult;
using Imu = CameraImuStageResult;
constexpr auto kOfCameras = FindingSubject::kCameras;
constexpr auto kOfRecording = FindingSubject::kRecording;
constexpr auto kOfExtrinsics = FindingSubject::kExtrinsics;
constexpr auto kOfNoise = FindingSubject::kImuNoise;

const RuleCase kCameraCases[] = {
    {"Reprojection error of cam0 (cameras)", kOfCameras,
     [](Cameras& c, Imu&) { c.summary.per_camera[0].rmse_px = 1.5; }},
    {"Bias of cam0", kOfCameras,
     [](Cameras& c, Imu&) {
       c.bias = {{"cam0", 0.75, 0.5, 1, 100}};
     }},
    {"Tilt of the views", kOfRecording,
     [](Cameras& c, Imu&) { c.T_FC0 = test::cameraRecord(0.3, 0.3).camera->T_FC0; }},
    {"Principal point of cam0", kOfCameras,
     [](Cameras& c, Imu&) { c.cameras[0].intrinsics.projection[2] = 520; }},
    {"Rejected corners (cameras)", kOfRecording, [](Cameras& c, Imu&) { reject(c.residuals); }},
    {"Unused frames (cameras)", kOfRecording,
     [](Cameras& c, Imu&) { c.summary.corners_offered = 2400; }},
    {"Halves of the recording (cameras)", kOfCameras,
     [](Cameras& c, Imu&) { c.summary.halves = halvesApart(); }},
};

const RuleCase kImuCases[] = {
    {"Reprojection error of cam0 (camera-IMU)", kOfExtrinsics,
     [](Cameras&, Imu& s) { s.summary.per_camera[0].rmse_px = 1.5; }},
    {"Rejected corners (camera-IMU)", kOfRecording, [](Cameras&, Imu& s) { reject(s.residuals); }},
    {"Frames covered by the IMU", kOfRecording,
     [](Cameras&, Imu& s) { s.frames_without_imu = 10; }},
    {"Gaps in the IMU's samples", kOfRecording, [](Cameras&, Imu& s) { s.imu_gaps = 1; }},
    {"Frames without a pose (camera-IMU)", kOfRecording,
     [](Cameras&, Imu& s) { s.frames_without_pose = 10; }},
    {"Spikes of the IMU", kOfRecording, [](Cameras&, Imu& s) { s.screening.spikes.resize(1); }},
    {"Views delivered twice", kOfRecording,
     [](Cameras&, Imu& s) { s.screening.repeated_views.resize(1); }},
    {"Tags with another's id", kOfRecording,
     [](Cameras&, Imu& s) { s.screening.misplaced_tags.resize(1); }},
    {"False corners", kOfRecording, [](Cameras&, Imu& s) { s.screening.false_corners = 40; }},
    {"Frames against the IMU", kOfExtrinsics,
     [](Cameras&, Imu& s) {
       s.frame_errors.emplace().free_rmse_px = 0.3;
       s.imu_summary.noise.pose_pixel_sigma = 1;
     }},
    {"Residuals of the accelerometer over the whole recording", kOfExtrinsics,
     [](Cameras&, Imu& s) { s.imu_summary.accel_normalised_rms = 3; }},
    {"Rate of the IMU", kOfExtrinsics, [](Cameras&, Imu& s) { s.imu_rate_hz = 100; }},
    {"Rate of the IMU for a hand's motion", kOfRecording,
     [](Cameras&, Imu& s) { s.imu.noise.rate_hz = s.imu_rate_hz = 25; }},
    {"Halves of the recording (camera-IMU)", kOfExtrinsics,
     [](Cameras&, Imu& s) { s.summary.halves = halvesApart(); }},
    {"Length of the lever arm", kOfExtrinsics,
     [](Cameras&, Imu& s) {
       s.imu.T_SC0.t = {0, 0.6, 0};
     }},
    {"Size of the time offset", kOfExtrinsics,
     [](Cameras&, Imu& s) { s.imu.time_offsets = {{-0.15}}; }},
    {"Noise density of the gyroscope", kOfNoise,
     [](Cameras&, Imu& s) { s.imu_summary.noise.gyro.factor = 3; }},
    {"Noise density of the accelerometer", kOfNoise,
     [](Cameras&, Imu& s) { s.imu_summary.noise.accel.factor = 3; }},
};

// Of a simulation without noise: 0.003 px is what integrating its samples leaves.
TEST(VerdictRules, CornersWithoutNoiseDoNotAccuseTheImu) {
  CalibrationRecord record = bothStages();
  record.camera_imu->frame_errors.emplace().free_rmse_px = 4e-4;
  record.camera_imu->imu_summary.noise.pose_pixel_sigma = 3e-3;
  EXPECT_EQ(judge(record).level, VerdictLevel::kGood);
}

// A density in degrees is 57 times too large: residuals of segments then say nothing of the
// whole's.
TEST(VerdictRules, ADensityInDegreesIsMendedBeforeTheRecordingIsBlamed) {
  CalibrationRecord record = bothStages();
  ImuNoiseCheck& gyro = record.camera_imu->imu_summary.noise.gyro;
  const auto adviceOf = [&](const char* rule) {
    for (const Finding& f : judge(record).findings) {
      if (f.rule == rule) return f.level == VerdictLevel::kGood ? "good" : f.advice;
    }
    return std::string("absent");
  };
  const char* density = "Noise density of the gyroscope";
  const char* whole = "Residuals of the gyroscope over the whole recording";
  gyro.factor = 0.0136;
  record.camera_imu->imu_summary.gyro_normalised_rms = 3 * gyro.expected_rms * gyro.factor;
  EXPECT_THAT(adviceOf(density), ::testing::HasSubstr("is in degrees, convert it to radians"));
  EXPECT_THAT(adviceOf(whole), ::testing::HasSubstr("Correct the noise density of the gyroscope"));
  gyro.factor = 0.15;  // no unit
  EXPECT_THAT(adviceOf(density), ::testing::Not(::testing::HasSubstr("degrees")));
  gyro.factor = 1;
  record.camera_imu->imu_summary.gyro_normalised_rms = 3 * gyro.expected_rms;
  EXPECT_THAT(adviceOf(whole), ::testing::HasSubstr("a jump of a bias"));
}

void expectItsFindingAlone(const RuleCase& c) {
  CalibrationRecord record = bothStages();
  c.disorder(*record.camera, *record.camera_imu);
  const Verdict verdict = judge(record);
  EXPECT_EQ(verdict.level, VerdictLevel::kCaution) << c.rule;
  for (const Finding& f : verdict.findings) {
    EXPECT_EQ(f.level == VerdictLevel::kGood, f.rule != c.rule) << c.rule << ": " << f.rule;
    if (f.rule == c.rule) {
      EXPECT_EQ(f.subject, c.subject) << c.rule;
    }
  }
}

TEST(VerdictRules, ARecordingInOrderIsGoodThroughout) {
  for (const Finding& f : judge(bothStages()).findings) {
    EXPECT_EQ(f.level, VerdictLevel::kGood) << f.rule << ": " << f.evidence;
  }
}

TEST(VerdictRules, OneThingOutOfOrderMakesItsFindingAlone) {
  for (const RuleCase& c : kCameraCases) expectItsFindingAlone(c);
  for (const RuleCase& c : kImuCases) expectItsFindingAlone(c);
}

}  // namespace
}  // namespace plumbline

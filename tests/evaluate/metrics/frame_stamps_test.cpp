// SPDX-License-Identifier: BSD-3-Clause
// Frames that only a wide tolerance makes, told by the verdict.
#include <string>

#include "calibrator/base/frames.h"
#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using test::cameraRecord;
using test::levelOf;

/// Two cameras, 40 views each, the second's stamps later than the first's by what `apart` tells.
template <class Apart>
Session sessionOfStamps(Apart apart) {
  Session session;
  session.cameras.resize(2);
  for (int f = 0; f < 40; ++f) {
    const TimeNs t = f * 1'000'000'000LL;
    session.cameras[0].views.push_back({t, {}});
    session.cameras[1].views.push_back({t + apart(f), {}});
  }
  return session;
}

/// 40 frames under that tolerance, of the camera stage or of a camera-IMU stage alone.
Verdict verdictOfFrames(const Session& session, TimeNs tolerance, bool cameras_given = false) {
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  const FrameOptions pairing{tolerance, 0};
  const std::vector<Frame> frames = pairFrames(session.cameras, pairing);
  EXPECT_EQ(frames.size(), 40U);
  record.camera->frames = frames;
  if (cameras_given) {
    record.camera.reset();
    record.camera_imu = CameraImuStageResult();
    record.camera_imu->frames = frames;
  }
  return judge(record, {}, &session, pairing);
}

/// Stamps differ by so much, to and fro.
Verdict verdictOfStamps(TimeNs apart, TimeNs tolerance) {
  return verdictOfFrames(sessionOfStamps([&](int f) { return f % 2 == 0 ? apart : -apart; }),
                         tolerance);
}

TEST(FrameStamps, ThatOnlyAWideToleranceMakesAreTold) {
  const Verdict wide = verdictOfStamps(20'000'000, 25'000'000);
  EXPECT_EQ(levelOf(wide, "Views of a frame"), VerdictLevel::kCaution);
  EXPECT_THAT(wide.findings.back().evidence, ::testing::HasSubstr("in 40 of 40 frames"));
  EXPECT_DOUBLE_EQ(wide.findings.back().value, 20);
  for (const Finding& finding : verdictOfStamps(1'500'000, 25'000'000).findings) {
    EXPECT_EQ(finding.rule.find("Views of a frame"), std::string::npos);
  }
}

TEST(FrameStamps, OfGivenCamerasAreToldToo) {
  const Session session =
      sessionOfStamps([](int f) { return f % 2 == 0 ? 20'000'000 : -20'000'000; });
  const Verdict verdict = verdictOfFrames(session, 25'000'000, true);
  EXPECT_EQ(levelOf(verdict, "Views of a frame"), VerdictLevel::kCaution);
  EXPECT_THAT(verdict.findings.back().advice, ::testing::HasSubstr("the camera-IMU stage"));
}

// The second camera is triggered by the first one's clock, 10 ms later; a quarter of its stamps are
// late by 8 ms more.
TEST(FrameStamps, AConstantShiftDoesNotCountAsViewsThatAreApart) {
  const Session session =
      sessionOfStamps([](int f) { return f % 4 == 0 ? 18'000'000 : 10'000'000; });
  const Verdict verdict = verdictOfFrames(session, 25'000'000);
  EXPECT_EQ(levelOf(verdict, "Views of a frame"), VerdictLevel::kCaution);
  EXPECT_THAT(verdict.findings.back().evidence, ::testing::HasSubstr("in 10 of 40 frames"));
  EXPECT_DOUBLE_EQ(verdict.findings.back().value, 8);
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// EuRoC's imu_april, on which the camera stage never says stop: both stages are replayed, and
// judged.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/replay/replay_session.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

ReplayRecord replayOfEuroc(double stop_reprojection_px) {
  const std::string data = PLUMBLINE_SHARED_DATA;
  EXPECT_TRUE(std::filesystem::is_directory(data))
      << data << " is missing: configure with -DPLUMBLINE_SHARED_DATA=FOLDER";
  ReplayRequest request;
  request.load.session = data + "/euroc_imu_april";
  request.guide.trajectories.stop_reprojection_px = stop_reprojection_px;
  request.camera.threads = request.guide.threads = 2;
  return replaySession(request, [](const std::string&, double) {});
}

TEST(ReplayOfEuroc, PlaysBothStagesAndJudgesTheirStops) {
  const ReplayRecord record = replayOfEuroc(1);
  ASSERT_EQ(record.stages.size(), 2U);
  ASSERT_EQ(record.stop_audits.size(), 2U);
  EXPECT_TRUE(record.stages[0].ended);
  EXPECT_THAT(record.stop_audits[0].explanation, HasSubstr("ended at half of it, 36.0 s"));
  const StopAudit& stop = record.stop_audits[1];
  EXPECT_TRUE(record.stages[1].ran);
  ASSERT_TRUE(stop.finished) << stop.explanation;
  EXPECT_NE(stop.verdict, StopAudit::Verdict::kNotJudged);
  EXPECT_LT(*stop.predicted_px, 1);
  EXPECT_GT(*stop.measured_px, 0);
  EXPECT_EQ(record.decisions.size(), record.frames.size());
}

}  // namespace
}  // namespace plumbline

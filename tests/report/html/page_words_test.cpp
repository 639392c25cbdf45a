// SPDX-License-Identifier: BSD-3-Clause
// The words and rows that pages are made of, by records made up by hand.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/html/page.h"

namespace plumbline::html_internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> lines(const std::vector<Pair>& rows) {
  std::vector<std::string> texts;
  for (const Pair& row : rows) texts.push_back(row.label + ": " + row.value);
  return texts;
}

TEST(ProvenanceRows, LeaveOutWhatIsNotKnown) {
  Provenance p;
  p.version = "1.2";
  p.input = "calib_1";
  p.options = {{"stride", "2"}, {"only", "cam0"}};
  EXPECT_THAT(lines(provenanceRows(p)),
              ElementsAre("Plumbline: 1.2", "Input: calib_1", "Options: stride = 2, only = cam0"));
}

TEST(AssumptionRows, HaveGravityAndNoiseOfAnImuAlone) {
  Assumptions a;
  a.pixel_sigma_px = 0.25;
  a.loss = "cauchy:1";
  EXPECT_THAT(lines(assumptionRows(a)),
              ElementsAre("Corner noise: 0.25 px per coordinate", "Loss: cauchy:1"));
  a.gravity_m_s2 = 9.75;
  a.imu_noise = ImuNoise{0.5, 0.25, 0.125, 0.0625, 200};
  EXPECT_THAT(
      lines(assumptionRows(a)),
      ElementsAre("Corner noise: 0.25 px per coordinate", "Loss: cauchy:1",
                  "Gravity: 9.75 m/s\u00b2",
                  "Gyroscope noise: 0.5 rad/s/\u221aHz, walk 0.25 rad/s\u00b2/\u221aHz",
                  "Accelerometer noise: 0.125 m/s\u00b2/\u221aHz, walk 0.0625 m/s\u00b3/\u221aHz"));
}

TEST(CalibrationRows, SayWhatWasDetectedOfWhichTarget) {
  CalibrationRecord record;
  record.target.rows = 5;
  record.target.cols = 7;
  record.target.tag_size = 0.0885;
  record.target.spacing = 0.25;
  record.counts = {{20, 18, 51840, 12960}, {20, 0, 0, 0}};
  EXPECT_THAT(
      lines(calibrationRows(record)),
      ElementsAre("Target: AprilGrid 5 \u00d7 7 tags of 88.5 mm, spacing 0.25",
                  "Detections of camera 0: target in 18 of 20 views, 12\u2009960 tags, 51\u2009840 "
                  "corners",
                  "Detections of camera 1: target in 0 of 20 views, 0 tags, 0 corners"));
  record.held = HeldCalibration{"rig.yaml", {}};
  EXPECT_EQ(calibrationRows(record).front().value, "rig.yaml: scored, not estimated here");
}

TEST(GroupOf, ParametersStandWithTheirOwner) {
  EXPECT_EQ(groupOf("cam0.fu"), "Intrinsics of cam0");
  EXPECT_EQ(groupOf("T_left.k1"), "Intrinsics of T_left");
  EXPECT_EQ(groupOf("T_C0C2.tx"), "Camera 2 in camera 0 (T_C0C2)");
  EXPECT_EQ(groupOf("T_SC0.rx"), groupOf("time_offset"));
}

// t_imu = t_i + t_d,i = (t_i + shift) + t_d,0.
TEST(UnlikeOffsetsText, StampsAreMovedByTheDifferenceToCamera0) {
  std::vector<CameraCalibration> cameras(3);
  for (std::size_t i = 0; i < 3; ++i) cameras[i].name = "cam" + std::to_string(i);
  ImuCalibration imu;
  imu.time_offsets = {{0.010}, {0.007, true}, {0.0105, true}};
  EXPECT_THAT(unlikeOffsetsText(cameras, imu),
              AllOf(HasSubstr("the offset of cam0"),
                    HasSubstr("add -3 ms to the image stamps of cam1, add 500 \u00b5s to the image "
                              "stamps of cam2")));
  imu.time_offsets = {{0.010}};
  EXPECT_EQ(unlikeOffsetsText(cameras, imu), "");
}

TEST(Sections, WithoutContentHaveNoBlocks) {
  const Section empty{"id", "Title", ""};
  EXPECT_TRUE(withTable(empty, {{words("A")}}).blocks.empty());
  EXPECT_EQ(withTable(empty, {{words("A")}, {{words("a")}}}).blocks.size(), 1U);
  EXPECT_TRUE(withFigures(empty, {{"", "a caption alone"}}).blocks.empty());
  const Section drawn = withFigures(empty, {{"", "none"}, {"<svg/>", "one"}});
  ASSERT_EQ(drawn.blocks.size(), 1U);
  EXPECT_EQ(drawn.blocks[0].figures.size(), 1U);
}

}  // namespace
}  // namespace plumbline::html_internal

// SPDX-License-Identifier: BSD-3-Clause
// The words and rows that pages are made of, by records made up by hand.
#include <algorithm>
#include <cmath>
#include <numbers>
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
using ::testing::Not;

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

Verdict verdictOf(const std::vector<Finding>& findings) {
  Verdict verdict;
  verdict.findings = findings;
  for (const Finding& f : findings) verdict.level = std::max(verdict.level, f.level);
  return verdict;
}

/// The page of nothing but a verdict.
std::string pageOf(const std::vector<Finding>& findings, const std::string& good_word = "good") {
  const Provenance provenance;
  Page page{"", "", provenance, verdictOf(findings), {}, {}, {}};
  page.good_word = good_word;
  return renderPage(page);
}

TEST(VerdictOfAPage, ASubjectHasItsWorstFindingAndNoneWhereItWasNotJudged) {
  const auto good = VerdictLevel::kGood, bad = VerdictLevel::kBad;
  Finding cameras{"a", good}, more{"b", bad}, noise{"c", VerdictLevel::kCaution}, all{"d", bad};
  cameras.subject = more.subject = FindingSubject::kCameras;
  noise.subject = FindingSubject::kImuNoise;
  EXPECT_THAT(
      pageOf({more, cameras, noise, all}),
      AllOf(HasSubstr("</span>cameras: bad<"), HasSubstr("</span>extrinsics and time: not judged<"),
            HasSubstr("</span>IMU noise: caution<"), HasSubstr("</span>recording: not judged<")));
  EXPECT_THAT(pageOf({all}), Not(HasSubstr("class=\"chip\""))) << "the badge says all";
}

// Findings are written for terminals. What only looks like a unit stays.
TEST(VerdictOfAPage, HasTheSignsOfPrint) {
  Finding f{"delay", VerdictLevel::kCaution, "0.2 deg (+- 0.1) and 5 us in m/s^2, 4.2 sigma"};
  f.value = 3;
  f.unit = "sigma";
  f.advice = "turn by degrees; let us know; run with a 2 sigmatisme";
  EXPECT_THAT(pageOf({f}),
              AllOf(HasSubstr("0.2 \u00b0 (\u00b1 0.1) and 5 \u00b5s in m/s\u00b2, 4.2 \u03c3<"),
                    HasSubstr(">3 \u03c3<"), HasSubstr("turn by degrees; let us know"),
                    HasSubstr("2 sigmatisme")));
}

TEST(VerdictOfAPage, CountsHaveNoExponent) {
  Finding f{"views", VerdictLevel::kGood};
  f.value = 1416;
  f.threshold = 20;
  f.unit = "1";
  EXPECT_THAT(pageOf({f}), AllOf(HasSubstr(">1416<"), HasSubstr(">20<")));
  f.unit = "s";
  f.value = 12345.6;
  EXPECT_THAT(pageOf({f}), AllOf(HasSubstr(">12346 s<"), HasSubstr(">20 s<")));
}

// One cell over both rows where columns are beside each other, and a cell in each where a narrow
// window puts them below each other.
TEST(VerdictOfAPage, AdviceThatRulesShareIsInEveryRow) {
  Finding gyro{"gyroscope", VerdictLevel::kCaution}, accel{"accelerometer", VerdictLevel::kCaution};
  gyro.advice = accel.advice = "raise it";
  const std::string page = pageOf({gyro, accel});
  EXPECT_THAT(
      page,
      AllOf(HasSubstr("<td class=\"advice\" rowspan=\"2\" data-name=\"what to do:\">raise it<"),
            HasSubstr("<td class=\"advice again\" data-name=\"what to do:\">raise it<")));
  EXPECT_THAT(pageOf({gyro}), Not(HasSubstr("class=\"advice again\"")));
}

TEST(VerdictOfAPage, CountsTheRulesThatAreMet) {
  const Finding good{"met", VerdictLevel::kGood}, doubt{"doubt", VerdictLevel::kCaution};
  EXPECT_THAT(pageOf({good, doubt, good}),
              AllOf(HasSubstr("<span class=\"badge\">Caution</span>"),
                    HasSubstr("2 of 3 rules are met"), HasSubstr("<td class=\"rule\">doubt</td>")));
  EXPECT_THAT(pageOf({good}), AllOf(HasSubstr("<span class=\"badge\">Good</span>"),
                                    HasSubstr("1 of 1 rules are met")));
  // A word of its own praises nothing.
  EXPECT_THAT(pageOf({good}, "complete"),
              AllOf(HasSubstr("<span class=\"badge\">Complete</span>"), HasSubstr("neutral")));
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

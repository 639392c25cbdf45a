// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/parameters.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/compare/parameters.h"
#include "tests/evaluate/compare/compared_rigs.h"

namespace plumbline {
namespace {

using test::moved;
using test::stereo;

const ComparedParameter& row(const std::vector<ComparedParameter>& rows, const std::string& name) {
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const ComparedParameter& r) { return r.name == name; });
  EXPECT_NE(found, rows.end()) << name;
  return *found;
}

TEST(ComparedParameters, TheSameCalibrationHasNoDifference) {
  for (const ComparedParameter& r : comparedParameters({stereo(), stereo()})) {
    ASSERT_EQ(r.values.size(), 2u);
    EXPECT_FALSE(r.difference[0].has_value());
    ASSERT_TRUE(r.difference[1].has_value()) << r.name;
    EXPECT_LT(std::abs(*r.difference[1]), 1e-15) << r.name;  // Log(R Rt) rounds
  }
}

TEST(ComparedParameters, DifferencesAreThoseThatWereMade) {
  const auto rows = comparedParameters({stereo(), moved()});
  EXPECT_NEAR(*row(rows, "cam0.fu").difference[1], 0.5, 1e-12);
  EXPECT_NEAR(*row(rows, "T_C0C1.tz").difference[1], 4e-4, 1e-15);
  EXPECT_NEAR(*row(rows, "T_C0C1.lever").difference[1], 5e-4, 1e-12);
  EXPECT_NEAR(*row(rows, "T_C0C1.angle").difference[1], 0, 1e-12);
  EXPECT_NEAR(*row(rows, "T_SC0.rz").difference[1], 1e-3, 1e-12);
  EXPECT_NEAR(*row(rows, "T_SC0.angle").difference[1], 1e-3, 1e-12);
  EXPECT_NEAR(*row(rows, "time_offset").difference[1], -2e-4, 1e-15);
}

TEST(ComparedParameters, TheOrderOnlyFlipsSigns) {
  const auto forth = comparedParameters({stereo(), moved()});
  const auto back = comparedParameters({moved(), stereo()});
  ASSERT_EQ(forth.size(), back.size());
  for (std::size_t i = 0; i < forth.size(); ++i) {
    const bool norm = forth[i].name.ends_with(".angle") || forth[i].name.ends_with(".lever");
    EXPECT_EQ(forth[i].name, back[i].name);
    EXPECT_NEAR(*forth[i].difference[1], (norm ? 1 : -1) * *back[i].difference[1], 1e-15)
        << forth[i].name;
  }
}

TEST(ComparedParameters, CamerasHaveTheNamesThatAllCalibrationsGiveThem) {
  Calibration one = stereo(), other = moved();
  one.cameras = {one.cameras[1]};
  other.cameras = {other.cameras[1]};
  EXPECT_EQ(comparedParameters({one, other})[0].name, "cam1.fu");
  other.cameras[0].name = "right";  // of another file: only the place is common
  EXPECT_EQ(comparedParameters({one, other})[0].name, "cam0.fu");
}

TEST(ComparedParameters, CamerasHaveTheirNamesAlsoWhereOneCalibrationHasNotAll) {
  Calibration a = stereo(), b = stereo();
  a.cameras[1].name = "cam2";
  b.cameras.pop_back();
  a.imu->time_offsets = {{1e-3}, {3e-3, true}};
  const auto rows = comparedParameters({a, b});
  const auto has = [&](const std::string& name) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const ComparedParameter& r) { return r.name == name; });
  };
  EXPECT_TRUE(has("cam2.fu"));
  EXPECT_TRUE(has("time_offset.cam2"));
}

TEST(ComparedParameters, SignificanceNeedsBothDeviations) {
  Calibration a = stereo(), b = moved();
  a.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.3);
  EXPECT_FALSE(row(comparedParameters({a, b}), "cam0.fu").significance[1].has_value());
  b.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.4);
  EXPECT_NEAR(*row(comparedParameters({a, b}), "cam0.fu").significance[1], 0.5 / 0.5, 1e-12);
}

// A deviation from four degrees of freedom is uncertain itself: three of it are exceeded as often
// as two of a known one. P(|T_4| > 3) = 0.03994 (tables of Student's t), the normal's at 2.0543.
TEST(ComparedParameters, FewDegreesOfFreedomLowerTheSignificance) {
  Calibration a = stereo(), b = stereo();
  b.cameras[0].intrinsics.projection[0] += 0.9;
  a.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0);
  b.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.3);
  EXPECT_NEAR(*row(comparedParameters({a, b}), "cam0.fu").significance[1], 3, 1e-12);
  b.cameras[0].intrinsics_dof = Eigen::VectorXd::Constant(8, 4);
  const auto fu = row(comparedParameters({a, b}), "cam0.fu");
  EXPECT_NEAR(*fu.significance[1], 2.0543, 1e-4);
  EXPECT_EQ(fu.levels[1], VerdictLevel::kCaution);
  EXPECT_FALSE(fu.dof[0].has_value());
  EXPECT_EQ(fu.dof[1], 4);
  // Where all are formal no row has degrees of freedom.
  EXPECT_TRUE(row(comparedParameters({a, b}), "T_SC0.tx").dof.empty());
}

TEST(ComparedParameters, StatedDeviationsTakeThePlaceOfOthersWhereABlockIsWhole) {
  Calibration c = stereo();
  c.cameras[0].name = "left";
  c.imu->T_SC0_std = Vector6d::Constant(1);
  StatedDeviations stated = {{"time_offset", {2e-4, 6}}, {"T_SC0.tx", {3e-3, 5}}};
  for (const ParameterName& p : cameraParameters(c.cameras)) stated[p.name] = {0.25, 4};
  const auto list = calibrationParameters(withDeviations(c, stated));
  const auto of = [&](const std::string& name) {
    return *std::find_if(list.begin(), list.end(), [&](const auto& p) { return p.name == name; });
  };
  EXPECT_EQ(of("cam0.fu").std, 0.25);  // stated as left.fu
  EXPECT_EQ(of("cam0.fu").dof, 4);
  EXPECT_EQ(of("T_C0C1.rz").std, 0.25);
  EXPECT_EQ(of("time_offset").std, 2e-4);
  EXPECT_EQ(of("time_offset").dof, 6);
  EXPECT_EQ(of("T_SC0.tx").std, 1);  // five of six are missing
  EXPECT_FALSE(of("T_SC0.tx").dof.has_value());
}

// Significance is a size: it has no sign. From two deviations on a difference is notable, and from
// three on it is named.
TEST(ComparedParameters, SignificanceIsTheSameInEitherDirection) {
  Calibration a = stereo(), b = stereo();
  a.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.3);
  b.cameras[0].intrinsics_std = Eigen::VectorXd::Constant(8, 0.4);
  for (const double change : {1.75, -1.75}) {
    b.cameras[0].intrinsics.projection[0] = a.cameras[0].intrinsics.projection[0] + change;
    const auto fu = row(comparedParameters({a, b}), "cam0.fu");
    EXPECT_NEAR(*fu.significance[1], 3.5, 1e-12) << change;
    EXPECT_EQ(fu.levels[1], VerdictLevel::kBad) << change;
  }
  const ComparisonThresholds thresholds;
  EXPECT_EQ(thresholds.levelOf(1.99), VerdictLevel::kGood);
  EXPECT_EQ(thresholds.levelOf(2), VerdictLevel::kCaution);
  EXPECT_EQ(thresholds.levelOf(2.99), VerdictLevel::kCaution);
  EXPECT_EQ(thresholds.levelOf(3), VerdictLevel::kBad);
}

// A file with one offset for all cameras has it for those that it has, and no other.
TEST(ComparedParameters, ACameraThatAFileLacksHasNoOffsetThere) {
  Calibration b = stereo();
  b.imu->time_offsets = {{1e-3}, {3e-3, true}};
  Calibration mono = stereo();
  mono.cameras.resize(1);
  const auto rows = comparedParameters({b, mono});
  EXPECT_TRUE(row(rows, "time_offset.cam0").values[1].has_value());
  EXPECT_FALSE(row(rows, "time_offset.cam1").values[1].has_value());
  // The common one is the mean over cameras, in summaries as well.
  EXPECT_NEAR(*row(rows, "time_offset").values[0], 2e-3, 1e-15);
  EXPECT_NEAR(offsetSummary("b", b).time_offset_s.value(), 2e-3, 1e-15);
  EXPECT_EQ(offsetSummary("b", b).per_camera_s.size(), 2U);
  EXPECT_TRUE(offsetSummary("mono", mono).per_camera_s.empty());
}

TEST(ComparedParameters, AnotherModelHasValuesButNoDifference) {
  Calibration b = stereo();
  b.cameras[1].intrinsics.distortion_model = DistortionModel::kFov;
  b.cameras[1].intrinsics.distortion = Eigen::VectorXd::Constant(1, 0.9);
  const auto rows = comparedParameters({stereo(), b});
  EXPECT_TRUE(row(rows, "cam1.fu").values[1].has_value());
  EXPECT_FALSE(row(rows, "cam1.fu").difference[1].has_value());
  EXPECT_FALSE(row(rows, "cam1.k1").values[1].has_value());
  EXPECT_FALSE(row(rows, "cam1.w").values[0].has_value());
  EXPECT_TRUE(row(rows, "cam0.fu").difference[1].has_value());
}

TEST(ComparedParameters, OffsetsOfEachCameraAreMeantTogether) {
  Calibration b = stereo();
  b.imu->time_offsets = {{1e-3}, {3e-3, true}};
  const auto rows = comparedParameters({stereo(), b});
  EXPECT_NEAR(*row(rows, "time_offset").difference[1], 1e-3, 1e-15);
  EXPECT_NEAR(*row(rows, "time_offset.cam1").difference[1], 2e-3, 1e-15);
  EXPECT_NEAR(*row(rows, "time_offset.cam0").difference[1], 0, 1e-15);
  b.imu.reset();
  const auto without = comparedParameters({stereo(), b});
  EXPECT_FALSE(row(without, "T_SC0.tx").difference[1].has_value());
  EXPECT_FALSE(row(without, "T_SC0.angle").difference[1].has_value());
}

TEST(ComparedParameters, AnOffsetThatAFileDoesNotStateHasNoDifference) {
  for (const std::size_t unknown : {0U, 1U}) {
    Calibration a = stereo(), b = moved();
    a.imu->time_offset_std_s = b.imu->time_offset_std_s = 1e-5;
    auto rows = comparedParameters({a, b});
    EXPECT_TRUE(row(rows, "time_offset").significance[1].has_value());
    removeTimeOffset(unknown, rows);
    EXPECT_FALSE(row(rows, "time_offset").values[unknown].has_value());
    EXPECT_TRUE(row(rows, "time_offset").values[1 - unknown].has_value());
    EXPECT_FALSE(row(rows, "time_offset").difference[1].has_value());
    EXPECT_FALSE(row(rows, "time_offset").significance[1].has_value());
    EXPECT_TRUE(row(rows, "T_SC0.rz").difference[1].has_value());
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// What target.yaml and sensor.yaml state against what the corners show.
#include "evaluate/metrics/target_layout.h"

#include <cmath>
#include <string>

#include "tests/evaluate/metrics/verdict_records.h"

namespace plumbline {
namespace {

using test::cameraRecord;
using test::findingOf;

// The record of a camera without distortion at some poses above the grid, as it stands in `truth`,
// with `stated` in its description.
CalibrationRecord gridRecord(const AprilGrid& truth, const AprilGrid& stated) {
  CalibrationRecord record = cameraRecord(0.1, 0.8);
  record.target = stated;
  record.camera->residuals.clear();
  const Intrinsics& k = record.camera->cameras[0].intrinsics;
  for (int f = 0; f < 40; ++f) {
    const Eigen::Matrix3d R =
        expSO3(Eigen::Vector3d(0.3 * std::sin(f), 0.4 * std::cos(f), 0.05 * f));
    for (int id = 0; id < truth.cornerCount(); ++id) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p.head<2>() = truth.corner(id) - 0.5 * Eigen::Vector2d(truth.width(), truth.height());
      p = R * p + Eigen::Vector3d(0, 0, 0.8);
      const Eigen::Vector2d uv = 450 * p.head<2>() / p.z() + k.projection.tail<2>();
      record.camera->residuals.push_back({0, f, id, uv.cast<float>(), {0.1F, 0.0F}, true});
    }
  }
  return record;
}

TEST(TargetLayout, SpacingOfTheTagsIsMeasured) {
  AprilGrid truth;
  const std::string rule = "Spacing of the target's tags";
  EXPECT_LT(findingOf(judge(gridRecord(truth, truth)), rule).value, 1e-4);
  AprilGrid stated = truth;
  stated.spacing = 0.28;
  const Finding caution = findingOf(judge(gridRecord(truth, stated)), rule);
  EXPECT_NEAR(caution.value, 0.3 / 0.28 - 1, 1e-4);
  EXPECT_EQ(caution.level, VerdictLevel::kCaution);
  stated.spacing = 0.25;
  EXPECT_EQ(findingOf(judge(gridRecord(truth, stated)), rule).level, VerdictLevel::kBad);
}

TEST(TargetLayout, RowsThatNeverShowedAreCounted) {
  AprilGrid truth;
  AprilGrid stated = truth;
  const std::string rule = "Rows of the target";
  EXPECT_EQ(findingOf(judge(gridRecord(truth, stated)), rule).level, VerdictLevel::kGood);
  stated.rows = 8;
  const Finding finding = findingOf(judge(gridRecord(truth, stated)), rule);
  EXPECT_EQ(finding.level, VerdictLevel::kCaution);
  EXPECT_EQ(finding.value, 2);
  EXPECT_NE(finding.evidence.find("largest tag id 35 of 47"), std::string::npos)
      << finding.evidence;
}

TEST(TargetLayout, ColumnsThatAreNotThoseShowOutOfLine) {
  AprilGrid truth;
  const auto layoutAt = [&](int cols) {
    AprilGrid stated = truth;
    stated.cols = cols;
    const CalibrationRecord record = gridRecord(truth, stated);
    return shownLayout(record.camera->residuals, record.camera->cameras, stated);
  };
  EXPECT_EQ(layoutAt(6).pairs_in_line, layoutAt(6).pairs_above);
  EXPECT_GT(layoutAt(6).pairs_above, 1000);
  for (const int cols : {5, 7}) {
    EXPECT_LT(10 * layoutAt(cols).pairs_in_line, layoutAt(cols).pairs_above) << cols;
    EXPECT_GT(layoutAt(cols).pairs_above, 500) << cols;
    EXPECT_NEAR(*layoutAt(cols).spacing, 0.3, 1e-4) << cols;  // not blamed for it
  }
}

TEST(TargetLayout, ResolutionLargerThanTheImageIsSeenByTheEmptyStrip) {
  const std::string rule = "Resolution of cam0";
  CalibrationRecord record = cameraRecord(0.3, 0.8);
  for (CornerResidual& r : record.camera->residuals) {
    r.uv = {(r.uv.x() - 50) * 790 / 700 + 5, (r.uv.y() - 50) * 590 / 500 + 5};
  }
  EXPECT_EQ(findingOf(judge(record), rule).level, VerdictLevel::kGood);
  record.camera->cameras[0].intrinsics.resolution = {880, 600};
  const Finding finding = findingOf(judge(record), rule);
  EXPECT_EQ(finding.level, VerdictLevel::kCaution);
  EXPECT_NEAR(finding.value, (879.0 - 795) / 880, 1e-6);
  // Corners that end early around an optical centre in the middle: coverage, not resolution.
  record.camera->cameras[0].intrinsics.projection[2] = 440;
  EXPECT_EQ(findingOf(judge(record), rule).level, VerdictLevel::kGood);
}

}  // namespace
}  // namespace plumbline

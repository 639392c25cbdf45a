// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a calibration's file that every reader shares: rigid transforms and resolutions.
#include "datasets/calibration/calibration_fields.h"

#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

class CalibrationFields : public testing::Test {
 protected:
  YamlMap load(const std::string& text) const {
    return YamlMap::load(folder_.write("file.yaml", text), "a mapping");
  }
  std::optional<InputFault> faultOfTransform(const std::string& rows) const {
    const YamlMap map = load("T: " + rows + "\n");
    return faultOf([&] { (void)transformField(map, "T"); });
  }
  TemporaryFolder folder_;
};

// 30 degrees about z, to four decimals: cos = 0.8660, sin = 0.5.
TEST_F(CalibrationFields, ARoundedRotationBecomesTheNearestRotation) {
  const Transform T = transformField(
      load("T: [[0.8660, -0.5, 0, 1], [0.5, 0.8660, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]\n"), "T");
  EXPECT_LT((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_LT((T.R - expSO3({0, 0, 30 * kDegree})).norm(), 1e-4);
  EXPECT_EQ(T.t, Eigen::Vector3d(1, 2, 3));
}

// OpenCV's dialect stores a matrix row by row.
TEST_F(CalibrationFields, AnOpencvMatrixIsReadRowByRow) {
  const Transform T = transformField(
      load("T: {rows: 4, cols: 4, data: [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]}\n"),
      "T");
  EXPECT_EQ(T.t, Eigen::Vector3d(1, 2, 3));
  EXPECT_LT((T.R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST_F(CalibrationFields, WhatIsNoRigidTransformIsRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"mirrored", "[[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"},
      {"scaled by 1 %", "[[1.01, 0, 0, 0], [0, 1.01, 0, 0], [0, 0, 1.01, 0], [0, 0, 0, 1]]"},
      {"sheared", "[[1, 0.01, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"},
      {"transposed", "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0.1, 0.2, 0.3, 1]]"},
      {"without its last row", "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]"},
      {"of three columns", "[[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]"},
  };
  for (const auto& [name, rows] : cases) {
    EXPECT_EQ(faultOfTransform(rows), InputFault::kNotRigid) << name;
  }
}

TEST_F(CalibrationFields, AResolutionIsTwoWholeNumbersOfPixels) {
  const YamlMap good = load("resolution: [1, 65535]\n");
  EXPECT_EQ(resolutionField(good, "resolution"), (Resolution{1, 65535}));
  for (const char* bad :
       {"[640.5, 480]", "[640, 480.25]", "[0, 480]", "[640, 65536]", "[640]", "[640, 480, 3]"}) {
    const YamlMap map = load(std::string("a: 1\nresolution: ") + bad + "\n");
    const auto refusal = refusalOf([&] { (void)resolutionField(map, "resolution"); });
    ASSERT_TRUE(refusal) << bad;
    EXPECT_EQ(refusal->line(), 2);
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a calibration's file that every reader shares: rigid transforms and resolutions.
#include "datasets/calibration/calibration_fields.h"

#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
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

// ---- our own calibration.json

class OurCalibration : public testing::Test {
 protected:
  /// The fault of the example with its first `from` behind `after` replaced.
  std::optional<BadInput> refusalWith(const std::string& after, const std::string& from,
                                      const std::string& to) const {
    std::ifstream file(PLUMBLINE_SOURCE_DIR "/third_party_configs/source/calibration.json");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::size_t at = text.find(from, text.find(after));
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const std::string path = folder_.write("calibration.json", text);
    return refusalOf([&] { (void)readCalibration(path); });
  }
  TemporaryFolder folder_;
};

TEST_F(OurCalibration, ContradictionsNameTheirLine) {
  const struct {
    const char* after;
    const char* from;
    const char* to;
    int line;
    InputFault code;
  } cases[] = {
      {"{", "\"schema\": 1", "\"schema\": 2", 2, InputFault::kUnknownFile},
      // Camera 0 is the reference of all places, its own too.
      {"cam0", "[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0, 0.1]", 12, InputFault::kContradiction},
      {"cam0", "\"name\": \"cam1\"", "\"name\": \"cam0\"", 20, InputFault::kDuplicate},
      {"cam1", "0.07451284,", "", 26, InputFault::kBadNumber},
      {"cam1", "457.587", "-457.587", 25, InputFault::kOutOfRange},
      {"\"imu\"", "9.80655", "0", 43, InputFault::kOutOfRange},
  };
  EXPECT_FALSE(refusalWith("{", "cam0", "left"));
  for (const auto& c : cases) {
    const auto refusal = refusalWith(c.after, c.from, c.to);
    ASSERT_TRUE(refusal) << c.to;
    EXPECT_EQ(refusal->code(), c.code) << refusal->what();
    EXPECT_EQ(refusal->line(), c.line) << refusal->what();
  }
}

}  // namespace
}  // namespace plumbline

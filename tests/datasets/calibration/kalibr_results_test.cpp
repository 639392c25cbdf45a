// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's results in words, of both tools.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

std::optional<BadInput> refusalOfText(std::string text, const std::string& from,
                                      const std::string& to) {
  const TemporaryFolder folder;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const std::string path = folder.write("results.txt", text);
  return refusalOf([&] { (void)readKalibrResults(path); });
}

TEST(KalibrResultsText, CameraToolsErrorsPerAxisGiveTheRms) {
  const TemporaryFolder folder;
  const KalibrResults text = readKalibrResults(folder.write("anything", kCamText));
  EXPECT_EQ(text.tool, KalibrResults::Tool::kCameras);
  ASSERT_EQ(text.cameras.size(), 2U);
  EXPECT_EQ(text.cameras[0].rostopic, "/left");
  ASSERT_EQ(text.cameras[0].projection.size(), 6);  // over two lines
  EXPECT_EQ(text.cameras[0].projection(5), 240);
  EXPECT_EQ(text.cameras[0].projection_std(5), 0.4);
  EXPECT_EQ(text.cameras[0].distortion.size(), 0);
  EXPECT_DOUBLE_EQ(*text.cameras[0].rmsPx(), 1.3);  // sqrt(.09 + .16 + 1.44 + 0)
  EXPECT_DOUBLE_EQ(*text.cameras[1].rmsPx(), 0.5);
  EXPECT_FALSE(text.noise);
}

TEST(KalibrResultsText, ABaselinesQuaternionIsScalarLastAndConjugate) {
  const TemporaryFolder folder;
  const KalibrResults text = readKalibrResults(folder.write("anything", kCamText));
  ASSERT_TRUE(text.cameras[1].T_cn_cnm1);
  const Transform expected(expSO3({0, 0, std::acos(0.0)}), {-0.1, 0, 0.02});
  EXPECT_LT(boxminus(*text.cameras[1].T_cn_cnm1, expected).norm(), 1e-7);
}

TEST(KalibrResultsText, OfSeveralImusTheFirstCounts) {
  std::string text = kImuText;
  const std::string second =
      "Gyroscope error (imu1) [rad/s]:     mean 0.3, median 0.2, std: 0.4\n"
      "Accelerometer error (imu1) [m/s^2]: mean 0.6, median 0.5, std: 0.8\n";
  text.insert(text.find("\nTransformation (cam0)"), second);
  const TemporaryFolder folder;
  const KalibrResults results = readKalibrResults(folder.write("anything", text));
  EXPECT_DOUBLE_EQ(results.gyro_rad_s->rms(), 0.005);
  EXPECT_DOUBLE_EQ(results.accel_m_s2->rms(), 0.1);
}

TEST(KalibrResultsText, ImuToolsErrorsTransformsAndNoise) {
  const TemporaryFolder folder;
  const KalibrResults text = readKalibrResults(folder.write("anything", kImuText));
  EXPECT_EQ(text.tool, KalibrResults::Tool::kCameraImu);
  ASSERT_EQ(text.cameras.size(), 1U);
  EXPECT_DOUBLE_EQ(*text.cameras[0].rmsPx(), 0.5);
  EXPECT_DOUBLE_EQ(text.gyro_rad_s->rms(), 0.005);
  EXPECT_DOUBLE_EQ(text.accel_m_s2->rms(), 0.1);
  EXPECT_EQ(text.accel_m_s2->median, 0.05);
  EXPECT_EQ(text.cameras[0].T_cam_imu->t, Eigen::Vector3d(0.05, 0.06, 0.07));
  EXPECT_EQ(text.cameras[0].timeshift_cam_imu, -0.0125);
  EXPECT_EQ(*text.gravity_F, Eigen::Vector3d(0.6, -9.7, 0.8));
  EXPECT_EQ(text.noise->rate_hz, 200);
  EXPECT_EQ(text.noise->accel_density, 0.002);
  EXPECT_EQ(text.noise->accel_random_walk, 0.003);
  EXPECT_EQ(text.noise->gyro_density, 0.00017);
  EXPECT_EQ(text.noise->gyro_random_walk, 2e-5);
}

TEST(KalibrResultsText, OldVersionsPrintNormalisedErrorsAlone) {
  std::string text = kImuText;
  const std::size_t from = text.find("Normalized");
  text.replace(from, text.find("Transformation") - from,
               "Reprojection error squarred (cam0):  mean 0.25, median 0.1, std: 0.5\n"
               "Gyro error squarred (imu0):          mean 1.69, median 0.9, std: 2.0\n"
               "Accelerometer error squarred (imu0): mean 0.04, median 0.02, std: 0.1\n\n");
  const TemporaryFolder folder;
  const KalibrResults old = readKalibrResults(folder.write("anything", text));
  ASSERT_EQ(old.cameras.size(), 1U);
  EXPECT_FALSE(old.cameras[0].rmsPx());
  EXPECT_FALSE(old.gyro_rad_s || old.accel_m_s2);
}

// A camera that saw no target has no error; its transform is there all the same.
TEST(KalibrResultsText, ACameraWithoutCornersHasNoError) {
  std::string text = kImuText;
  for (const char* unit : {"(cam0) [px]:", "(cam0):"}) {
    const std::size_t at = text.find(std::string("Reprojection error ") + unit);
    text.replace(at, text.find('\n', at) - at,
                 std::string("Reprojection error ") + unit + " no corners");
  }
  const TemporaryFolder folder;
  const KalibrResults results = readKalibrResults(folder.write("anything", text));
  ASSERT_EQ(results.cameras.size(), 1U);
  EXPECT_FALSE(results.cameras[0].rmsPx());
  EXPECT_TRUE(results.cameras[0].T_cam_imu);
}

TEST(KalibrResultsText, ACameraWithoutItsTransformIsNamed) {
  // Of two cameras with errors only one has a place.
  const auto refusal = refusalOfText(kImuText, "Transformation (cam0):",
                                     "Reprojection error (cam1) [px]: mean 1, median 1, std: 1\n"
                                     "Transformation (cam0):");
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code(), InputFault::kTruncated);
  EXPECT_THAT(refusal->what(), testing::HasSubstr("cam1's T_ci"));
}

TEST(KalibrResultsText, DivergedResultsAreRefusedByLine) {
  const auto refusal = refusalOfText(kCamText, "[0.3, -0.4]", "[nan, nan]");
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->line(), 10);
  EXPECT_EQ(refusal->code(), InputFault::kNotFinite);
  EXPECT_EQ(refusalOfText(kImuText, "mean 3.0", "mean nan")->code(), InputFault::kNotFinite);
  EXPECT_EQ(refusalOfText(kImuText, "[ 0.  1.  0.  0.05]", "[ nan nan nan nan]")->code(),
            InputFault::kNotFinite);
}

TEST(KalibrResultsText, IsNoCalibrationAndPointsToItsYaml) {
  const TemporaryFolder folder;
  for (const char* text : {kCamText, kImuText}) {
    const auto refusal =
        refusalOf([&] { (void)readCalibration(folder.write("results-cam.txt", text)); });
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->code(), InputFault::kUnknownFile);
    EXPECT_THAT(refusal->what(), testing::HasSubstr("camchain*.yaml of the same run"));
  }
}

TEST(KalibrResultsText, TextsThatEndEarlyAreRefused) {
  const std::pair<const char*, const char*> cuts[] = {{kCamText, "\t reprojection error: [0.0"},
                                                      {kCamText, " 0.4]"},
                                                      {kCamText, "Target conf"},
                                                      {kImuText, "T_ci"},
                                                      {kImuText, "Gravity"},
                                                      {kImuText, "    Random walk: 2e-05"}};
  for (const auto& [text, at] : cuts) {
    const std::string whole = text;
    const auto refusal = refusalOfText(whole, whole.substr(whole.find(at)), "");
    ASSERT_TRUE(refusal) << at;
    EXPECT_EQ(refusal->code(), InputFault::kTruncated) << refusal->what();
  }
  EXPECT_EQ(refusalOfText(kCamText, "Calibration results", "Results")->code(),
            InputFault::kUnknownFile);
}

}  // namespace
}  // namespace plumbline

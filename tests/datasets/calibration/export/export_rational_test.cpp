// SPDX-License-Identifier: BSD-3-Clause
// OpenCV's rational distortion in the tools that have it: each file's numbers, given to OpenCV in
// the order that the tool reads them, meet our pixels.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "datasets/calibration/calibration_reader.h"
#include "tests/datasets/calibration/export/exported_rigs.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

Calibration rationalCamera() {
  return singleCamera(
      ProjectionModel::kPinhole, DistortionModel::kRational, Eigen::Vector4d(450, 455, 370, 250),
      (Eigen::VectorXd(8) << 0.3, -0.05, 0.001, -0.002, 0.004, 0.6, 0.02, 0.003).finished());
}

std::string textFor(ExportTool tool, const std::string& name) {
  return fileText(exportCalibration(rationalCamera(), tool, exportOptions()), name);
}

void expectItsPixels(const std::vector<double>& f, const std::vector<double>& d) {
  ASSERT_EQ(d.size(), 8U);
  const Calibration truth = rationalCamera();
  expectPixels(truth, 0, placeOf(truth, 0).matrix(), f, d);
}

TEST(ExportRational, CameraInfoHasEightCoefficients) {
  const YAML::Node camera = YAML::Load(textFor(ExportTool::kCameraInfo, "cam0.yaml"));
  EXPECT_EQ(camera["distortion_model"].as<std::string>(), "rational_polynomial");
  const auto K = camera["camera_matrix"]["data"].as<std::vector<double>>();
  expectItsPixels({K[0], K[4], K[2], K[5]},
                  camera["distortion_coefficients"]["data"].as<std::vector<double>>());
}

TEST(ExportRational, Okvis2HasEightCoefficients) {
  std::string text = textFor(ExportTool::kOkvis2, "okvis2.yaml");
  text.erase(0, text.find("---"));  // behind OpenCV's own first line
  const YAML::Node camera = YAML::Load(text)["cameras"][0];
  EXPECT_EQ(camera["distortion_type"].as<std::string>(), "radialtangential8");
  auto f = camera["focal_length"].as<std::vector<double>>();
  const auto centre = camera["principal_point"].as<std::vector<double>>();
  f.insert(f.end(), centre.begin(), centre.end());
  expectItsPixels(f, camera["distortion_coefficients"].as<std::vector<double>>());
}

TEST(ExportRational, BasaltNamesItsCoefficients) {
  const std::string text = textFor(ExportTool::kBasalt, "basalt_calib.json");
  const auto camera = nlohmann::json::parse(text)["value0"]["intrinsics"][0];
  EXPECT_EQ(camera["camera_type"], "pinhole-radtan8");
  const auto& k = camera["intrinsics"];
  expectItsPixels({k["fx"], k["fy"], k["cx"], k["cy"]},
                  {k["k1"], k["k2"], k["p1"], k["p2"], k["k3"], k["k4"], k["k5"], k["k6"]});
  const TemporaryFolder folder;
  const Calibration read = readCalibration(folder.write("calibration.json", text));
  EXPECT_EQ(read.cameras[0].intrinsics.distortion,
            rationalCamera().cameras[0].intrinsics.distortion);
}

}  // namespace
}  // namespace plumbline

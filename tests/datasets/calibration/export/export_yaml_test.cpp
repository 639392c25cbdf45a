// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's files through our reader, ROS' camera_info through yaml-cpp (which ROS reads it with).
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/session/imu.h"
#include "tests/datasets/calibration/export/exported_rigs.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

TEST(ExportKalibr, ReadsBack) {
  const Calibration truth = rig("tumvi");
  const auto files = exportCalibration(truth, ExportTool::kKalibr, exportOptions());
  const TemporaryFolder folder;
  const Calibration read =
      readCalibration(folder.write("camchain.yaml", fileText(files, "camchain-imucam.yaml")));
  ASSERT_EQ(read.cameras.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.cameras[i].intrinsics.stacked(), truth.cameras[i].intrinsics.stacked());
    EXPECT_LT(difference(placeOf(truth, i).matrix(), placeOf(read, i)), 1e-12);
  }
  EXPECT_EQ(read.imu->timeOffset(), truth.imu->timeOffset());
  const auto imu = readImuDescription(folder.write("imu.yaml", fileText(files, "imu.yaml")));
  EXPECT_EQ(imu.noise.accel_random_walk, truth.imu->noise.accel_random_walk);
  EXPECT_EQ(imu.noise.gyro_density, truth.imu->noise.gyro_density);
}

Eigen::Matrix4d matrix(const YAML::Node& rows) {
  Eigen::Matrix4d T;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) T(r, c) = rows[r][c].as<double>();
  }
  return T;
}

// By yaml-cpp and OpenCV alone. Kalibr: T_cam_imu maps IMU to camera, T_cn_cnm1 the previous
// camera to this one, t_imu = t_cam + timeshift_cam_imu.
TEST(ExportKalibr, AnIndependentReaderMeetsTheSamePixels) {
  for (const char* name : {"euroc", "tumvi"}) {
    const Calibration truth = rig(name);
    const auto files = exportCalibration(truth, ExportTool::kKalibr, exportOptions());
    const YAML::Node chain = YAML::Load(fileText(files, "camchain-imucam.yaml"));
    Eigen::Matrix4d T_C0S = matrix(chain["cam0"]["T_cam_imu"]);
    for (std::size_t i = 0; i < 2; ++i) {
      const YAML::Node camera = chain["cam" + std::to_string(i)];
      expectPixels(truth, i, matrix(camera["T_cam_imu"]).inverse(),
                   camera["intrinsics"].as<std::vector<double>>(),
                   camera["distortion_coeffs"].as<std::vector<double>>());
      EXPECT_EQ(camera["timeshift_cam_imu"].as<double>(), truth.imu->timeOffset());
    }
    const Eigen::Matrix4d chained = matrix(chain["cam1"]["T_cn_cnm1"]) * T_C0S;
    EXPECT_LT((chained - matrix(chain["cam1"]["T_cam_imu"])).norm(), 1e-12);
    // Flat, as Kalibr reads it.
    const YAML::Node imu = YAML::Load(fileText(files, "imu.yaml"));
    EXPECT_EQ(imu["gyroscope_random_walk"].as<double>(), truth.imu->noise.gyro_random_walk);
    EXPECT_EQ(imu["accelerometer_noise_density"].as<double>(), truth.imu->noise.accel_density);
    EXPECT_EQ(imu["update_rate"].as<double>(), truth.imu->noise.rate_hz);
  }
}

// OpenVINS' files are Kalibr's but for the direction: our reader takes them too.
TEST(ExportOpenVins, IsACalibrationThatWeRead) {
  const Calibration truth = rig("tumvi");
  const auto files = exportCalibration(truth, ExportTool::kOpenVins, exportOptions());
  const TemporaryFolder folder;
  const Calibration read = readCalibration(
      folder.write("kalibr_imucam_chain.yaml", fileText(files, "kalibr_imucam_chain.yaml")));
  ASSERT_EQ(read.cameras.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.cameras[i].intrinsics.stacked(), truth.cameras[i].intrinsics.stacked());
    EXPECT_LT(difference(placeOf(truth, i).matrix(), placeOf(read, i)), 1e-12);
  }
  EXPECT_EQ(read.imu->timeOffset(), truth.imu->timeOffset());
  const auto imu =
      readImuDescription(folder.write("imu.yaml", fileText(files, "kalibr_imu_chain.yaml")));
  EXPECT_EQ(imu.noise.gyro_random_walk, truth.imu->noise.gyro_random_walk);
}

TEST(ExportKalibr, UnknownNoiseIsNotInvented) {
  ExportOptions options = exportOptions();
  options.noise_known = false;
  const auto files = exportCalibration(rig("euroc"), ExportTool::kKalibr, options);
  EXPECT_EQ(files.files.size(), 1U);
  EXPECT_THAT(files.warnings, testing::SizeIs(1));
}

std::vector<double> data(const YAML::Node& node) {
  const auto values = node["data"].as<std::vector<double>>();
  EXPECT_EQ(values.size(), node["rows"].as<std::size_t>() * node["cols"].as<std::size_t>());
  return values;
}

TEST(ExportCameraInfo, PlumbBobHasFiveCoefficients) {
  const Calibration truth = rig("euroc");
  const auto files = exportCalibration(truth, ExportTool::kCameraInfo, exportOptions());
  ASSERT_EQ(files.files.size(), 2U);
  const YAML::Node camera = YAML::Load(fileText(files, "cam1.yaml"));
  const Intrinsics& k = truth.cameras[1].intrinsics;
  const Eigen::VectorXd& f = k.projection;
  EXPECT_EQ(data(camera["camera_matrix"]),
            (std::vector<double>{f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1}));
  EXPECT_EQ(data(camera["projection_matrix"]),
            (std::vector<double>{f[0], 0, f[2], 0, 0, f[1], f[3], 0, 0, 0, 1, 0}));
  EXPECT_EQ(data(camera["rectification_matrix"]), (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(camera["distortion_model"].as<std::string>(), "plumb_bob");
  const Eigen::VectorXd& d = k.distortion;
  EXPECT_EQ(data(camera["distortion_coefficients"]),
            (std::vector<double>{d[0], d[1], d[2], d[3], 0}));
  EXPECT_EQ(camera["camera_name"].as<std::string>(), "cam1");
  EXPECT_EQ(camera["image_width"].as<int>(), 752);
  EXPECT_EQ(camera["image_height"].as<int>(), 480);
}

TEST(ExportCameraInfo, EquidistantHasFour) {
  const Calibration truth = rig("tumvi");
  const auto files = exportCalibration(truth, ExportTool::kCameraInfo, exportOptions());
  const YAML::Node camera = YAML::Load(fileText(files, "cam0.yaml"));
  EXPECT_EQ(camera["distortion_model"].as<std::string>(), "equidistant");
  const Eigen::VectorXd& d = truth.cameras[0].intrinsics.distortion;
  EXPECT_EQ(data(camera["distortion_coefficients"]), (std::vector<double>{d[0], d[1], d[2], d[3]}));
}

TEST(ExportCameraInfo, MeetsTheSamePixels) {
  for (const char* name : {"euroc", "tumvi"}) {
    const Calibration truth = rig(name);
    const auto files = exportCalibration(truth, ExportTool::kCameraInfo, exportOptions());
    for (std::size_t i = 0; i < 2; ++i) {
      const YAML::Node camera = YAML::Load(fileText(files, "cam" + std::to_string(i) + ".yaml"));
      const auto K = data(camera["camera_matrix"]);
      expectPixels(truth, i, placeOf(truth, i).matrix(), {K[0], K[4], K[2], K[5]},
                   data(camera["distortion_coefficients"]));
    }
  }
}

TEST(SelectCameras, TheFirstNamedIsTheNewCamera0) {
  const Calibration truth = rig("euroc");
  const Calibration turned = selectCameras(truth, {"cam1", "cam0"}, "rig.json");
  ASSERT_EQ(turned.cameras.size(), 2U);
  EXPECT_EQ(turned.cameras[0].name, "cam1");
  EXPECT_LT(difference(placeOf(truth, 1).matrix(), placeOf(turned, 0)), 1e-14);
  EXPECT_LT(difference(placeOf(truth, 0).matrix(), placeOf(turned, 1)), 1e-14);
  EXPECT_EQ(turned.cameras[0].T_C0Ci.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(selectCameras(truth, {}, "rig.json").cameras.size(), 2U);
}

// A deviation belongs to what was estimated: of other places and offsets, composed from it, none is
// known here.
TEST(SelectCameras, DeviationsAreKeptOfWhatStaysTheSame) {
  Calibration truth = rig("euroc");
  truth.cameras[1].T_C0Ci_std = truth.imu->T_SC0_std = Vector6d::Constant(1e-3);
  truth.imu->time_offset_std_s = 1e-5;
  const auto chosen = [&](const std::vector<std::string>& names) {
    return selectCameras(truth, names, "rig.json");
  };
  const Calibration same = chosen({"cam0", "cam1"});
  EXPECT_TRUE(same.imu->T_SC0_std && same.cameras[1].T_C0Ci_std && same.imu->time_offset_std_s);
  const Calibration turned = chosen({"cam1", "cam0"});
  EXPECT_FALSE(turned.imu->T_SC0_std || turned.cameras[0].T_C0Ci_std ||
               turned.cameras[1].T_C0Ci_std);
  EXPECT_EQ(turned.imu->time_offset_std_s, 1e-5) << "synchronised cameras have one offset";
  truth.imu->time_offsets = {{0.001}, {0.002, true}};
  EXPECT_FALSE(chosen({"cam1"}).imu->time_offset_std_s) << "that of the camera left out";
}

// t_imu = t_cam1 + t_d1 = (t_cam1 + shift) + t_d0.
TEST(UnlikeTimeOffsets, AreWrittenOrTheShiftIsNamed) {
  Calibration truth = rig("euroc");
  truth.imu->time_offsets = {{truth.imu->timeOffset()}, {truth.imu->timeOffset() + 0.003, true}};
  for (const ExportTool tool : exportTools()) {
    if (tool == ExportTool::kCameraInfo) continue;  // holds no time at all
    const auto files = exportCalibration(truth, tool, exportOptions());
    const bool named = files.files.back().text.find("(3000000 ns)") != std::string::npos ||
                       files.files.front().text.find("(3000000 ns)") != std::string::npos;
    EXPECT_EQ(named, tool != ExportTool::kKalibr) << toString(tool);
  }
  const auto kalibr = exportCalibration(truth, ExportTool::kKalibr, exportOptions());
  const YAML::Node chain = YAML::Load(fileText(kalibr, "camchain-imucam.yaml"));
  EXPECT_EQ(chain["cam1"]["timeshift_cam_imu"].as<double>(), truth.imu->timeOffset() + 0.003);
  const Calibration second = selectCameras(truth, {"cam1"}, "rig.json");
  EXPECT_EQ(second.imu->timeOffset(), truth.imu->timeOffset() + 0.003);
}

TEST(UnlikeTimeOffsets, AreReadFromOurCalibration) {
  std::ifstream file(PLUMBLINE_SOURCE_DIR "/third_party_configs/source/calibration.json");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string imu = "\"imu\": {", offsets = "\"camera_time_offsets_s\": [0.0021, null, 0.5],";
  text.insert(text.find(imu) + imu.size(), offsets);
  const TemporaryFolder folder;
  const Calibration read = readCalibration(folder.write("calibration.json", text));
  EXPECT_FALSE(hasOwnOffset(read.imu->time_offsets, 1));
  EXPECT_EQ(read.imu->timeOffset(1), 0.0021);
  EXPECT_TRUE(hasOwnOffset(read.imu->time_offsets, 2));
  EXPECT_EQ(read.imu->timeOffset(2), 0.5);
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// The files of ORB-SLAM3, OpenVINS, VINS-Fusion and OKVIS2, read back with the parser that those
// tools read them with (cv::FileStorage), and used as those tools use them.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calibrator/camera/camera.h"
#include "tests/datasets/calibration/export/exported_rigs.h"

namespace plumbline {
namespace {

constexpr double kFloat = 1e-6;

cv::FileStorage parsed(const ExportedFiles& files, const std::string& name) {
  return {fileText(files, name), cv::FileStorage::READ | cv::FileStorage::MEMORY};
}

std::vector<double> numbers(const cv::FileNode& node) {
  std::vector<double> values;
  for (const cv::FileNode& value : node) values.push_back(value.real());
  return values;
}

double real(const cv::FileNode& node) {
  EXPECT_TRUE(node.isReal()) << node.name() << " must be written with a decimal point";
  return node.real();
}

Eigen::Matrix4d matrix(const std::vector<double>& values) {
  EXPECT_EQ(values.size(), 16U);
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
}

Eigen::Matrix4d opencvMatrix(const cv::FileNode& node, int type) {
  cv::Mat read = node.mat();
  EXPECT_EQ(read.type(), type);
  cv::Mat1d values;
  read.convertTo(values, CV_64F);
  return matrix({values.begin(), values.end()});
}

Eigen::Matrix4d rows(const cv::FileNode& node) {
  std::vector<double> all;
  for (const cv::FileNode& row : node) {
    for (const double value : numbers(row)) all.push_back(value);
  }
  return matrix(all);
}

// ---- ORB-SLAM3

std::vector<double> orbDistortion(const cv::FileStorage& file, int camera, bool fisheye) {
  const std::string prefix = "Camera" + std::to_string(camera) + ".";
  std::vector<double> d;
  for (const char* key :
       fisheye ? std::vector{"k1", "k2", "k3", "k4"} : std::vector{"k1", "k2", "p1", "p2"}) {
    d.push_back(real(file[prefix + key]));
  }
  return d;
}

void expectOrbCamera(const Calibration& truth, const cv::FileStorage& file, std::size_t i) {
  const std::string prefix = "Camera" + std::to_string(i + 1) + ".";
  const bool fisheye =
      truth.cameras[i].intrinsics.distortion_model == DistortionModel::kEquidistant;
  std::vector<double> f;
  for (const char* key : {"fx", "fy", "cx", "cy"}) f.push_back(real(file[prefix + key]));
  Eigen::Matrix4d T_SCi = placeOf(truth, 0).matrix();  // the file's is float: checked apart
  if (i == 1) T_SCi = T_SCi * truth.cameras[1].T_C0Ci.matrix();
  expectPixels(truth, i, T_SCi, f, orbDistortion(file, static_cast<int>(i) + 1, fisheye));
}

TEST(ExportOrbSlam3, StereoInertialReadsBack) {
  for (const char* name : {"euroc", "tumvi"}) {
    const Calibration truth = rig(name);
    const auto files = exportCalibration(truth, ExportTool::kOrbSlam3, exportOptions());
    const cv::FileStorage file = parsed(files, "orbslam3.yaml");
    EXPECT_EQ(file["File.version"].string(), "1.0");
    EXPECT_EQ(file["Camera.type"].string(),
              name == std::string("tumvi") ? "KannalaBrandt8" : "PinHole");
    for (std::size_t i = 0; i < 2; ++i) expectOrbCamera(truth, file, i);
    EXPECT_LT(difference(opencvMatrix(file["IMU.T_b_c1"], CV_32F), placeOf(truth, 0)), kFloat);
    EXPECT_LT(difference(opencvMatrix(file["Stereo.T_c1_c2"], CV_32F), truth.cameras[1].T_C0Ci),
              kFloat);
    EXPECT_TRUE(file["Camera.fps"].isInt());
    EXPECT_EQ(static_cast<int>(file["Camera.fps"]), 20);
    EXPECT_EQ(static_cast<int>(file["Camera.width"]), truth.cameras[0].intrinsics.resolution.width);
  }
}

TEST(ExportOrbSlam3, NoiseIsTheContinuousDensity) {
  const Calibration truth = rig("d435i");
  const auto files = exportCalibration(truth, ExportTool::kOrbSlam3, exportOptions());
  const cv::FileStorage file = parsed(files, "orbslam3.yaml");
  const ImuNoise& noise = truth.imu->noise;
  EXPECT_EQ(real(file["IMU.NoiseGyro"]), noise.gyro_density);
  EXPECT_EQ(real(file["IMU.NoiseAcc"]), noise.accel_density);
  EXPECT_EQ(real(file["IMU.GyroWalk"]), noise.gyro_random_walk);
  EXPECT_EQ(real(file["IMU.AccWalk"]), noise.accel_random_walk);
  EXPECT_EQ(real(file["IMU.Frequency"]), noise.rate_hz);
}

TEST(ExportOrbSlam3, SaysHowToShiftImagesAndThatCamera2IsMisread) {
  const auto text = [](const Calibration& truth) {
    return fileText(exportCalibration(truth, ExportTool::kOrbSlam3, exportOptions()),
                    "orbslam3.yaml");
  };
  EXPECT_THAT(text(rig("euroc")), testing::HasSubstr("0.0021 s (2100000 ns)"));
  EXPECT_THAT(text(rig("tumvi")), testing::HasSubstr("-0.0037 s (-3700000 ns)"));
  EXPECT_THAT(text(rig("euroc")), testing::HasSubstr("Known fault"));
  Calibration mono = rig("euroc");
  mono.cameras.resize(1);
  EXPECT_THAT(text(mono), testing::Not(testing::HasSubstr("Known fault")));
}

// ---- OpenVINS

void expectOpenVinsCamera(const Calibration& truth, const cv::FileNode& camera, std::size_t i) {
  const Intrinsics& k = truth.cameras[i].intrinsics;
  EXPECT_EQ(camera["distortion_model"].string(), toString(k.distortion_model));
  EXPECT_LT(difference(rows(camera["T_imu_cam"]), placeOf(truth, i)), 1e-15);
  expectPixels(truth, i, rows(camera["T_imu_cam"]), numbers(camera["intrinsics"]),
               numbers(camera["distortion_coeffs"]));
  EXPECT_EQ(real(camera["timeshift_cam_imu"]), truth.imu->timeOffset());
  EXPECT_EQ(numbers(camera["resolution"]),
            (std::vector<double>{1.0 * k.resolution.width, 1.0 * k.resolution.height}));
}

TEST(ExportOpenVins, ReadsBack) {
  for (const char* name : {"euroc", "tumvi"}) {
    const Calibration truth = rig(name);
    const auto files = exportCalibration(truth, ExportTool::kOpenVins, exportOptions());
    const cv::FileStorage cameras = parsed(files, "kalibr_imucam_chain.yaml");
    for (std::size_t i = 0; i < 2; ++i) {
      expectOpenVinsCamera(truth, cameras["cam" + std::to_string(i)], i);
    }
    const cv::FileStorage imu_file = parsed(files, "kalibr_imu_chain.yaml");
    const cv::FileNode imu = imu_file["imu0"];
    EXPECT_EQ(real(imu["gyroscope_noise_density"]), truth.imu->noise.gyro_density);
    EXPECT_EQ(real(imu["gyroscope_random_walk"]), truth.imu->noise.gyro_random_walk);
    EXPECT_EQ(real(imu["accelerometer_noise_density"]), truth.imu->noise.accel_density);
    EXPECT_EQ(real(imu["accelerometer_random_walk"]), truth.imu->noise.accel_random_walk);
    EXPECT_EQ(imu["Tw"].size(), 3U);
    EXPECT_EQ(imu["Tg"].size(), 3U);
  }
}

// ---- VINS-Fusion

TEST(ExportVinsFusion, TransformsOffsetAndGravityReadBack) {
  const Calibration truth = rig("euroc");
  const auto files = exportCalibration(truth, ExportTool::kVinsFusion, exportOptions());
  const cv::FileStorage file = parsed(files, "vins_fusion.yaml");
  for (std::size_t i = 0; i < 2; ++i) {
    const auto T = opencvMatrix(file["body_T_cam" + std::to_string(i)], CV_64F);
    EXPECT_LT(difference(T, placeOf(truth, i)), 1e-15);
    const cv::FileStorage camera = parsed(files, file["cam" + std::to_string(i) + "_calib"]);
    EXPECT_EQ(camera["model_type"].string(), "PINHOLE");
    std::vector<double> f, d;
    for (const char* key : {"fx", "fy", "cx", "cy"}) {
      f.push_back(real(camera["projection_parameters"][key]));
    }
    for (const char* key : {"k1", "k2", "p1", "p2"}) {
      d.push_back(real(camera["distortion_parameters"][key]));
    }
    expectPixels(truth, i, T, f, d);
  }
  EXPECT_EQ(real(file["td"]), truth.imu->timeOffset());
  EXPECT_EQ(real(file["g_norm"]), truth.imu->gravity_m_s2);
}

// Its covariance of a bias after one second, dt^2 acc_w^2 a step, must be the density's; that of a
// sample acc_n^2 must be density^2 times the rate.
TEST(ExportVinsFusion, NoiseIsThatOfASampleAndOfAStep) {
  const Calibration truth = rig("d435i");
  const auto files = exportCalibration(truth, ExportTool::kVinsFusion, exportOptions());
  const cv::FileStorage file = parsed(files, "vins_fusion.yaml");
  const ImuNoise& noise = truth.imu->noise;
  const double rate = noise.rate_hz;
  const auto walk_after_1s = [&](const char* key) {
    return std::sqrt(rate * std::pow(real(file[key]) / rate, 2));
  };
  EXPECT_NEAR(walk_after_1s("acc_w"), noise.accel_random_walk, 1e-15);
  EXPECT_NEAR(walk_after_1s("gyr_w"), noise.gyro_random_walk, 1e-15);
  EXPECT_NEAR(std::pow(real(file["acc_n"]), 2), std::pow(noise.accel_density, 2) * rate, 1e-12);
  EXPECT_NEAR(std::pow(real(file["gyr_n"]), 2), std::pow(noise.gyro_density, 2) * rate, 1e-12);
}

// camodocal: r(theta) = theta + k2 theta^3 + k3 theta^5 + ..., cv::fisheye's k1, k2, ...
TEST(ExportVinsFusion, FisheyeNamesRunOneAhead) {
  const Calibration truth = rig("tumvi");
  const auto files = exportCalibration(truth, ExportTool::kVinsFusion, exportOptions());
  const cv::FileStorage file = parsed(files, "vins_fusion.yaml");
  for (std::size_t i = 0; i < 2; ++i) {
    const cv::FileStorage camera = parsed(files, "cam" + std::to_string(i) + ".yaml");
    EXPECT_EQ(camera["model_type"].string(), "KANNALA_BRANDT");
    const cv::FileNode p = camera["projection_parameters"];
    expectPixels(truth, i, opencvMatrix(file["body_T_cam" + std::to_string(i)], CV_64F),
                 {real(p["mu"]), real(p["mv"]), real(p["u0"]), real(p["v0"])},
                 {real(p["k2"]), real(p["k3"]), real(p["k4"]), real(p["k5"])});
  }
  EXPECT_EQ(real(file["td"]), truth.imu->timeOffset());  // t_imu = t_cam + td
}

// MEI: a point on the unit sphere, moved by xi along the axis, through a pinhole with radtan.
TEST(ExportVinsFusion, OmniIsMei) {
  const Calibration truth =
      singleCamera(ProjectionModel::kOmni, DistortionModel::kRadtan,
                   (Eigen::VectorXd(5) << 1.8, 1100, 1110, 370, 250).finished(),
                   Eigen::Vector4d(-0.1, 0.3, 0.001, -0.002));
  const auto files = exportCalibration(truth, ExportTool::kVinsFusion, exportOptions());
  const cv::FileStorage camera = parsed(files, "cam0.yaml");
  EXPECT_EQ(camera["model_type"].string(), "MEI");
  const double xi = real(camera["mirror_parameters"]["xi"]);
  const cv::FileNode p = camera["projection_parameters"];
  const cv::FileNode d = camera["distortion_parameters"];
  for (const Eigen::Vector3d& p_C : pointsInView()) {
    const Eigen::Vector3d lifted = p_C.normalized() + xi * Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d uv =
        opencvPixel(lifted, {real(p["gamma1"]), real(p["gamma2"]), real(p["u0"]), real(p["v0"])},
                    {real(d["k1"]), real(d["k2"]), real(d["p1"]), real(d["p2"])});
    EXPECT_LT((uv - *project(truth.cameras[0].intrinsics, p_C)).norm(), 1e-9);
  }
}

TEST(ExportVinsFusion, StereoWithoutImuHasCamera0AsBody) {
  Calibration truth = rig("euroc");
  truth.imu.reset();
  const auto files = exportCalibration(truth, ExportTool::kVinsFusion, exportOptions());
  const cv::FileStorage file = parsed(files, "vins_fusion.yaml");
  EXPECT_EQ(static_cast<int>(file["imu"]), 0);
  EXPECT_LT(difference(opencvMatrix(file["body_T_cam1"], CV_64F), truth.cameras[1].T_C0Ci), 1e-15);
}

// ---- OKVIS2

void expectOkvisCamera(const Calibration& truth, const cv::FileNode& camera, std::size_t i) {
  ASSERT_TRUE(camera.isMap());
  const Eigen::Matrix4d T_SC = matrix(numbers(camera["T_SC"]));
  EXPECT_LT(difference(T_SC, placeOf(truth, i)), 1e-15);
  const auto f = numbers(camera["focal_length"]);
  const auto c = numbers(camera["principal_point"]);
  expectPixels(truth, i, T_SC, {f.at(0), f.at(1), c.at(0), c.at(1)},
               numbers(camera["distortion_coefficients"]));
  EXPECT_EQ(camera["slam_use"].string(), "okvis");
}

TEST(ExportOkvis2, ReadsBackWithTheOffsetNegated) {
  for (const char* name : {"euroc", "tumvi"}) {
    const Calibration truth = rig(name);
    const auto files = exportCalibration(truth, ExportTool::kOkvis2, exportOptions());
    const cv::FileStorage file = parsed(files, "okvis2.yaml");
    ASSERT_EQ(file["cameras"].size(), 2U);
    for (int i = 0; i < 2; ++i) {
      expectOkvisCamera(truth, file["cameras"][i], static_cast<std::size_t>(i));
    }
    EXPECT_EQ(file["cameras"][0]["distortion_type"].string(),
              name == std::string("tumvi") ? "equidistant" : "radialtangential");
    // OKVIS2: t_imu = t_cam - image_delay.
    EXPECT_EQ(-real(file["camera_parameters"]["image_delay"]), truth.imu->timeOffset());
    const cv::FileNode imu = file["imu_parameters"];
    EXPECT_EQ(real(imu["sigma_g_c"]), truth.imu->noise.gyro_density);
    EXPECT_EQ(real(imu["sigma_a_c"]), truth.imu->noise.accel_density);
    EXPECT_EQ(real(imu["sigma_gw_c"]), truth.imu->noise.gyro_random_walk);
    EXPECT_EQ(real(imu["sigma_aw_c"]), truth.imu->noise.accel_random_walk);
    EXPECT_EQ(real(imu["g"]), truth.imu->gravity_m_s2);
    EXPECT_EQ(matrix(numbers(imu["T_BS"])), Eigen::Matrix4d::Identity());
  }
}

// Its reader stops at a missing key, and at a real number without decimal point.
TEST(ExportOkvis2, ZeroOffsetIsStillARealNumber) {
  Calibration truth = rig("euroc");
  truth.imu->time_offsets = {{0}};
  const auto files = exportCalibration(truth, ExportTool::kOkvis2, exportOptions());
  const cv::FileStorage file = parsed(files, "okvis2.yaml");
  EXPECT_EQ(real(file["camera_parameters"]["image_delay"]), 0);
  EXPECT_THAT(fileText(files, "okvis2.yaml"), testing::HasSubstr("image_delay: 0.0\n"));
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Basalt's JSON, read back and projected with that tool's own formulae.
#include <Eigen/Geometry>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrator/camera/camera.h"
#include "datasets/calibration/calibration_reader.h"
#include "tests/datasets/calibration/export/exported_rigs.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

Json exported(const Calibration& truth) {
  const auto files = exportCalibration(truth, ExportTool::kBasalt, exportOptions());
  return Json::parse(fileText(files, "basalt_calib.json"))["value0"];
}

Eigen::Matrix4d pose(const Json& json) {
  const Eigen::Quaterniond q(json["qw"], json["qx"], json["qy"], json["qz"]);
  EXPECT_NEAR(q.norm(), 1, 1e-15);
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = q.toRotationMatrix();
  T.topRightCorner<3, 1>() << json["px"], json["py"], json["pz"];
  return T;
}

TEST(ExportBasalt, IsACalibrationThatWeRead) {
  for (const char* const name : {"euroc", "tumvi", "d435i"}) {
    const Calibration truth = rig(name);
    const auto files = exportCalibration(truth, ExportTool::kBasalt, exportOptions());
    const TemporaryFolder folder;
    const Calibration read =
        readCalibration(folder.write("calibration.json", fileText(files, "basalt_calib.json")));
    ASSERT_EQ(read.cameras.size(), truth.cameras.size());
    for (std::size_t i = 0; i < read.cameras.size(); ++i) {
      const Intrinsics& k = read.cameras[i].intrinsics;
      EXPECT_EQ(k.stacked(), truth.cameras[i].intrinsics.stacked()) << name;
      EXPECT_EQ(k.distortion_model, truth.cameras[i].intrinsics.distortion_model);
      EXPECT_EQ(k.resolution, truth.cameras[i].intrinsics.resolution);
      EXPECT_LT(difference(placeOf(truth, i).matrix(), placeOf(read, i)), 1e-12);
    }
    EXPECT_NEAR(read.imu->timeOffset(), truth.imu->timeOffset(), 1e-9);
    EXPECT_EQ(read.imu->noise.accel_random_walk, truth.imu->noise.accel_random_walk);
  }
}

TEST(ExportBasalt, OtherProjectionsReadBack) {
  Calibration truth = rig("tumvi");
  truth.cameras.resize(1);
  Intrinsics& k = truth.cameras[0].intrinsics;
  const auto readBack = [&](ProjectionModel model, std::vector<double> values) {
    k.projection_model = model;
    k.distortion_model = DistortionModel::kNone;
    k.distortion.resize(0);
    k.projection = Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values));
    const auto files = exportCalibration(truth, ExportTool::kBasalt, exportOptions());
    const TemporaryFolder folder;
    const Calibration read =
        readCalibration(folder.write("calibration.json", fileText(files, "basalt_calib.json")));
    EXPECT_EQ(read.cameras[0].intrinsics.projection_model, model);
    return (read.cameras[0].intrinsics.projection - k.projection).norm();
  };
  EXPECT_LT(readBack(ProjectionModel::kDs, {-0.2, 0.6, 300, 301, 255, 256}), 1e-12);
  EXPECT_LT(readBack(ProjectionModel::kEucm, {0.6, 1.1, 300, 301, 255, 256}), 1e-12);
  EXPECT_LT(readBack(ProjectionModel::kOmni, {0.9, 500, 501, 255, 256}), 1e-10);
}

TEST(ExportBasalt, OfUnlikeAxesTheLargestDensityIsReadAndSaid) {
  const auto files = exportCalibration(rig("tumvi"), ExportTool::kBasalt, exportOptions());
  Json json = Json::parse(fileText(files, "basalt_calib.json"));
  const TemporaryFolder folder;
  const auto remarks = [&](const std::string& name) {
    return CalibrationFile(folder.write(name, json.dump())).extras().remarks;
  };
  EXPECT_THAT(remarks("alike.json"), testing::IsEmpty());
  json["value0"]["accel_noise_std"] = {0.016, 0.02, 0.018};
  EXPECT_THAT(remarks("unlike.json"),
              testing::ElementsAre(testing::HasSubstr("accel_noise_std differs")));
  EXPECT_EQ(readCalibration(folder.path("unlike.json")).imu->noise.accel_density, 0.02);
}

// Basalt's own calibrations have them; biases alone leave samples as they are here.
TEST(ExportBasalt, ScaleAndMisalignmentThatAreNotReadAreSaid) {
  const auto files = exportCalibration(rig("tumvi"), ExportTool::kBasalt, exportOptions());
  Json json = Json::parse(fileText(files, "basalt_calib.json"));
  const TemporaryFolder folder;
  const auto remarks = [&] {
    return CalibrationFile(folder.write("calibration.json", json.dump())).extras().remarks;
  };
  json["value0"]["calib_accel_bias"][2] = 0.1;
  EXPECT_THAT(remarks(), testing::IsEmpty());
  json["value0"]["calib_accel_bias"][3] = 0.002;
  json["value0"]["calib_gyro_bias"][11] = -0.001;
  EXPECT_THAT(remarks(), testing::ElementsAre(testing::HasSubstr("calib_accel_bias states scale"),
                                              testing::HasSubstr("calib_gyro_bias states scale")));
}

TEST(ExportBasalt, PosesOffsetAndNoiseReadBack) {
  const Calibration truth = rig("tumvi");
  const Json json = exported(truth);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(difference(pose(json["T_imu_cam"][i]), placeOf(truth, i)), 1e-12);
    EXPECT_EQ(json["resolution"][i], (Json{512, 512}));
  }
  ASSERT_TRUE(json["cam_time_offset_ns"].is_number_integer());
  EXPECT_EQ(json["cam_time_offset_ns"], -3700000);  // t_imu = t_cam + this
  const ImuNoise& noise = truth.imu->noise;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(json["accel_noise_std"][axis], noise.accel_density);
    EXPECT_EQ(json["gyro_noise_std"][axis], noise.gyro_density);
    EXPECT_EQ(json["accel_bias_std"][axis], noise.accel_random_walk);
    EXPECT_EQ(json["gyro_bias_std"][axis], noise.gyro_random_walk);
  }
  EXPECT_EQ(json["imu_update_rate"], noise.rate_hz);
  EXPECT_EQ(json["calib_accel_bias"].size(), 9U);
  EXPECT_EQ(json["calib_gyro_bias"].size(), 12U);
  EXPECT_TRUE(json["vignette"].is_array());
}

TEST(ExportBasalt, FisheyeIsKb4WithTheSamePixels) {
  const Calibration truth = rig("tumvi");
  const Json json = exported(truth);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(json["intrinsics"][i]["camera_type"], "kb4");
    const Json& k = json["intrinsics"][i]["intrinsics"];
    expectPixels(truth, i, pose(json["T_imu_cam"][i]), {k["fx"], k["fy"], k["cx"], k["cy"]},
                 {k["k1"], k["k2"], k["k3"], k["k4"]});
  }
}

// radtan8: x (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6) + tangential.
Eigen::Vector2d radtan8(const Json& k, const Eigen::Vector3d& p) {
  const auto c = [&](const char* key) { return k[key].get<double>(); };
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const double r2 = x * x + y * y;
  const double numerator = 1 + r2 * (c("k1") + r2 * (c("k2") + r2 * c("k3")));
  const double radial = numerator / (1 + r2 * (c("k4") + r2 * (c("k5") + r2 * c("k6"))));
  const double u = x * radial + 2 * c("p1") * x * y + c("p2") * (r2 + 2 * x * x);
  const double v = y * radial + 2 * c("p2") * x * y + c("p1") * (r2 + 2 * y * y);
  return {c("fx") * u + c("cx"), c("fy") * v + c("cy")};
}

TEST(ExportBasalt, RadtanIsRadtan8WithTheSamePixels) {
  const Calibration truth = rig("euroc");
  const Json json = exported(truth);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(json["intrinsics"][i]["camera_type"], "pinhole-radtan8");
    for (const Eigen::Vector3d& p : pointsInView()) {
      const auto expected = project(truth.cameras[i].intrinsics, p);
      ASSERT_TRUE(expected.has_value());
      const Eigen::Vector2d uv = radtan8(json["intrinsics"][i]["intrinsics"], p);
      EXPECT_LT((uv - *expected).norm(), 1e-10);
    }
  }
}

// r (1 + k1 r^2 + k2 r^4) must grow up to rpmax, and no longer just beyond it.
TEST(ExportBasalt, RpmaxIsWhereTheDistortionFolds) {
  const double k1 = -0.4;
  const double k2 = 0.05;
  const Calibration truth =
      singleCamera(ProjectionModel::kPinhole, DistortionModel::kRadtan,
                   Eigen::Vector4d(450, 450, 370, 240), Eigen::Vector4d(k1, k2, 0, 0));
  const double rpmax = exported(truth)["intrinsics"][0]["intrinsics"]["rpmax"];
  const auto distorted = [&](double r) { return r * (1 + k1 * r * r + k2 * r * r * r * r); };
  ASSERT_GT(rpmax, 0.5);
  for (double r = 0.01; r < rpmax; r += 0.01) EXPECT_GT(distorted(r), distorted(r - 0.01));
  EXPECT_LT(distorted(rpmax + 0.01), distorted(rpmax));
  // EuRoC's distortion never folds.
  EXPECT_EQ(exported(rig("euroc"))["intrinsics"][0]["intrinsics"]["rpmax"], 0.0);
}

// Kalibr's omni: x / (z + xi |p|). Basalt's ucm: x / (alpha |p| + (1 - alpha) z).
TEST(ExportBasalt, OmniIsUcmWithTheSamePixels) {
  const double xi = 1.7;
  const Calibration truth =
      singleCamera(ProjectionModel::kOmni, DistortionModel::kNone,
                   (Eigen::VectorXd(5) << xi, 1000, 1010, 370, 250).finished(), {});
  const Json camera = exported(truth)["intrinsics"][0];
  EXPECT_EQ(camera["camera_type"], "ucm");
  const Json& k = camera["intrinsics"];
  const double alpha = k["alpha"];
  for (const Eigen::Vector3d& p : pointsInView()) {
    const double kalibr = 1000 * p.x() / (p.z() + xi * p.norm()) + 370;
    const double basalt = k["fx"].get<double>() * p.x() / (alpha * p.norm() + (1 - alpha) * p.z()) +
                          k["cx"].get<double>();
    EXPECT_NEAR(basalt, kalibr, 1e-10);
  }
}

// Usenko et al. 2018: double sphere (eq. 40 to 42) and extended unified (eq. 17) cameras.
double depthOf(const Json& k, const std::string& type, const Eigen::Vector3d& p) {
  const double alpha = k["alpha"];
  if (type == "eucm") {
    const double d = std::sqrt(k["beta"].get<double>() * p.head<2>().squaredNorm() + p.z() * p.z());
    return alpha * d + (1 - alpha) * p.z();
  }
  const double moved = k["xi"].get<double>() * p.norm() + p.z();
  return alpha * std::hypot(p.head<2>().norm(), moved) + (1 - alpha) * moved;
}

TEST(ExportBasalt, DoubleSphereAndEucmMeetTheSamePixels) {
  const auto values = (Eigen::VectorXd(6) << 0.1, 0.6, 300, 301, 370, 250).finished();
  for (const auto& [model, type] :
       {std::pair{ProjectionModel::kDs, "ds"}, std::pair{ProjectionModel::kEucm, "eucm"}}) {
    const Calibration truth = singleCamera(model, DistortionModel::kNone, values, {});
    const Json camera = exported(truth)["intrinsics"][0];
    EXPECT_EQ(camera["camera_type"], type);
    const Json& k = camera["intrinsics"];
    for (const Eigen::Vector3d& p : pointsInView()) {
      const double depth = depthOf(k, type, p);
      const Eigen::Vector2d uv(k["fx"].get<double>() * p.x() / depth + k["cx"].get<double>(),
                               k["fy"].get<double>() * p.y() / depth + k["cy"].get<double>());
      EXPECT_LT((uv - *project(truth.cameras[0].intrinsics, p)).norm(), 1e-10) << type;
    }
  }
}

TEST(ExportBasalt, NotesStandBesideIt) {
  const auto files = exportCalibration(rig("euroc"), ExportTool::kBasalt, exportOptions());
  const std::string notes = fileText(files, "basalt_notes.txt");
  EXPECT_THAT(notes, testing::StartsWith("Written by Plumbline 9.9.9 from rig.json."));
  EXPECT_THAT(notes, testing::HasSubstr("cam_time_offset_ns"));
  EXPECT_THAT(notes, testing::HasSubstr("pinhole-radtan8"));
}

}  // namespace
}  // namespace plumbline

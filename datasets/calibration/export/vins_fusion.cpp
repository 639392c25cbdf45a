// SPDX-License-Identifier: BSD-3-Clause
// Keys as VINS-Fusion's readParameters() and its camera_models (camodocal) read them. A key that is
// missing is read as 0 without a word, so every key is written.
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "datasets/calibration/export/tools.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

constexpr const char* kVinsFusionSettings = R"(
# From here on: settings of the tool with the values of its own examples. They are no results of
# the calibration; tune them, and give output_path a folder that is there.
output_path: "output/"
multiple_thread: 1
max_cnt: 150
min_dist: 30
freq: 10
F_threshold: 1.0
show_track: 0
flow_back: 1
max_solver_time: 0.04
max_num_iterations: 8
keyframe_parallax: 10.0
load_previous_pose_graph: 0
pose_graph_save_path: "output/pose_graph/"
save_image: 0
)";

/// A section of camodocal's file.
std::string section(const char* name,
                    std::initializer_list<std::pair<const char*, double>> values) {
  std::string text = fmt::format("{}:\n", name);
  for (const auto& [key, value] : values) text += numberLine(fmt::format("   {}", key), value);
  return text;
}

std::string radtanSection(const Intrinsics& k) {
  const Eigen::Vector4d d = fourCoefficients(k);
  return section("distortion_parameters", {{"k1", d[0]}, {"k2", d[1]}, {"p1", d[2]}, {"p2", d[3]}});
}

struct DescribedCamera {
  const char* model_type;
  std::string sections;
};

DescribedCamera describe(const CameraCalibration& camera, const ExportSource& source) {
  const Intrinsics& k = camera.intrinsics;
  const Eigen::VectorXd& p = k.projection;
  const Eigen::VectorXd& d = k.distortion;
  const bool radtan_or_none = k.distortion_model == DistortionModel::kRadtan ||
                              k.distortion_model == DistortionModel::kNone;
  // camodocal's r(theta) = theta + k2 theta^3 + k3 theta^5 + k4 theta^7 + k5 theta^9: the names run
  // one ahead of Kalibr's k1..k4.
  if (isPinhole(k, DistortionModel::kEquidistant)) {
    return {"KANNALA_BRANDT", section("projection_parameters", {{"k2", d[0]},
                                                                {"k3", d[1]},
                                                                {"k4", d[2]},
                                                                {"k5", d[3]},
                                                                {"mu", p[0]},
                                                                {"mv", p[1]},
                                                                {"u0", p[2]},
                                                                {"v0", p[3]}})};
  }
  if (k.projection_model == ProjectionModel::kPinhole && radtan_or_none) {
    return {"PINHOLE",
            radtanSection(k) + section("projection_parameters",
                                       {{"fx", p[0]}, {"fy", p[1]}, {"cx", p[2]}, {"cy", p[3]}})};
  }
  if (k.projection_model == ProjectionModel::kOmni && radtan_or_none) {
    return {"MEI", section("mirror_parameters", {{"xi", p[0]}}) + radtanSection(k) +
                       section("projection_parameters",
                               {{"gamma1", p[1]}, {"gamma2", p[2]}, {"u0", p[3]}, {"v0", p[4]}})};
  }
  source.refuseModel(camera,
                     "pinhole and omni with radtan or no distortion, pinhole with equidistant");
}

std::string cameraText(const CameraCalibration& camera, const ExportSource& source) {
  const auto [model_type, sections] = describe(camera, source);
  const Resolution& size = camera.intrinsics.resolution;
  return opencvHeader(source.options, {}) +
         fmt::format("model_type: {}\ncamera_name: {}\nimage_width: {}\nimage_height: {}\n",
                     model_type, plainName(camera.name), size.width, size.height) +
         sections;
}

std::vector<std::string> vinsFusionWarnings(const ExportSource& source) {
  if (!source.calibration.imu) return {};
  std::vector<std::string> warnings =
      offsetWarnings(source, "td is written as 0.", "estimate_td: 1");
  warnings.emplace_back(
      "VINS-Fusion squares acc_n, gyr_n, acc_w and gyr_w and multiplies by dt^2, with no factor of "
      "the rate, so continuous-time densities must not be copied. The values here are the density "
      "times the root of the IMU's rate: for acc_n and gyr_n the standard deviation of one sample, "
      "for acc_w and gyr_w the number whose random walk is that of the density. Its mid-point rule "
      "treats the ends of a step as independent and so counts half of a sample's variance; a "
      "factor of sqrt(2) compensates.");
  return warnings;
}

std::string headText(const Calibration& calibration) {
  const std::size_t count = calibration.cameras.size();
  std::string text =
      fmt::format("imu: {}\nnum_of_cam: {}\nimu_topic: \"{}\"\n", calibration.imu ? 1 : 0, count,
                  calibration.imu ? topicOf(*calibration.imu) : "/imu0");
  for (std::size_t i = 0; i < count; ++i) {
    text += fmt::format("image{0}_topic: \"{1}\"\ncam{0}_calib: \"cam{0}.yaml\"\n", i,
                        topicOf(calibration.cameras[i]));
  }
  const Resolution& size = calibration.cameras.front().intrinsics.resolution;
  return text + fmt::format("image_width: {}\nimage_height: {}\n", size.width, size.height);
}

// Without an IMU the body is camera 0.
std::string transformsText(const Calibration& calibration) {
  const Transform T_BC0 = calibration.imu ? calibration.imu->T_SC0 : Transform();
  std::string text =
      "\n# Camera into body (IMU); 0: used as they are, 1: refined while it runs.\n"
      "estimate_extrinsic: 0\n";
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) {
    text +=
        opencvMatrix(fmt::format("body_T_cam{}", i), T_BC0 * calibration.cameras[i].T_C0Ci, 'd');
  }
  return text;
}

/// VINS-Fusion takes (acc_n dt)^2 for a step's variance, its mid-point rule aside: with n
/// sqrt(rate) and dt = 1 / rate that is n^2 dt, what a continuous-time density n adds.
std::string vinsFusionImu(const ImuCalibration& imu) {
  const ImuNoise& n = imu.noise;
  const double root = std::sqrt(n.rate_hz);
  return fmt::format("\n# Density times sqrt({} Hz).\n", yamlNumber(n.rate_hz)) +
         numberLine("acc_n", n.accel_density * root) + numberLine("gyr_n", n.gyro_density * root) +
         numberLine("acc_w", n.accel_random_walk * root) +
         numberLine("gyr_w", n.gyro_random_walk * root) + numberLine("g_norm", imu.gravity_m_s2) +
         "\n# t_imu = t_cam + td.\nestimate_td: 0\n" + numberLine("td", imu.timeOffset());
}

}  // namespace

ExportedFiles exportVinsFusion(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  source.atMostCameras(2);
  source.oneResolution();
  source.knownNoise();
  // Two cameras do without an IMU, one does not.
  if (!calibration.imu && calibration.cameras.size() < 2) source.neededImu();
  ExportedFiles out;
  out.warnings = vinsFusionWarnings(source);
  std::string text = opencvHeader(options, out.warnings) + "\n" + headText(calibration) +
                     transformsText(calibration);
  text += calibration.imu ? vinsFusionImu(*calibration.imu) : "estimate_td: 0\ntd: 0.0\n";
  out.files.push_back({"vins_fusion.yaml", text + kVinsFusionSettings});
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) {
    out.files.push_back({fmt::format("cam{}.yaml", i), cameraText(calibration.cameras[i], source)});
  }
  return out;
}

}  // namespace plumbline

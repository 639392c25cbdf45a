// SPDX-License-Identifier: BSD-3-Clause
// Keys as OpenVINS' VioManagerOptions and YamlParser read them.
#include <fmt/format.h>

#include "datasets/calibration/export/tools.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

std::vector<std::string> openVinsWarnings(const ExportSource& source) {
  const Calibration& calibration = source.calibration;
  std::vector<std::string> warnings =
      offsetWarnings(source, "timeshift_cam_imu is left out, and OpenVINS starts from 0.",
                     "calib_cam_timeoffset: true");
  warnings.push_back(
      fmt::format("To set in estimator_config.yaml, which is not written here: max_cameras: {}, "
                  "gravity_mag: {}, relative_config_imu: \"kalibr_imu_chain.yaml\", "
                  "relative_config_imucam: \"kalibr_imucam_chain.yaml\".",
                  calibration.cameras.size(), yamlNumber(calibration.imu->gravity_m_s2)));
  // Of an offset that is unknown there is nothing to keep, and 0 would stay.
  warnings.emplace_back(
      source.options.offset_known
          ? "OpenVINS refines the calibration while it runs unless calib_cam_extrinsics, "
            "calib_cam_intrinsics and calib_cam_timeoffset are false: switch them off when you "
            "judge this calibration with it."
          : "OpenVINS refines the calibration while it runs unless calib_cam_extrinsics and "
            "calib_cam_intrinsics are false: switch these two off when you judge this calibration "
            "with it, and leave calib_cam_timeoffset true.");
  return warnings;
}

std::string cameraText(const ExportSource& source, std::size_t i) {
  const Calibration& calibration = source.calibration;
  const CameraCalibration& camera = calibration.cameras[i];
  const Intrinsics& k = camera.intrinsics;
  const Transform T_SCi = calibration.imu->T_SC0 * camera.T_C0Ci;
  const char* distortion = source.distortionWord(camera, {"radtan", "equidistant"});
  std::string text = fmt::format("cam{}:\n  T_imu_cam:\n", i) + yamlRows(T_SCi.matrix(), "    ");
  text += fmt::format("  cam_overlaps: {}\n  camera_model: pinhole\n",
                      kalibrOverlaps(i, calibration.cameras.size()));
  text += fmt::format("  distortion_coeffs: {}\n  distortion_model: {}\n",
                      yamlList(fourCoefficients(k)), distortion);
  text +=
      fmt::format("  intrinsics: {}\n  resolution: [{}, {}]\n  rostopic: {}\n",
                  yamlList(k.projection), k.resolution.width, k.resolution.height, topicOf(camera));
  if (!source.options.offset_known) return text;
  // Camera 0's under every camera: OpenVINS has one, and offsetWarnings() says what to do.
  return text + numberLine("  timeshift_cam_imu", calibration.imu->timeOffset());
}

// Kalibr's model with nothing to correct: accelerometer and gyroscope as calibrated here.
std::string openVinsImu(const ImuCalibration& imu) {
  const auto matrix = [](const char* key, const Eigen::MatrixXd& M) {
    return fmt::format("  {}:\n", key) + yamlRows(M, "    ");
  };
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  return "imu0:\n" + matrix("T_i_b", Eigen::Matrix4d::Identity()) +
         kalibrDensities(imu.noise, "  ") + "  rostopic: " + topicOf(imu) + "\n" +
         numberLine("  time_offset", 0) + numberLine("  update_rate", imu.noise.rate_hz) +
         "  model: \"calibrated\"\n" + matrix("Tw", I) + matrix("R_IMUtoGYRO", I) +
         matrix("Ta", I) + matrix("R_IMUtoACC", I) + matrix("Tg", Eigen::Matrix3d::Zero());
}

}  // namespace

ExportedFiles exportOpenVins(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  const ImuCalibration& imu = source.neededImu();
  ExportedFiles out;
  out.warnings = openVinsWarnings(source);
  std::vector<std::string> notes = out.warnings;
  notes.insert(notes.begin(),
               "T_imu_cam maps camera to IMU; t_imu = t_cam + timeshift_cam_imu, of which OpenVINS "
               "reads only cam0's.");
  std::string cameras = opencvHeader(options, notes) + "\n";
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) cameras += cameraText(source, i);
  const std::string densities =
      "Continuous-time noise densities; scale, misalignment and gravity sensitivity are those of "
      "an ideal IMU. model \"kalibr\" instead of \"calibrated\" lets OpenVINS refine them.";
  out.files = {
      {"kalibr_imucam_chain.yaml", cameras},
      {"kalibr_imu_chain.yaml", opencvHeader(options, {densities}) + "\n" + openVinsImu(imu)}};
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/export/calibration_export.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/calibration/calibration_fields.h"
#include "datasets/calibration/export/tools.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

struct ToolRow {
  const char* name;
  ExportedFiles (*write)(const ExportSource&);
};

// In the order of the enumeration.
constexpr std::array<ToolRow, enumWords(ExportTool()).size()> kTools{
    {{"Kalibr", exportKalibr},
     {"ORB-SLAM3", exportOrbSlam3},
     {"OpenVINS", exportOpenVins},
     {"VINS-Fusion", exportVinsFusion},
     {"OKVIS2", exportOkvis2},
     {"Basalt", exportBasalt},
     {"camera_info", exportCameraInfo}}};

constexpr double kHighestFrameRate_hz = 1e6;  // of images: beyond any camera

constexpr const char* kDirections =
    "T_cam_imu maps IMU to camera, T_cn_cnm1 the previous camera to this one; t_imu = t_cam + "
    "timeshift_cam_imu.";

std::string namesOf(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const CameraCalibration& camera : calibration.cameras) names.push_back(camera.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::size_t placeOf(const Calibration& calibration, const std::string& name,
                    const std::string& path) {
  const auto& cameras = calibration.cameras;
  const auto camera = std::ranges::find(cameras, name, &CameraCalibration::name);
  if (camera != cameras.end()) return static_cast<std::size_t>(camera - cameras.begin());
  throw BadInput(
      InputFault::kUnknownCamera, path, 0,
      fmt::format("has no camera '{}'; expected some of {}", name, namesOf(calibration)));
}

}  // namespace

std::vector<ExportTool> exportTools() {
  std::vector<ExportTool> tools;
  for (std::size_t i = 0; i < kTools.size(); ++i) tools.push_back(static_cast<ExportTool>(i));
  return tools;
}

void ExportOptions::check() const {
  if (!camera_rate_hz || (*camera_rate_hz > 0 && *camera_rate_hz <= kHighestFrameRate_hz)) return;
  throw BadInput(InputFault::kBadCameraRate, source, 0,
                 fmt::format("the rate of the images is {:g} Hz; expected above 0 and at most {:g}",
                             *camera_rate_hz, kHighestFrameRate_hz));
}

ExportedFiles exportCalibration(const Calibration& calibration, ExportTool tool,
                                const ExportOptions& options) {
  options.check();
  // Several writers take a first camera for granted.
  if (calibration.cameras.empty()) {
    throw BadInput(InputFault::kEmpty, options.source, 0,
                   "has no camera; expected a calibration of one or more");
  }
  checkPlausible(calibration, options.source);
  const auto& [name, write] = kTools[static_cast<std::size_t>(tool)];
  return write({calibration, options, name});
}

ExportedFiles exportKalibr(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  for (const CameraCalibration& camera : calibration.cameras) {
    if (camera.intrinsics.distortion_model != DistortionModel::kRational) continue;
    // Kalibr has no such distortion.
    source.refuseModel(camera, "radtan, equidistant, fov and no distortion");
  }
  ExportedFiles out;
  const bool with_imu = calibration.imu.has_value();
  std::vector<std::string> notes{kDirections};
  if (with_imu && !options.offset_known) {
    // The others' shifts are no matter here: this format has one for each camera.
    out.warnings =
        offsetWarnings(source, "timeshift_cam_imu is left out.", "without --no-time-calibration");
    notes.push_back(out.warnings.front());
  }
  out.files.push_back(
      {with_imu ? "camchain-imucam.yaml" : "camchain.yaml",
       commentHeader(options, notes) + kalibrCamchainText(calibration, options.offset_known)});
  if (!with_imu) return out;
  if (!options.noise_known) {
    out.warnings.push_back(
        "imu.yaml is not written: this file does not state the IMU's noise densities.");
    return out;
  }
  source.knownNoise();
  out.files.push_back(
      {"imu.yaml", commentHeader(options, {"Continuous-time noise densities."}) +
                       kalibrImuInputText(calibration.imu->noise, topicOf(*calibration.imu))});
  return out;
}

Calibration selectCameras(const Calibration& calibration, const std::vector<std::string>& names,
                          const std::string& path) {
  if (names.empty()) return calibration;
  std::vector<std::size_t> places;
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1) {
      throw BadInput(InputFault::kUnknownCamera, path, 0,
                     fmt::format("camera '{}' is requested twice", name));
    }
    places.push_back(placeOf(calibration, name, path));
  }
  return selectCameras(calibration, places);
}

Calibration selectCameras(const Calibration& calibration, const std::vector<std::size_t>& places) {
  Calibration chosen{{}, calibration.imu};
  if (places.empty()) return chosen;
  for (const std::size_t place : places) chosen.cameras.push_back(calibration.cameras[place]);
  if (chosen.imu) chosen.imu->time_offsets = selected(calibration.imu->time_offsets, places);
  if (places.front() == 0) return chosen;
  const Transform T_C0Cn = chosen.cameras.front().T_C0Ci;
  for (CameraCalibration& camera : chosen.cameras) {
    // T_CnCi, with Cn the camera that becomes camera 0.
    camera.T_C0Ci = T_C0Cn.inverse() * camera.T_C0Ci;
    camera.T_C0Ci_std.reset();
  }
  // Without the product's rounding.
  chosen.cameras.front().T_C0Ci = Transform();
  if (chosen.imu) {
    // T_SCn = T_SC0 T_C0Cn.
    chosen.imu->T_SC0 = chosen.imu->T_SC0 * T_C0Cn;
    // It is that of another camera's place, and the covariance that would carry it over is not
    // here.
    chosen.imu->T_SC0_std.reset();
    // Of the former camera 0's offset, which is the new one's where the two are synchronised.
    if (hasOwnOffset(calibration.imu->time_offsets, places.front())) {
      chosen.imu->time_offset_std_s.reset();
    }
  }
  return chosen;
}

}  // namespace plumbline

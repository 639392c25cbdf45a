// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/export/export_text.h"
#include "datasets/calibration/export/tool_writers.h"
#include "datasets/calibration/kalibr_writer.h"

namespace plumbline {
namespace {

constexpr const char* kDirections =
    "T_cam_imu maps IMU to camera, T_cn_cnm1 the previous camera to this one; t_imu = t_cam + "
    "timeshift_cam_imu.";

}  // namespace

ExportedFiles exportKalibr(const Calibration& calibration, const ExportOptions& options) {
  ExportedFiles out;
  const bool with_imu = calibration.imu.has_value();
  out.files.push_back({with_imu ? "camchain-imucam.yaml" : "camchain.yaml",
                       commentHeader(options, {kDirections}) + kalibrCamchainText(calibration)});
  if (!with_imu) return out;
  if (!options.noise_known) {
    out.warnings.push_back(
        "imu.yaml is not written: this file does not state the IMU's noise densities (give them "
        "with --imu imu.yaml).");
    return out;
  }
  out.files.push_back(
      {"imu.yaml", commentHeader(options, {"Continuous-time noise densities."}) +
                       kalibrImuText(calibration.imu->noise, topicOf(*calibration.imu))});
  return out;
}

}  // namespace plumbline

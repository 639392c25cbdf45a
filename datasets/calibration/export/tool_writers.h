// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

// One writer a tool, each in its own file; contract as exportCalibration().

/// camchain-imucam.yaml (camchain.yaml without IMU), imu.yaml.
ExportedFiles exportKalibr(const Calibration& calibration, const ExportOptions& options);
/// orbslam3.yaml: settings of File.version 1.0.
ExportedFiles exportOrbSlam3(const Calibration& calibration, const ExportOptions& options);
/// kalibr_imucam_chain.yaml, kalibr_imu_chain.yaml.
ExportedFiles exportOpenVins(const Calibration& calibration, const ExportOptions& options);
/// vins_fusion.yaml, cam0.yaml and cam1.yaml.
ExportedFiles exportVinsFusion(const Calibration& calibration, const ExportOptions& options);
/// okvis2.yaml.
ExportedFiles exportOkvis2(const Calibration& calibration, const ExportOptions& options);
/// basalt_calib.json, basalt_notes.txt.
ExportedFiles exportBasalt(const Calibration& calibration, const ExportOptions& options);
/// NAME.yaml for each camera.
ExportedFiles exportCameraInfo(const Calibration& calibration, const ExportOptions& options);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics.h"
#include "report/records/calibration_record.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// One of the calibrations that are compared.
struct ComparedCalibration {
  std::string label;  ///< short and unique, e.g. "kalibr"
  std::string file;   ///< file name, without folders of the machine
  std::string tool;   ///< who wrote it: "plumbline", "kalibr", "yac"
  Calibration calibration;
  std::vector<Finding> lint;  ///< of the conventions: inverted transforms, flipped signs, ...
};

/// One parameter under all calibrations, in one convention.
struct ComparedParameter {
  std::string name;  ///< as in ParameterCovariance; also "T_SC0.angle", "T_C0C1.angle"
  std::string unit;
  std::vector<std::optional<double>> values;      ///< one per calibration
  std::vector<std::optional<double>> std;         ///< formal, where the calibration carries one
  std::vector<std::optional<double>> difference;  ///< to the first calibration
  /// |difference| / sqrt(std_i^2 + std_0^2), where both are known.
  std::vector<std::optional<double>> significance;
};

/// A calibration scored on a session that it did not see (or did: `held_out` tells).
struct CalibrationScore {
  std::string label;  ///< of the calibration
  std::string session;
  std::string part;  ///< "all", "fold 2 of 5"
  bool held_out = false;
  ErrorStatistics reprojection;
  std::vector<ErrorStatistics> per_camera;
  std::optional<ErrorStatistics> camera_imu;  ///< with IMU: only states and gravity move
  std::optional<double> gyro_rms_rad_s;
  std::optional<double> accel_rms_m_s2;
  std::optional<double> entropy_nats;  ///< of its own parameters on that session
  std::vector<std::string> entropy_parameters;
  std::string problem;  ///< why there is no score; empty if there is
};

/// A value over a camera's image, row-major from the top.
struct ImageMap {
  std::string camera;
  std::string label;   ///< of the calibration, or "a - b"
  double range_m = 0;  ///< distance of the points; infinity: directions only
  int columns = 0, rows = 0;
  int width = 0, height = 0;             ///< of the image [px]
  std::vector<double> values;            ///< [px]; NaN where undefined
  std::vector<Eigen::Vector2d> vectors;  ///< difference itself, empty for uncertainties [px]
  std::optional<Transform> implied;  ///< alignment of the two cameras' frames that was taken out
};

/// The time offset of every calibration in Kalibr's sign [s], per camera as written.
struct OffsetSummary {
  std::string label;
  std::optional<double> time_offset_s;
  std::optional<double> std_s;
};

/// Everything that a comparison page shows.
struct ComparisonRecord {
  std::string name;
  Provenance provenance;
  Assumptions assumptions;
  Verdict verdict;  ///< the findings of all lints, and of the scores
  std::vector<ComparedCalibration> calibrations;
  std::vector<ComparedParameter> parameters;
  std::vector<CalibrationScore> scores;
  std::vector<ImageMap> differences;    ///< to the first calibration
  std::vector<ImageMap> uncertainties;  ///< of those that carry a covariance or were re-scored
  std::vector<OffsetSummary> offsets;
  std::vector<TrajectoryRun> runs;  ///< trajectories under these calibrations, where given
};

}  // namespace plumbline

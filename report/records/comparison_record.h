// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics.h"
#include "report/records/calibration_record.h"
#include "report/records/calibration_score.h"
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

/// A value over a camera's image, row-major from the top. Grid points lie on the image's borders:
/// u = c (width - 1) / (columns - 1), v = r (height - 1) / (rows - 1).
struct ImageMap {
  std::string camera;
  std::string label;   ///< of the calibration, or "b - a", a the first calibration
  std::string method;  ///< how it was computed, e.g. "cross-reprojection on euroc", "image fit"
  double range_m = 0;  ///< distance of the points; infinity: directions only
  int columns = 0, rows = 0;
  int width = 0, height = 0;             ///< of the image [px]
  std::vector<double> values;            ///< [px]; NaN where undefined
  std::vector<Eigen::Vector2d> vectors;  ///< difference itself, empty for uncertainties [px]
  /// Of a difference: alignment of the two cameras' frames that was taken out, T_BA (a's points in
  /// b's frame).
  std::optional<Transform> implied;
};

/// The time offset of every calibration in Kalibr's sign [s], per camera as written.
struct OffsetSummary {
  std::string label;
  std::optional<double> time_offset_s;  ///< mean of the cameras' where they have one each
  std::optional<double> std_s;
  std::vector<double> per_camera_s;
};

/// Which of two calibrations predicts a camera's corners better: the mean over views of (mean
/// squared error under `label`) - (under the first calibration) [px^2]; negative: `label` is
/// better.
struct PairedPrediction {
  std::string label;
  std::string camera;
  int views = 0;  ///< seen under both
  double difference_px2 = 0;
  double std_px2 = 0;  ///< standard error of the mean, from blocks of consecutive views
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
  std::vector<PairedPrediction> paired;  ///< to the first calibration, on the same session
  std::vector<ImageMap> differences;     ///< to the first calibration
  std::vector<ImageMap> uncertainties;   ///< of those that carry a covariance or were re-scored
  std::vector<OffsetSummary> offsets;
  std::vector<TrajectoryRun> runs;  ///< trajectories under these calibrations, where given
};

}  // namespace plumbline

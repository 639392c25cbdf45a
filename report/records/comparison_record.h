// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/fields/calibration_fields.h"
#include "report/records/calibration_record.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// One of the calibrations that are compared.
struct ComparedCalibration {
  std::string label, file, tool;
  Calibration calibration;
  std::vector<Finding> lint;
  std::optional<bool> contradicted = std::nullopt;
};

void fields(auto& v, ComparedCalibration& c) {
  v("label", c.label, "short and unique");
  v("file", c.file, "file name");
  v("tool", c.tool, "who wrote it: `plumbline`, `kalibr`, `yac`, ...");
  fields(v, c.calibration);
  v("lint", c.lint, "findings on its conventions: inverted transforms, flipped signs, ...");
  v("contradicted", c.contradicted, "1",
    "whether the session contradicts what it states of cameras, T_SC0 or offset; null: not tested");
}

/// One parameter under all calibrations, in one convention.
struct ComparedParameter {
  std::string name, unit;
  std::vector<std::optional<double>> values, std, difference, significance;
  std::vector<VerdictLevel> levels = {};
  std::vector<std::optional<double>> dof = {};

  /// A difference that is an angle or a distance has none.
  bool hasSign() const { return !name.ends_with(".angle") && !name.ends_with(".lever"); }
  /// Of a calibration that states a deviation.
  EstimatedVariance variance(std::size_t i) const {
    const std::optional<double> known = i < dof.size() ? dof[i] : std::nullopt;
    return {*std[i] * *std[i], known.value_or(std::numeric_limits<double>::infinity())};
  }
};

void fields(auto& v, ComparedParameter& p) {
  v("name", p.name, "as in a covariance; also `T_SC0.angle`, `T_C0C1.angle`");
  v("unit", p.unit, "its unit");
  v("values", p.values, "one per calibration");
  v("std", p.std, "as stated: cluster-robust where `dof` is set, else formal");
  v.ifSet("dof", p.dof, "degrees of freedom of the squares of cluster-robust `std`");
  v("difference", p.difference, "to the first calibration");
  v("significance", p.significance,
    "|difference| / sqrt(std^2 + std of the first^2), by the degrees of freedom as the normal "
    "deviate that is as rare");
  v("levels", p.levels, "of the significance: `caution` from 2, `bad` from 3 sigma");
}

/// What the session that calibrations are scored on gives when it is calibrated itself.
struct SessionEstimate {
  std::string session;
  Calibration calibration;  ///< without cameras: none, `problem` says why
  std::vector<ComparedParameter> parameters;
  std::string problem;
};

void fields(auto& v, SessionEstimate& e) {
  v("session", e.session, "its name");
  v.ifSet("problem", e.problem, "why there is none, or none of camera and IMU");
  fields(v, e.calibration);
  v.ifSet("parameters", e.parameters,
          "the first entry of each list is the session's own estimate, then one per calibration");
}

/// The time offset of every calibration in Kalibr's sign [s], per camera as written.
struct OffsetSummary {
  std::string label;
  std::optional<double> time_offset_s, std_s;
  std::vector<double> per_camera_s;
};

inline std::string partName(const OffsetSummary& o) { return o.label; }

void fields(auto& v, OffsetSummary& o) {
  v("label", o.label, "of the calibration");
  v("time_offset_s", o.time_offset_s, "s", "mean of the cameras' where they have one each");
  v("std_s", o.std_s, "s", "its standard deviation");
  v.ifSet("per_camera_s", o.per_camera_s, "as written [s]");
}

/// Of two RMSEs: below it a difference, however certain, is of no consequence, such as that of
/// digits that a file has not.
inline constexpr double kOfConsequence = 0.01;

/// Which of two calibrations predicts a camera's corners better: the mean over views of (mean
/// squared error under `label`) - (under the first calibration) [px^2]; negative: `label` is
/// better.
struct PairedPrediction {
  std::string label, camera;
  int views = 0;
  double difference_px2 = 0, std_px2 = 0, first_px2 = 0;
  int blocks = 0;  ///< 0: too few, no std_px2
  double half_px2 = 0;

  /// The difference in its standard errors; 0 without one.
  double sigmas() const { return std_px2 > 0 ? difference_px2 / std_px2 : 0; }
  /// Whether they differ beyond the 95 % interval.
  bool isSignificant() const { return half_px2 > 0 && std::abs(difference_px2) > half_px2; }
  /// Whether one of the two predicts better: significantly, and by kOfConsequence of the RMSE.
  bool isClear() const {
    return isSignificant() && std::abs(difference_px2) > 2 * kOfConsequence * first_px2;
  }
};

inline std::string partName(const PairedPrediction& p) { return p.label + "/" + p.camera; }

void fields(auto& v, PairedPrediction& p) {
  v("label", p.label, "of the calibration that is compared with the first");
  v("camera", p.camera, "its name");
  v("views", p.views, "1", "seen under both");
  v("difference_px2", p.difference_px2, "px^2",
    "mean over views of the squared error less that under the first; negative: better");
  v("std_px2", p.std_px2, "px^2",
    "standard error of the mean, from blocks of consecutive views; 0 below 5 blocks");
  v("first_px2", p.first_px2, "px^2",
    "mean over the same views of the squared error under the first");
  // Absent in documents of before there were intervals, too.
  v.ifSet("blocks", p.blocks, "of consecutive views; absent: fewer than 5, no standard error");
  v.ifSet("half_px2", p.half_px2,
          "half the 95 % interval by Student's t [px^2]; absent: no interval");
}

/// Everything that a comparison page shows.
struct ComparisonRecord {
  std::string name;
  Provenance provenance;
  Assumptions assumptions;
  Verdict verdict;
  std::vector<ComparedCalibration> calibrations;
  std::vector<ComparedParameter> parameters;
  std::optional<SessionEstimate> session_estimate;  ///< with a session, unless not asked for
  std::vector<CalibrationScore> scores;
  std::vector<PairedPrediction> paired;
  std::vector<ImageMap> differences, uncertainties;
  std::vector<OffsetSummary> offsets;
  std::optional<TrajectoryStudy> trajectories;
};

/// comparison.json.
void fields(auto& v, ComparisonRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("name", r.name, "of the comparison");
  v("calibrations", r.calibrations, "those compared; the first is the reference");
  v("parameters", r.parameters, "each under all calibrations, in one convention");
  v("offsets", r.offsets, "time offsets in Kalibr's sign");
  v("session_estimate", r.session_estimate, "calibration of the session itself");
  v("scores", r.scores, "each calibration on each session");
  v("paired", r.paired, "which predicts a camera's corners better, on the same views");
  v("differences", r.differences, "maps over the image, to the first calibration");
  v("uncertainties", r.uncertainties, "maps of those that carry a covariance or were scored");
  v("trajectories", r.trajectories, "under these calibrations, where given");
  v("assumptions", r.assumptions, "assumptions of covariances and verdict");
  v("verdict", r.verdict, "the findings of all lints, and of the scores");
  v("provenance", r.provenance, "where the result comes from");
}

}  // namespace plumbline

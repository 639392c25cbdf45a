// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/calibration_record.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

/// Component of a transform by the suffix of a parameter's name: tx ty tz [m], rx ry rz of Log(R)
/// [rad].
std::optional<double> component(const Transform& T, const std::string& suffix) {
  if (suffix.size() != 2 || suffix[1] < 'x' || suffix[1] > 'z') return std::nullopt;
  const int axis = suffix[1] - 'x';
  if (suffix[0] == 't') return T.t[axis];
  if (suffix[0] == 'r') return logSO3(T.R)[axis];
  return std::nullopt;
}

/// By its place among the names: intrinsicParameters() and stacked() have one order.
std::optional<double> intrinsicValue(const CameraCalibration& camera, const std::string& suffix) {
  const auto names =
      intrinsicParameters(camera.intrinsics.projection_model, camera.intrinsics.distortion_model);
  const auto found = std::ranges::find(names, suffix, &ParameterName::name);
  const Eigen::VectorXd values = camera.intrinsics.stacked();
  const auto index = found - names.begin();
  if (found == names.end() || index >= values.size()) return std::nullopt;
  return values[index];
}

/// Of an intrinsic or a T_C0Ci. Prefixes are those of cameraParameters().
std::optional<double> cameraValue(const std::vector<CameraCalibration>& cameras,
                                  const std::string& prefix, const std::string& suffix) {
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (prefix == parameterOwner(cameras, i)) return intrinsicValue(cameras[i], suffix);
    if (prefix == "T_C0C" + std::to_string(i)) return component(cameras[i].T_C0Ci, suffix);
  }
  return std::nullopt;
}

// Of camera 0, or of the camera that the suffix names ("cam1").
std::optional<double> offsetValue(const ImuCalibration& imu, const std::string& suffix,
                                  const std::vector<CameraCalibration>& cameras) {
  if (suffix.empty()) return imu.timeOffset();
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    if (suffix == parameterOwner(cameras, i)) return imu.timeOffset(i);
  }
  return std::nullopt;
}

/// What stands before the dot tells whose the parameter is; "time_offset" alone is camera 0's.
std::optional<double> valueOf(const CalibrationRecord& record, const std::string& name,
                              const std::vector<CameraCalibration>& cameras) {
  const std::size_t dot = name.find('.');
  const std::string prefix = name.substr(0, dot);
  const std::string suffix = dot == std::string::npos ? "" : name.substr(dot + 1);
  if (record.camera_imu) {
    if (prefix == "time_offset") return offsetValue(record.camera_imu->imu, suffix, cameras);
    if (prefix == "T_SC0") return component(record.camera_imu->imu.T_SC0, suffix);
  }
  return cameraValue(cameras, prefix, suffix);
}

/// Of the bootstrap, by name.
std::optional<double> spreadOf(const std::optional<ResampleSpread>& spread,
                               const std::string& name) {
  if (!spread) return std::nullopt;
  const auto found = std::ranges::find(spread->names, name);
  if (found == spread->names.end()) return std::nullopt;
  return spread->std[found - spread->names.begin()];
}

struct Robust {
  std::optional<double> std, dof;
};

/// Of the i-th parameter of a stage's covariance. The camera-IMU stage has them for T_SC0 and the
/// time offset: through both stages, or, where the cameras were given, from its score tests.
Robust robustOf(const CalibrationRecord& record, Stage stage, std::size_t i) {
  const auto at = static_cast<Eigen::Index>(i);
  // Shorter than the covariance where that lists more than T_SC0 and the offset.
  const auto entry = [&](const auto& all) {
    return all && at < all->size() ? std::optional((*all)[at]) : std::nullopt;
  };
  const StageSummary& summary =
      stage == Stage::kCamera ? record.camera->summary : record.camera_imu->summary;
  if (summary.robust_std) return {entry(summary.robust_std), entry(summary.robust_dof)};
  if (stage == Stage::kCamera || !record.camera_imu->faults) return {};
  const FaultDiagnosis& faults = *record.camera_imu->faults;
  return {entry(std::optional(faults.robust_std)), entry(faults.robust_dof)};
}

/// Findings without advice stay apart: no cure is no cure in common.
bool haveOneCure(const Finding& a, const Finding& b) {
  return a.level == b.level && a.advice == b.advice && !a.advice.empty();
}

}  // namespace

std::vector<std::vector<Finding>> findingsByCure(const std::vector<Finding>& findings) {
  std::vector<std::vector<Finding>> rows;
  for (const Finding& f : findings) {
    const auto same =
        std::ranges::find_if(rows, [&](const auto& row) { return haveOneCure(row.front(), f); });
    if (same == rows.end()) {
      rows.push_back({f});
    } else {
      same->push_back(f);
    }
  }
  // Stable: within a level the rules keep their order.
  std::ranges::stable_sort(rows, std::greater(), [](const auto& row) { return row.front().level; });
  return rows;
}

Verdict makeVerdict(std::vector<Finding> findings) {
  Verdict verdict;
  for (const Finding& finding : findings) verdict.level = std::max(verdict.level, finding.level);
  verdict.findings = std::move(findings);
  return verdict;
}

const Finding* gravest(const Verdict& verdict) {
  // A good verdict has findings of its level, too, but none to tell of.
  if (verdict.level == VerdictLevel::kGood) return nullptr;
  const auto worst = std::ranges::find(verdict.findings, verdict.level, &Finding::level);
  return worst == verdict.findings.end() ? nullptr : &*worst;
}

std::vector<std::string> cameraNames(const std::vector<CalibrationScore>& scores) {
  std::vector<std::string> names;
  for (const CalibrationScore& score : scores) {
    for (const std::string& name : score.cameras) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

const ErrorStatistics* errorsOf(const CalibrationScore& score, const std::string& camera) {
  const auto name = std::ranges::find(score.cameras, camera);
  const auto i = static_cast<std::size_t>(name - score.cameras.begin());
  const bool known = i < std::min(score.cameras.size(), score.per_camera.size());
  return known ? &score.per_camera[i] : nullptr;
}

std::string partName(const CalibrationScore& score) {
  return score.label + "/" + score.session + "/" + score.part;
}

Named<ErrorStatistics> errorsByCamera(const CalibrationScore& score) {
  Named<ErrorStatistics> errors;
  for (std::size_t c = 0; c < score.per_camera.size(); ++c) {
    errors.emplace_back(c < score.cameras.size() ? score.cameras[c] : "cam" + std::to_string(c),
                        score.per_camera[c]);
  }
  return errors;
}

void setErrorsByCamera(const Named<ErrorStatistics>& errors, CalibrationScore& score) {
  score.cameras.clear();
  score.per_camera.clear();
  for (const auto& [name, statistics] : errors) {
    score.cameras.push_back(name);
    score.per_camera.push_back(statistics);
  }
}

const std::vector<CameraCalibration>& CalibrationRecord::cameras() const {
  static const std::vector<CameraCalibration> kNone;
  if (camera_imu) return camera_imu->cameras;
  return camera ? camera->cameras : kNone;
}

std::string partName(const CameraEntry& camera) { return camera.camera.name; }

std::vector<CameraEntry> cameraEntries(const CalibrationRecord& record) {
  std::vector<CameraEntry> entries;
  const StageSummary* last = record.camera ? &record.camera->summary : nullptr;
  if (record.camera_imu) last = &record.camera_imu->summary;
  // Without any stage there are no cameras either, and `last` is not looked at.
  for (std::size_t i = 0; i < record.cameras().size(); ++i) {
    CameraEntry& entry = entries.emplace_back(CameraEntry{record.cameras()[i], std::nullopt});
    if (i < last->per_camera.size()) entry.rmse_px = last->per_camera[i].rmse_px;
  }
  return entries;
}

std::optional<double> ParameterEstimate::halfWidth90() const {
  // Infinite degrees of freedom: the quantile is the normal distribution's.
  if (!robust_std) return plumbline::halfWidth90(std, std::numeric_limits<double>::infinity());
  if (!robust_dof) return std::nullopt;
  return plumbline::halfWidth90(*robust_std, *robust_dof);
}

std::vector<ParameterEstimate> parameterEstimates(const CalibrationRecord& record, Stage stage) {
  const bool first = stage == Stage::kCamera;
  if (first ? !record.camera : !record.camera_imu) return {};
  const auto& cameras = first ? record.camera->cameras : record.camera_imu->cameras;
  const auto& summary = first ? record.camera->summary : record.camera_imu->summary;
  const auto& spread = first ? record.camera_resample : record.camera_imu_resample;
  const Eigen::VectorXd deviations = summary.covariance.standardDeviations();
  std::vector<ParameterEstimate> estimates;
  for (std::size_t i = 0; i < summary.covariance.names.size(); ++i) {
    const std::string& name = summary.covariance.names[i];
    const auto value = valueOf(record, name, cameras);
    if (!value) continue;
    const Robust robust = robustOf(record, stage, i);
    estimates.push_back({name, *value, deviations[static_cast<Eigen::Index>(i)],
                         summary.covariance.units[i], spreadOf(spread, name), robust.std,
                         robust.dof});
  }
  return estimates;
}

std::optional<double> shownOffsetStd(const CalibrationRecord& record) {
  for (const ParameterEstimate& e : parameterEstimates(record, Stage::kCameraImu)) {
    if (e.name == "time_offset") return e.shownStd();
  }
  return std::nullopt;
}

}  // namespace plumbline

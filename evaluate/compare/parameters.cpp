// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/parameters.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

using Calibrations = std::vector<Calibration>;

/// A camera's or the IMU's transform, where the calibration has it.
using TransformOf = std::function<const Transform*(const Calibration&)>;

/// Of the difference; none without both deviations, as for norms.
void addSignificance(ComparedParameter& row) {
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    std::optional<double> sigmas;
    if (i > 0 && row.difference[i] && row.std[i] && row.std[0]) {
      // As of independent estimates. Those of one recording share its noise, and what they differ
      // by is more significant than this says.
      const EstimatedVariance both = sumOf(row.variance(i), row.variance(0));
      if (both.value > 0) sigmas = normalDeviate(*row.difference[i], both);
    }
    row.significance.push_back(sigmas);
    row.levels.push_back(kThresholds.levelOf(sigmas.value_or(0)));
  }
}

/// The rows of calibrationParameters(), those of the first calibration in front.
std::vector<ComparedParameter> listedRows(const Calibrations& calibrations) {
  std::vector<std::vector<CalibrationParameter>> lists;
  for (const Calibration& c : calibrations) lists.push_back(calibrationParameters(c));
  std::vector<ComparedParameter> rows;
  for (const auto& list : lists) {
    for (const CalibrationParameter& p : list) {
      if (findBy(rows, &ComparedParameter::name, p.name)) continue;
      rows.push_back({p.name, p.unit, {}, {}, {}, {}});
    }
  }
  for (ComparedParameter& row : rows) {
    for (const auto& list : lists) {
      const auto* p = findBy(list, &CalibrationParameter::name, row.name);
      row.values.push_back(p ? std::optional(p->value) : std::nullopt);
      row.std.push_back(p ? p->std : std::nullopt);
      row.dof.push_back(p ? p->dof : std::nullopt);
    }
    if (std::ranges::none_of(row.dof, [](const auto& d) { return d.has_value(); })) {
      row.dof.clear();
    }
    row.difference.assign(lists.size(), std::nullopt);
  }
  return rows;
}

/// By position: listedRows() puts the first calibration's parameters in front, in the order of
/// calibrationChange(). NaN marks what does not compare.
void addChanges(const Calibrations& calibrations, std::vector<ComparedParameter>& rows) {
  for (std::size_t i = 1; i < calibrations.size(); ++i) {
    const Eigen::VectorXd change = calibrationChange(calibrations[i], calibrations[0]);
    for (Eigen::Index k = 0; k < change.size(); ++k) {
      if (std::isfinite(change[k])) rows[static_cast<std::size_t>(k)].difference[i] = change[k];
    }
  }
}

using NumberOf = std::function<std::optional<double>(const Calibration&)>;

/// A row of plain numbers that some calibrations have.
ComparedParameter numberRow(const std::string& name, const std::string& unit,
                            const Calibrations& calibrations, const NumberOf& number_of) {
  ComparedParameter row{name, unit, {}, {}, {}, {}};
  for (const Calibration& c : calibrations) {
    row.values.push_back(number_of(c));
    const bool known = row.values.size() > 1 && row.values.back() && row.values[0];
    row.difference.push_back(known ? std::optional(*row.values.back() - *row.values[0])
                                   : std::nullopt);
  }
  row.std.resize(calibrations.size());
  return row;
}

/// calibrationParameters() has camera 0's offset; tools with a single one are compared with the
/// mean over cameras.
void meanOffsets(const Calibrations& calibrations, std::vector<ComparedParameter>& rows) {
  ComparedParameter* row = findBy(rows, &ComparedParameter::name, "time_offset");
  if (!row) return;
  ComparedParameter mean = numberRow(row->name, row->unit, calibrations, [](const Calibration& c) {
    return c.imu ? std::optional(meanTimeOffset(*c.imu)) : std::nullopt;
  });
  // Still of camera 0's offset, the only deviation that files state.
  mean.std = row->std;
  mean.dof = row->dof;
  *row = mean;
}

void addNorms(const std::string& name, const TransformOf& transform_of,
              const Calibrations& calibrations, std::vector<ComparedParameter>& rows) {
  const auto of = [&](double (*norm)(const Transform&)) -> NumberOf {
    return [&transform_of, norm](const Calibration& c) {
      const Transform* T = transform_of(c);
      return T ? std::optional(norm(*T)) : std::nullopt;
    };
  };
  ComparedParameter angle = numberRow(name + ".angle", "rad", calibrations,
                                      of([](const Transform& T) { return rotationAngle(T.R); }));
  ComparedParameter lever = numberRow(name + ".lever", "m", calibrations,
                                      of([](const Transform& T) { return T.t.norm(); }));
  const Transform* first = transform_of(calibrations[0]);
  for (std::size_t i = 1; i < calibrations.size(); ++i) {
    const Transform* T = transform_of(calibrations[i]);
    if (!T || !first) continue;
    // By Log, which is exact near zero, where the angle from the trace is not.
    const Vector6d d = boxminus(*T, *first);
    angle.difference[i] = d.tail<3>().norm();
    lever.difference[i] = d.head<3>().norm();
  }
  rows.push_back(angle);
  rows.push_back(lever);
}

/// A row for each camera as soon as one calibration has offsets of its own; the others then have
/// the common one there.
void addCameraOffsets(const Calibrations& calibrations, std::vector<ComparedParameter>& rows) {
  std::size_t cameras = 0;
  for (const Calibration& c : calibrations) {
    if (!c.imu || !haveOwnOffsets(c.imu->time_offsets)) continue;
    cameras = std::max(cameras, c.imu->time_offsets.size());
  }
  for (std::size_t i = 0; i < cameras; ++i) {
    // Also those with one offset for all: every camera has that one.
    const auto offset_of = [i](const Calibration& c) {
      const bool has = c.imu && i < c.cameras.size();
      return has ? std::optional(c.imu->timeOffset(i)) : std::nullopt;
    };
    rows.push_back(numberRow(fmt::format("time_offset.cam{}", i), "s", calibrations, offset_of));
  }
}

/// Names of the camera at a place where all calibrations that have it call it the same, as
/// covariances and maps do: with --only it may not be that of its place.
void nameCameras(const Calibrations& calibrations, std::vector<ComparedParameter>& rows) {
  std::map<std::string, std::string> names;  // by "camI"
  const auto& first = calibrations.front().cameras;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const bool agreed = std::ranges::all_of(calibrations, [&](const Calibration& c) {
      return i >= c.cameras.size() || c.cameras[i].name == first[i].name;
    });
    if (!agreed) return;
    names[fmt::format("cam{}", i)] = first[i].name;
  }
  for (ComparedParameter& row : rows) {
    const std::size_t dot = row.name.find('.');
    if (dot == std::string::npos) continue;
    const std::string owner = row.name.substr(0, dot), part = row.name.substr(dot + 1);
    if (names.contains(owner)) row.name = names[owner] + "." + part;
    if (owner == "time_offset" && names.contains(part)) row.name = owner + "." + names[part];
  }
}

}  // namespace

VerdictLevel ComparisonThresholds::levelOf(double sigmas) const {
  if (sigmas >= significance) return VerdictLevel::kBad;
  return sigmas >= notable ? VerdictLevel::kCaution : VerdictLevel::kGood;
}

std::vector<ComparedParameter> comparedParameters(const Calibrations& calibrations) {
  if (calibrations.empty()) return {};
  std::vector<ComparedParameter> rows = listedRows(calibrations);
  addChanges(calibrations, rows);
  meanOffsets(calibrations, rows);
  std::size_t cameras = 0;
  bool imu = false;
  for (const Calibration& c : calibrations) {
    cameras = std::max(cameras, c.cameras.size());
    imu = imu || c.imu.has_value();
  }
  for (std::size_t i = 1; i < cameras; ++i) {
    const TransformOf of = [i](const Calibration& c) {
      return i < c.cameras.size() ? &c.cameras[i].T_C0Ci : nullptr;
    };
    addNorms(fmt::format("T_C0C{}", i), of, calibrations, rows);
  }
  const TransformOf imu_of = [](const Calibration& c) { return c.imu ? &c.imu->T_SC0 : nullptr; };
  if (imu) addNorms("T_SC0", imu_of, calibrations, rows);
  addCameraOffsets(calibrations, rows);
  for (ComparedParameter& row : rows) addSignificance(row);
  nameCameras(calibrations, rows);
  return rows;
}

void removeTimeOffset(std::size_t calibration, std::vector<ComparedParameter>& rows) {
  for (ComparedParameter& row : rows) {
    if (row.name != "time_offset" && !row.name.starts_with("time_offset.")) continue;
    row.values[calibration].reset();
    row.std[calibration].reset();
    for (std::size_t i = 0; i < row.values.size(); ++i) {
      // All differences are to the first.
      if (i != calibration && calibration != 0) continue;
      row.difference[i].reset();
      row.significance[i].reset();
      row.levels[i] = VerdictLevel::kGood;
    }
  }
}

OffsetSummary offsetSummary(const std::string& label, const Calibration& calibration) {
  OffsetSummary summary;
  summary.label = label;
  if (!calibration.imu) return summary;
  summary.time_offset_s = meanTimeOffset(*calibration.imu);
  summary.std_s = calibration.imu->time_offset_std_s;
  const TimeOffsets& offsets = calibration.imu->time_offsets;
  for (std::size_t c = 0; haveOwnOffsets(offsets) && c < offsets.size(); ++c) {
    summary.per_camera_s.push_back(offsetOf(offsets, c));
  }
  return summary;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>

#include "report/store/run_rows.h"

namespace plumbline::store_internal {
namespace {

/// The parameters of one calibration, those that it has.
std::vector<ParameterEstimate> estimatesOf(const ComparisonRecord& record, std::size_t k) {
  std::vector<ParameterEstimate> estimates;
  for (const ComparedParameter& p : record.parameters) {
    if (k >= p.values.size() || !p.values[k]) continue;
    const auto std = k < p.std.size() ? p.std[k] : std::nullopt;
    estimates.push_back({p.name, *p.values[k], std.value_or(std::nan("")), p.unit, std::nullopt});
  }
  return estimates;
}

std::vector<ParameterEstimate> estimatesOf(const PerturbationRecord& record,
                                           const PerturbationCase& c, bool is_base) {
  std::vector<ParameterEstimate> estimates;
  for (std::size_t i = 0; i < c.values.size() && i < record.parameters.size(); ++i) {
    const double std = is_base ? record.base_std[i] : std::nan("");
    estimates.push_back({record.parameters[i], c.values[i], std, record.units[i], std::nullopt});
  }
  return estimates;
}

/// Tells equal labels apart: "x", "x #2", ...
std::string unique(const std::string& label, std::map<std::string, int>& seen) {
  const int n = ++seen[label];
  return n > 1 ? label + " #" + std::to_string(n) : label;
}

}  // namespace

std::vector<StageParameters> parametersOf(const CalibrationRecord& record) {
  return {{"camera", parameterEstimates(record, Stage::kCamera)},
          {"camera_imu", parameterEstimates(record, Stage::kCameraImu)}};
}

std::vector<StageParameters> parametersOf(const ComparisonRecord& record) {
  std::vector<StageParameters> stages;
  std::map<std::string, int> seen;
  for (std::size_t k = 0; k < record.calibrations.size(); ++k) {
    stages.push_back({unique(record.calibrations[k].label, seen), estimatesOf(record, k)});
  }
  return stages;
}

std::vector<StageParameters> parametersOf(const PerturbationRecord& record) {
  std::vector<StageParameters> stages{{"base", estimatesOf(record, record.base, true)}};
  std::map<std::string, int> seen;
  for (const PerturbationCase& c : record.cases) {
    stages.push_back({unique(partName(c), seen), estimatesOf(record, c, false)});
  }
  return stages;
}

std::vector<StageParameters> parametersOf(const TrajectoryRecord& /*record*/) { return {}; }
std::vector<StageParameters> parametersOf(const ReplayRecord& /*record*/) { return {}; }

}  // namespace plumbline::store_internal

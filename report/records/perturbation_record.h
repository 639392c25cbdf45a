// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline {

/// One calibration of a perturbation study.
struct PerturbationCase {
  std::string kind;
  double amount = 0;
  std::string unit;
  std::uint64_t seed = 0;
  std::string problem;
  double rmse_px = 0;
  int frames = 0, iterations = 0;
  double time_offset_s = 0;
  std::optional<double> time_offset_std_s;
  double offset_error_s = 0;
  std::vector<double> values, changes, changes_sigma;
};

/// "+10 ms", "x0.5": a factor has no sign that adds.
inline std::string amountText(const PerturbationCase& c) {
  std::ostringstream text;
  if (c.unit == "x") {
    text << c.unit << c.amount;
  } else {
    text << std::showpos << c.amount << std::noshowpos << ' ' << c.unit;
  }
  return text.str();
}

/// "imu-shift +10 ms", "corner-noise +0.1 px seed 2": what metrics are stored under.
inline std::string partName(const PerturbationCase& c) {
  std::ostringstream text;
  text << c.kind << ' ' << std::showpos << c.amount << std::noshowpos << ' ' << c.unit;
  if (c.seed != 0) text << " seed " << c.seed;
  return text.str();
}

void fields(auto& v, PerturbationCase& c) {
  v("kind", c.kind,
    "`imu-shift`, `target-size`, `noise-densities`, `initial-intrinsics`, `dropped-frames`, "
    "`dropped-imu`, `corner-noise`; `base`: as recorded");
  v("amount", c.amount, "how much, in `unit`");
  v("unit", c.unit, "`ms`, `%`, `x` (a factor), `px`");
  v.ifSet("seed", c.seed, "of what was drawn; absent where nothing was");
  v.derived("solved", c.problem.empty(), "1", "whether there is a result");
  v.ifSet("problem", c.problem, "why it failed");
  if (!c.problem.empty()) return;
  v("rmse_px", c.rmse_px, "px", "sqrt(mean |e|^2)");
  v("frames", c.frames, "1", "in the solution");
  v("iterations", c.iterations, "1", "of the solver");
  v("time_offset_s", c.time_offset_s, "s", "recovered");
  v("time_offset_std_s", c.time_offset_std_s, "s", "its standard deviation");
  v("offset_error_s", c.offset_error_s, "s", "recovered - injected - base");
  v("values", c.values, "of the study's `parameters`");
  v.ifSet("changes", c.changes, "from the base's values, rotations as Log(R R_base^T) [rad]");
  v.ifSet("changes_sigma", c.changes_sigma, "the same, over the base's standard deviations");
}

/// Place, among `parameters`, of the one other than the time offset that moved by most of its
/// standard deviations: one whose change is not finite before all others; one that has no
/// standard deviation does not count. Empty: there is none.
inline std::optional<std::size_t> largestOtherChange(const std::vector<std::string>& parameters,
                                                     const PerturbationCase& c) {
  std::optional<std::size_t> worst;
  for (std::size_t i = 0; i < std::min(parameters.size(), c.changes_sigma.size()); ++i) {
    if (parameters[i] == "time_offset") continue;
    // What has no value after the change has moved further than any number tells.
    if (i < c.changes.size() && !std::isfinite(c.changes[i])) return i;
    // Without a deviation of the base there is nothing to count in.
    if (!std::isfinite(c.changes_sigma[i])) continue;
    if (!worst || std::abs(c.changes_sigma[i]) > std::abs(c.changes_sigma[*worst])) worst = i;
  }
  return worst;
}

/// A parameter of a study.
struct StudyParameter {
  std::string name, unit;
  double base_std = 0;
};

void fields(auto& v, StudyParameter& p) {
  v("name", p.name, "as in a covariance");
  v("unit", p.unit, "its unit");
  v("base_std", p.base_std, "standard deviation in the base calibration");
}

/// A perturbation study: one base calibration, and one for every case.
struct PerturbationRecord {
  std::string name;
  Provenance provenance;
  Assumptions assumptions;
  Verdict verdict;
  std::vector<std::string> parameters, units;
  std::vector<double> base_std;
  double offset_bound_s = 1e-3;
  PerturbationCase base;
  std::vector<PerturbationCase> cases;
};

/// Whether time offsets were estimated: not by a study of cameras alone.
inline bool hasOffset(const PerturbationRecord& record) {
  return std::ranges::find(record.parameters, "time_offset") != record.parameters.end();
}

/// perturbation.json.
template <class V>
void fields(V& v, PerturbationRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("session", r.name, "its name");
  std::vector<StudyParameter> parameters;
  for (std::size_t i = 0; i < r.parameters.size(); ++i) {
    parameters.push_back({r.parameters[i], r.units[i], r.base_std[i]});
  }
  v("parameters", parameters, "of `values` and `changes`");
  if constexpr (V::kReads) {
    r.parameters.clear(), r.units.clear(), r.base_std.clear();
    for (const StudyParameter& p : parameters) {
      r.parameters.push_back(p.name);
      r.units.push_back(p.unit);
      r.base_std.push_back(p.base_std);
    }
  }
  v("offset_bound_s", r.offset_bound_s, "s", "an injected offset counts as recovered within this");
  v("base", r.base, "the recording as it is");
  v("cases", r.cases, "one calibration each");
  v("assumptions", r.assumptions, "assumptions of covariances and verdict");
  v("verdict", r.verdict, "what the study shows");
  v("provenance", r.provenance, "where the result comes from");
}

}  // namespace plumbline

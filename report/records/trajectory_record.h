// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "report/records/calibration_record.h"
#include "report/records/trajectory_run.h"

namespace plumbline {

/// A calibration over all runs of one sequence, or of all ("").
struct RunsSummary {
  std::string sequence, calibration;
  std::size_t expected = 0, complete = 0, partial = 0, failed = 0;
  double completion = 0;
  std::optional<double> ate_median_m;
  VerdictLevel level = VerdictLevel::kGood;
};

inline std::string partName(const RunsSummary& s) { return s.sequence + "/" + s.calibration; }

void fields(auto& v, RunsSummary& s) {
  v.ifSet("sequence", s.sequence, "absent: over all sequences");
  v("calibration", s.calibration, "whose runs");
  v("expected", s.expected, "1", "runs");
  v("complete", s.complete, "1", "of them");
  v("partial", s.partial, "1", "of them");
  v("failed", s.failed, "1", "of them");
  v("completion", s.completion, "1", "complete / expected");
  v("ate_median_m", s.ate_median_m, "m",
    "median ATE over the expected runs, a run that is not complete counts as infinite; absent "
    "where the median is infinite");
  v("level", s.level, "`bad` where a run failed, `caution` where one is partial");
}

/// Two calibrations over the same sequences and runs: d = ATE under b - ATE under a, where ATE is
/// the RMSE of the positions [m]. Negative: b is better.
struct PairedDifference {
  std::string a, b;
  std::size_t pairs = 0, left_out = 0;
  double mean_m = 0, median_m = 0, std_m = 0;
  std::size_t b_better = 0, ties = 0;
  double sign_test_p = 1;
  /// The least n of five and more with (t_{0.975, n-1} + t_{0.8, n-1}) s / sqrt(n) <= |mean|, s the
  /// spread of the sequences' means. Empty below three sequences.
  std::optional<double> pairs_needed;
  std::optional<double> low_m, high_m;  ///< of `mean_interval_m`
  std::string better;
};

inline std::string partName(const PairedDifference& d) { return d.b + " - " + d.a; }

template <class V>
void fields(V& v, PairedDifference& d) {
  v("a", d.a, "first calibration");
  v("b", d.b, "second: d = ATE under b - ATE under a; negative: b is better");
  v("pairs", d.pairs, "1", "complete under both; without any, the figures below are absent");
  v("left_out", d.left_out, "1", "(sequence, run) under either that is not complete under both");
  if (d.pairs == 0 && !V::kAll) return;
  v("mean_m", d.mean_m, "m", "of the sequences' means of d");
  v("median_m", d.median_m, "m", "of d");
  v("std_m", d.std_m, "m", "of d, divisor n");
  v("b_better", d.b_better, "1", "pairs with d < 0");
  v("ties", d.ties, "1", "pairs with d = 0");
  v("sign_test_p", d.sign_test_p, "1",
    "two-sided, exact (binomial), of the signs of the sequences' means of d; means of 0 are left "
    "out");
  v("pairs_needed", d.pairs_needed, "1",
    "sequences, a pair each, that would show such a mean at 95 % in 4 of 5 studies, by the spread "
    "of their means; at least 5");
  std::optional<std::array<double, 2>> interval;
  if (d.low_m && d.high_m) interval = {*d.low_m, *d.high_m};
  v("mean_interval_m", interval, "m",
    "95 % interval of the mean: Student's t over sequences; absent below 5");
  if constexpr (V::kReads) {
    d.low_m.reset();
    d.high_m.reset();
    if (interval) d.low_m = (*interval)[0], d.high_m = (*interval)[1];
  }
  v.ifSet("better", d.better, "which has the lower errors; absent where the interval contains 0");
}

/// What moving one parameter of a calibration does to the ATE (RMSE of positions) of a sequence.
struct ParameterSensitivity {
  std::string name, unit;
  double step = 0;
  std::optional<double> plus_m, minus_m, change_m;
  bool above_chance = false;
};

void fields(auto& v, ParameterSensitivity& p) {
  v("name", p.name, "e.g. `T_SC0.ty`");
  v("unit", p.unit, "`px`, `-`, `m`, `rad`, `s`");
  v("step", p.step, "change of the parameter, in `unit`");
  v("plus_m", p.plus_m, "m", "change of the ATE with + step; absent where the run failed");
  v("minus_m", p.minus_m, "m", "with - step; absent for the difference of two calibrations");
  v("change_m", p.change_m, "m", "mean of both; absent where a run failed");
  v.ifSet("above_chance", p.above_chance, "the change is more than twice `noise_m`");
}

inline std::string partName(const ParameterSensitivity& p) { return p.name; }

/// Every parameter of a calibration moved by itself.
struct CalibrationSensitivity {
  std::string sequence, calibration, towards;
  double ate_m = 0;
  std::optional<double> noise_m;  ///< empty where fewer than two of its runs have an ATE
  std::optional<double> whole_m, sum_m, interaction_m;
  std::vector<ParameterSensitivity> parameters;
};

inline std::string partName(const CalibrationSensitivity& s) {
  return s.sequence + "/" + s.calibration + (s.towards.empty() ? "" : "/" + s.towards);
}

void fields(auto& v, CalibrationSensitivity& s) {
  v("sequence", s.sequence, "on which it was run");
  v("calibration", s.calibration, "whose parameters are changed");
  v.ifSet("towards", s.towards, "whose values they take; absent: steps are standard deviations");
  v("ate_m", s.ate_m, "m", "unmoved");
  v("noise_m", s.noise_m, "m", "standard deviation of the ATE under changes of 1e-3 steps");
  v("whole_m", s.whole_m, "m", "ATE under `towards` - `ate_m`");
  v("sum_m", s.sum_m, "m", "of all changes; absent where one is missing");
  v("interaction_m", s.interaction_m, "m", "whole - sum: what single changes do not explain");
  v("parameters", s.parameters, "each changed by itself, the largest effect first");
}

/// Runs, and what they say together.
struct TrajectoryStudy {
  std::vector<TrajectoryRun> runs;
  std::vector<RunsSummary> summary;
  std::vector<PairedDifference> paired;
  std::vector<CalibrationSensitivity> sensitivity;
};

/// Each calibration over everything: over all sequences, or the only one.
inline std::vector<RunsSummary> overAll(const TrajectoryStudy& study) {
  std::vector<RunsSummary> all;
  for (const RunsSummary& s : study.summary) {
    if (s.sequence.empty()) all.push_back(s);
  }
  return all.empty() ? study.summary : all;
}

void fields(auto& v, TrajectoryStudy& s) {
  v("summary", s.summary, "completion and error by sequence, then over all");
  v("paired", s.paired, "every two calibrations over the same sequences and runs");
  v.ifSet("sensitivity", s.sensitivity, "effect of each parameter on the ATE");
  v("runs", s.runs, "each estimate against its truth");
}

/// What the verdict of trajectories is called where nothing is amiss: an error has no level, for
/// what it may be depends on the use.
constexpr const char* kCompleteWord = "complete";

/// What `evaluate trajectory` found, for one run or many.
struct TrajectoryRecord : TrajectoryStudy {
  std::string name;
  Provenance provenance;
  Verdict verdict;
};

/// trajectory.json.
void fields(auto& v, TrajectoryRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("name", r.name, "of the study");
  fields(v, static_cast<TrajectoryStudy&>(r));
  v("verdict", r.verdict, "how far the figures can be trusted");
  v("provenance", r.provenance, "where the result comes from");
}

/// One estimate judged by itself.
struct SingleTrajectory {
  TrajectoryRun run;
  Verdict verdict;
  Provenance provenance;
};

/// `evaluate trajectory --json`: the run's fields at the top.
void fields(auto& v, SingleTrajectory& s) {
  fields(v, s.run);
  v("verdict", s.verdict, "how far the figures may be trusted");
  v("provenance", s.provenance, "where the result comes from");
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/trajectory_metric_options.h"

#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/shared_options.h"

namespace plumbline {
namespace {

constexpr double kLongestTime = 4e9;  // [s], more than any two clocks differ; holds as nanoseconds
constexpr double kNarrowest = 0.05, kWidest = 600;  // [s] of the search for a clock offset

void declarePairing(CLI::App& app, TrajectoryMetricWords& o) {
  AssociationOptions& pairing = o.request.metrics.association;
  addWithDefault(app, "--association", o.association,
                 "How stamps are paired: one-to-one, interpolate, evo, rpg or ov_eval");
  addWithDefault(app, "--max-dt", pairing.max_dt_s, "Largest difference of paired stamps [s]")
      ->check(numberWithin(0, kLongestTime));
  addWithDefault(app, "--max-gap", pairing.max_gap_s,
                 "interpolate: widest gap of the truth to interpolate over [s]")
      ->check(numberWithin(0, kLongestTime));
  addWithDefault(app, "--time-offset", pairing.time_offset_s,
                 "Add this to the estimate's stamps before pairing [s]")
      ->check(numberWithin(-kLongestTime, kLongestTime));
}

void declareFrames(CLI::App& app, TrajectoryMetricWords& o) {
  TrajectoryRequest& r = o.request;
  addWithDefault(app, "--clock-offset", o.clock_offset,
                 "t_truth - t_estimate: auto (from angular rates), seconds, or none");
  app.add_option("--clock-range", o.clock_range_s,
                 fmt::format("auto: search within +- this around --time-offset [s] (default: {:g})",
                             ClockOffsetOptions{}.max_offset_s))
      ->check(numberWithin(kNarrowest, kWidest));
  addWithDefault(app, "--hand-eye", o.hand_eye,
                 "Transform from marker body to the estimate's body: auto (estimated, and applied "
                 "to the truth) or none");
  app.add_flag("--estimate-w-first", r.estimate_w_first,
               "The estimate is TUM with quaternions w x y z");
  app.add_flag("--truth-w-first", r.truth_w_first, "The truth is TUM with quaternions w x y z");
  app.add_flag("--estimate-inverted", r.estimate_inverted,
               "The estimate's quaternions map the world into the body");
  app.add_flag("--truth-inverted", r.truth_inverted,
               "The truth's quaternions map the world into the body");
}

void declareErrors(CLI::App& app, TrajectoryMetricWords& o) {
  addWithDefault(app, "--align", o.align,
                 "Alignment: se3, sim3, scale, yaw, origin, se3-first, yaw-first or none");
  addWithDefault(app, "--align-first", o.request.metrics.alignment.first_n,
                 "Align by the first N pairs only (0: all)")
      ->check(numberFrom(0));
  addWithDefault(app, "--rpe", o.rpe,
                 "Segment lengths of relative errors (RPE): 1m,10m,1frames,0.5s, or none");
  addWithDefault(app, "--rpe-pairs", o.rpe_pairs,
                 "Pair selection for the RPE: plumbline (from every pose, within 10 % along the "
                 "truth), evo (consecutive segments along the estimate), evo-all (from every pose "
                 "along the estimate), rpg (within 20 %) or ov_eval (within 0.5 m)");
}

// --clock-offset in seconds; "none" is 0.
double knownOffset(const std::string& word) {
  // What auto finds comes on top of --time-offset, around which it searches.
  if (word == "none" || word == "auto") return 0;
  const auto value = finiteNumber(word);
  if (!value || std::abs(*value) > kLongestTime) {
    throw InputError(
        fmt::format("--clock-offset {}: expected auto, none, or seconds, e.g. -0.035", word));
  }
  return *value;
}

std::vector<RelativeDelta> pairedBy(const std::string& word, std::vector<RelativeDelta> deltas) {
  const RelativePairs pairs = enumValue<RelativePairs>("--rpe-pairs", word);
  for (RelativeDelta& delta : deltas) {
    // Not left to be an empty table: the rule never selects any.
    if (!hasPairsOver(pairs, delta.unit)) {
      throw InputError(fmt::format(
          "--rpe-pairs {}: this rule selects no pairs over {}; expected --rpe in metres, e.g. 8m",
          word, toString(delta.unit)));
    }
    delta.pairs = pairs;
  }
  return deltas;
}

}  // namespace

void declareTrajectoryMetrics(CLI::App& app, TrajectoryMetricWords& words) {
  declarePairing(app, words);
  declareFrames(app, words);
  declareErrors(app, words);
}

void declareCoverage(CLI::App& app, TrajectoryMetricWords& o) {
  addWithDefault(app, "--min-coverage", o.min_coverage,
                 "Share of the truth's time span below which a run is partial")
      ->check(numberWithin(0, 1));
  addWithDefault(app, "--coverage-from", o.coverage_from,
                 "Where that span starts: start (of the truth) or first-pose (of the estimate)");
  app.add_option("--max-ate", o.max_ate_m,
                 "ATE [m] above which a run has diverged (default: the ATE of an estimate that "
                 "never moves; half of it with --align sim3)")
      ->check(positiveNumber());
}

TrajectoryRequest judgedAs(const TrajectoryMetricWords& o) {
  TrajectoryRequest request = o.request;
  TrajectoryMetricOptions& metrics = request.metrics;
  metrics.association.rule = enumValue<AssociationRule>("--association", o.association);
  // Both are added to the estimate's stamps (t_truth - t_estimate), so that they add up.
  metrics.association.time_offset_s += knownOffset(o.clock_offset);
  if (o.clock_offset == "auto") {
    metrics.clock = ClockOffsetOptions{};
    if (o.clock_range_s) metrics.clock->max_offset_s = *o.clock_range_s;
  } else if (o.clock_range_s) {
    throw InputError(
        "--clock-range is of the search of --clock-offset auto; give both, or omit it");
  }
  metrics.hand_eye = wordFrom<bool>("--hand-eye", o.hand_eye, {{"auto", true}, {"none", false}});
  metrics.alignment.kind = enumValue<AlignmentKind>("--align", o.align);
  metrics.rpe = pairedBy(o.rpe_pairs, relativeDeltasFrom(o.rpe));
  metrics.coverage = wordFrom<CoverageSpan>(
      "--coverage-from", o.coverage_from,
      {{"start", CoverageSpan::kTruth}, {"first-pose", CoverageSpan::kFirstPose}});
  return request;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/atomic_file.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/trajectory_options.h"
#include "evaluate/cli/trajectory_summary.h"
#include "evaluate/workflow/evaluate_trajectory.h"
#include "evaluate/workflow/trajectory_document.h"

namespace plumbline {
namespace {

constexpr const char* kStandardOutput = "-";

struct Options {
  std::string estimate, truth;
  std::string align = "se3", association = "one-to-one", rpe = "1m", body, estimate_format, format;
  int align_first = 0;
  double max_dt_s = AssociationOptions{}.max_dt_s;
  double max_gap_s = AssociationOptions{}.max_gap_s;
  double time_offset_s = 0;
  std::optional<std::string> json;
};

void declarePairing(CLI::App& app, Options& o) {
  app.add_option("--association", o.association,
                 "How stamps are paired: one-to-one, interpolate, evo, rpg or ov_eval")
      ->capture_default_str();
  app.add_option("--max-dt", o.max_dt_s, "Largest difference of paired stamps [s]")
      ->capture_default_str();
  app.add_option("--max-gap", o.max_gap_s, "interpolate: widest gap of the truth to bridge [s]")
      ->capture_default_str();
  app.add_option("--time-offset", o.time_offset_s, "Add this to the estimate's stamps first [s]")
      ->capture_default_str();
}

void declareMetrics(CLI::App& app, Options& o) {
  app.add_option("--align", o.align, "se3, sim3, scale, yaw, origin, se3-first, yaw-first or none")
      ->capture_default_str();
  app.add_option("--align-first", o.align_first, "Align by the first N pairs only (0: all)")
      ->capture_default_str();
  app.add_option("--rpe", o.rpe, "Distances of relative errors: 1m,10m,1frames,0.5s, or none")
      ->capture_default_str();
}

void declareFiles(CLI::App& app, Options& o) {
  app.add_option("estimate", o.estimate, "Estimated trajectory: TUM, EuRoC or KITTI")->required();
  app.add_option("truth", o.truth, "Ground truth: TUM, EuRoC, KITTI, Motive's or Vicon's CSV")
      ->required();
  app.add_option("--format", o.format,
                 "Format of the truth: tum, euroc, kitti, motive, vicon (default: by content)");
  app.add_option("--estimate-format", o.estimate_format, "Format of the estimate, as --format");
  app.add_option("--body", o.body, "Rigid body of a motion-capture export");
  app.add_option("--json", o.json, "File to write the figures to; - for standard output");
}

constexpr double kLongest = 4e9;  // [s], more than any two clocks differ; holds as nanoseconds

double secondsFrom(const char* name, double value, double least) {
  if (!(value >= least && value <= kLongest)) {
    throw InputError(
        fmt::format("{} {}: expected seconds, from {:g} to {:g}", name, value, least, kLongest));
  }
  return value;
}

TrajectoryMetricOptions metricsOf(const Options& o) {
  TrajectoryMetricOptions metrics;
  metrics.association = {associationFrom(o.association), secondsFrom("--max-dt", o.max_dt_s, 0),
                         secondsFrom("--max-gap", o.max_gap_s, 0),
                         secondsFrom("--time-offset", o.time_offset_s, -kLongest)};
  if (o.align_first < 0) {
    throw InputError(
        fmt::format("--align-first {}: expected a number of pairs, or 0 for all", o.align_first));
  }
  metrics.alignment.kind = alignmentFrom(o.align);
  metrics.alignment.first_n = o.align_first;
  metrics.rpe = relativeDeltasFrom(o.rpe);
  return metrics;
}

TrajectoryRequest requestOf(const Options& o) {
  TrajectoryRequest request;
  request.estimate = o.estimate;
  request.truth = o.truth;
  request.metrics = metricsOf(o);
  if (!o.format.empty()) request.read_truth.format = trajectoryFormatFrom(o.format);
  if (!o.estimate_format.empty()) {
    request.read_estimate.format = trajectoryFormatFrom(o.estimate_format);
  }
  request.read_truth.body = o.body;
  return request;
}

int evaluateTrajectoryFiles(const Options& o) {
  const Result<TrajectoryEvaluation> result = evaluateTrajectory(requestOf(o));
  if (!result) {
    fmt::print(stderr, "plumbline: {}; {}\n", result.failure().message, result.failure().cure);
    return kFailed;
  }
  if (o.json == kStandardOutput) {
    fmt::print("{}", trajectoryDocument(*result));
    return kDone;
  }
  fmt::print("{}", trajectorySummary(*result));
  if (o.json) {
    writeFileAtomically(*o.json, trajectoryDocument(*result));
    fmt::print("\nFigures: {}\n", *o.json);
  }
  return kDone;
}

}  // namespace

Command evaluateTrajectoryCommand() {
  return {"trajectory", "Errors of an estimated trajectory against ground truth",
          "plumbline evaluate trajectory estimate.txt groundtruth.csv --align se3 --rpe 1m,10m",
          [](CLI::App& app) {
            auto options = std::make_shared<Options>();
            declareFiles(app, *options);
            declarePairing(app, *options);
            declareMetrics(app, *options);
            return std::function<int()>([options] { return evaluateTrajectoryFiles(*options); });
          }};
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/session/session_folder.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/trajectory_metric_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/trajectory/verdict.h"
#include "evaluate/odometry/run_odometry.h"
#include "evaluate/results/provenance.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "evaluate/trajectory/summary.h"
#include "report/html/pages.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

constexpr int kMostMegabytes = 1 << 24;  // 16 TB

struct OdometryCommandOptions {
  OdometryRequest request;
  std::string with = "builtin";
  std::string estimate = toString(HintKind::kNone);
  TrajectoryMetricWords metrics;
  ResultOptions output;
};

void declareOdometry(CLI::App& app, OdometryCommandOptions& o) {
  OdometryRequest& r = o.request;
  app.add_option("sequence", r.sequences, "EuRoC or TUM-VI folders: images, IMU, ground truth")
      ->required();
  app.add_option("--calibration", r.calibrations,
                 "Calibration to compare, in any format; repeatable")
      ->required()
      ->allow_extra_args(false);
  addWithDefault(app, "--with", o.with,
                 "builtin, orbslam3, openvins, a runner's .yaml, or a command with {settings}, "
                 "{sequence}, {output}");
  app.add_option("--executable", r.executable, "Program of orbslam3, openvins or the runner");
  addWithDefault(app, "--runs", r.runs,
                 "Runs per sequence and calibration (0: as many as the system needs; builtin: 1)")
      ->check(numberFrom(0));
  app.add_option("--imu", r.imu, "IMU noise (Kalibr's imu.yaml) for all calibrations");
  app.add_option(
      "--truth", r.truth,
      "Ground truth, with {sequence} for several (default: the sequence's own, if there is one)");
  app.add_flag("--sensitivity", r.sensitivity,
               "builtin: also the sensitivity of the ATE to each parameter, changed by its std and "
               "to the other calibrations' values (about 60 runs)");
  addWithDefault(app, "--estimate", o.estimate,
                 "Also estimate, as a hint, the values that the odometry prefers: offset, or "
                 "extrinsics (offset and T_SC0). builtin: 3 to 15, or 36 to 180, additional runs; "
                 "openvins: one additional run with online calibration")
      ->check(CLI::IsMember({"none", "offset", "extrinsics"}));
  addWithDefault(app, "--cameras", r.builtin.cameras, "builtin: use the first N cameras (0: all)")
      ->check(numberFrom(0));
  addWithDefault(app, "--time-limit", r.run_seconds,
                 "Limit on the wall time of an external system's run [s]")
      ->check(positiveNumber());
  addWithDefault(app, "--memory-limit", r.memory_mb, "Limit on its address space [MB] (0: none)")
      ->check(numberWithin(0, kMostMegabytes));
  addWithDefault(app, "--threads", r.threads, "Parallel runs (0: all cores)")->check(numberFrom(0));
  o.output.declareResult(app);
  declareCoverage(app, o.metrics);
  declareTrajectoryMetrics(app, o.metrics);
}

/// Not a command whose last word is a file of settings: that has fields, as {sequence}.
bool isRunnerFile(const std::string& with) {
  std::error_code unknown;
  return with.ends_with(".yaml") &&
         (with.find('{') == std::string::npos || std::filesystem::exists(with, unknown));
}

/// Names that are known come first, then files; what is left is a command to run.
std::optional<Runner> runnerFrom(const std::string& with) {
  if (with == "builtin") return std::nullopt;
  if (auto known = knownRunner(with)) return known;
  return isRunnerFile(with) ? readRunner(with) : runnerOf(with);
}

/// --cameras: with fewer than it asks for, a calibration would be compared on others' terms.
void checkCameras(const OdometryRequest& request) {
  const int cameras = request.builtin.cameras;
  if (cameras == 0) return;
  if (request.runner) throw InputError("--cameras is of the built-in odometry; omit it");
  for (const std::string& path : request.calibrations) {
    const std::size_t known = readCalibration(path).cameras.size();
    if (static_cast<std::size_t>(cameras) <= known) continue;
    throw InputError(path, 0,
                     fmt::format("has {} camera{}; expected {} or more; correct --cameras", known,
                                 known == 1 ? "" : "s", cameras));
  }
}

OdometryRequest odometryRequest(const OdometryCommandOptions& o) {
  OdometryRequest request = o.request;
  request.runner = runnerFrom(o.with);
  if (!request.runner && !request.executable.empty()) {
    throw InputError(
        "--executable: the built-in odometry has none; choose an external system by --with");
  }
  request.output_w_first = o.metrics.request.estimate_w_first;
  request.output_inverted = o.metrics.request.estimate_inverted;
  if (!request.runner && (request.output_w_first || request.output_inverted)) {
    throw InputError(
        "--estimate-w-first and --estimate-inverted are of what an external system writes; choose "
        "one by --with, or omit them");
  }
  checkCameras(request);
  // Never empty: CLI11 has let through known words only.
  request.hint = *enumFrom<HintKind>(o.estimate);
  request.how = judgedAs(o.metrics);
  // Estimates are written here, as this program has them.
  request.how.estimate_w_first = request.how.estimate_inverted = false;
  setLimits(o.metrics, request);
  return request;
}

/// What is read, the files beside the sequences too: no output may replace it, and it is hashed.
std::vector<std::string> inputsOf(const OdometryCommandOptions& o) {
  const OdometryRequest& r = o.request;
  std::vector<std::string> inputs = r.sequences;
  append(inputs, r.calibrations);
  if (r.imu) inputs.push_back(*r.imu);
  if (isRunnerFile(o.with)) inputs.push_back(o.with);
  if (!r.truth) return inputs;
  for (const std::string& sequence : r.sequences) {
    inputs.push_back(filledIn(*r.truth, {{"sequence", findSession(sequence).name}}));
  }
  return inputs;
}

/// "MH_01, MH_02".
std::string namesOf(const std::vector<std::string>& sequences) {
  return joined(sequences, [](const std::string& folder) { return findSession(folder).name; });
}

int runOdometryCommand(const OdometryCommandOptions& o, const CLI::App& app) {
  const OdometryRequest request = odometryRequest(o);
  const std::vector<std::string> inputs = inputsOf(o);
  ResultWriter out(o.output, o.output.request("odometry", inputs));
  ProgressBar bar;
  // The trajectories that are run become part of the result: OUT/runs.
  TrajectoryRecord record = runOdometry(request, out.path(), bar.sink());
  bar.clear();
  record.verdict = trajectoryVerdict(record);
  record.name = out.name();
  record.provenance = makeProvenance("odometry", givenOptions(app));
  record.provenance.input_hash = inputFilesHash(inputs);
  record.provenance.input = namesOf(request.sequences);
  return out.finish(record,
                    {{"odometry.json", documentOf(record)}, {"trajectory.csv", runsTable(record)}},
                    renderTrajectoryPage,
                    runsSummary(record) + odometrySummary(record) + "\n" +
                        verdictText(record.verdict, kCompleteWord));
}

}  // namespace

Command odometryCommand() {
  return {"odometry", "Run an odometry with each calibration and compare the trajectory errors",
          "plumbline odometry MH_01 --calibration ours/calibration.json --calibration kalibr.yaml "
          "--out loop",
          withOptions(declareOdometry, runOdometryCommand)};
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/evaluate_runs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/trajectory/errors.h"
#include "evaluate/metrics/trajectory/run_comparison.h"
#include "evaluate/results/progress.h"
#include "evaluate/trajectory/find_runs.h"

namespace plumbline {
namespace {

struct Truth {
  std::filesystem::path path;
  TrajectoryFile file;
};

using Truths = std::map<std::string, Truth>;  // by sequence; under "" where one serves all

/// Every truth is read once, whatever number of runs it judges. Throws for the first that is bad.
Truths readTruths(const RunsRequest& request) {
  if (hasField(request.truth, "run") || hasField(request.truth, "calibration")) {
    throw InputError(request.truth, 0,
                     "a truth has no {run} and no {calibration}: expected {sequence} alone, or a "
                     "file");
  }
  Truths truths;
  for (const RunFile& file : findRuns(request.truth)) truths[file.sequence].path = file.path;
  if (truths.empty()) {
    throw InputError(request.truth, 0, "matches no file; expected the truth of each sequence");
  }
  std::vector<Truth*> list;
  for (auto& [sequence, truth] : truths) list.push_back(&truth);
  parallelFor(list.size(), request.threads, [&](int, std::size_t i) {
    TrajectoryRequest how = request.how;
    how.truth = list[i]->path;
    list[i]->file = readTruth(how);
  });
  return truths;
}

const Truth* truthOf(const Truths& truths, const std::string& sequence) {
  // A truth without {sequence} serves every sequence.
  const auto found = truths.find(truths.count("") > 0 ? "" : sequence);
  return found == truths.end() ? nullptr : &found->second;
}

constexpr std::size_t kNamed = 5;  // of a list in a message

/// "'MH_01', 'MH_02' and 3 more".
template <class Names>
std::string someOf(const Names& names) {
  std::vector<std::string> quoted;
  for (const std::string& name : names) {
    if (quoted.size() < kNamed) quoted.push_back("'" + name + "'");
  }
  const std::string text = fmt::format("{}", fmt::join(quoted, ", "));
  const std::size_t rest = names.size() - quoted.size();
  return rest == 0 ? text : fmt::format("{} and {} more", text, rest);
}

std::string namesOf(const Truths& truths) {
  std::vector<std::string> names;
  for (const auto& [sequence, truth] : truths) names.push_back(sequence);
  return someOf(names);
}

/// Where no run at all has a truth it is the patterns that do not go together.
void refuseWithoutTruths(const std::vector<RunFile>& files, const Truths& truths,
                         const RunsRequest& request) {
  std::set<std::string> sequences;
  for (const RunFile& file : files) {
    if (truthOf(truths, file.sequence) != nullptr) return;
    sequences.insert(file.sequence);
  }
  throw InputError(request.runs, 0,
                   fmt::format("has the sequences {}, and {} has the truths {}: none in common; "
                               "name what differs between repetitions {{run}}, e.g. "
                               "'{{sequence}}_{{run}}.txt'",
                               someOf(sequences), request.truth, namesOf(truths)));
}

void refuseUnknown(const std::vector<RunFile>& files, const RunsRequest& request) {
  const std::vector<std::string>& known = request.calibrations;
  if (known.empty()) return;
  if (!hasField(request.runs, "calibration")) {
    throw InputError(request.runs, 0,
                     "does not state which calibration a run belongs to; expected {calibration}");
  }
  for (const RunFile& file : files) {
    if (std::ranges::find(known, file.calibration) != known.end()) continue;
    throw InputError(file.path.string(), 0,
                     fmt::format("'{}' is none of the calibrations, which are labelled {}; name "
                                 "them as the files do, with --labels",
                                 file.calibration, fmt::join(known, ", ")));
  }
}

// Every calibration with every (sequence, run) that one of them has.
std::vector<TrajectoryRun> expectedRuns(const std::vector<RunFile>& files,
                                        const std::vector<std::string>& known) {
  // Sets and maps, so that the order of the runs is that of their names and not that of a folder's
  // listing.
  std::set<std::string> calibrations(known.begin(), known.end());
  for (const RunFile& file : files) calibrations.insert(file.calibration);
  std::map<std::tuple<std::string, std::string, std::string>, std::string> paths;
  for (const RunFile& file : files) {
    // Without a file the run stays in the list, to count as failed: leaving it out would make a
    // calibration that loses track look better.
    for (const std::string& c : calibrations) paths.try_emplace({file.sequence, c, file.run});
    paths[{file.sequence, file.calibration, file.run}] = file.path.string();
  }
  std::vector<TrajectoryRun> runs;
  for (const auto& [key, path] : paths) {
    TrajectoryRun& run = runs.emplace_back();
    std::tie(run.sequence, run.calibration, run.run) = key;
    run.estimate = path;
  }
  return runs;
}

/// Partial below the coverage asked for; says so where the late start alone is to blame.
TrajectoryRun withCompletion(TrajectoryRun run, double min_coverage) {
  if (run.coverage >= min_coverage) return run;
  run.status = RunStatus::kPartial;
  run.problem = coverageText(run.coverage, min_coverage, "the truth's");
  if (run.coverage_from_first_pose >= min_coverage) {
    run.problem += fmt::format(
        "; its first pose is {:.1f} s after the truth's: --coverage-from first-pose ignores the "
        "time before it",
        run.starts_late_s);
  }
  return run;
}

/// What is wrong with the ATE of a run that diverged; empty where it did not.
std::string divergenceOf(const TrajectoryRun& run, const RunsRequest& request) {
  // An estimate that stands still has the truth's spread as its ATE, after the best alignment.
  // A least-squares scale (sim3) may shrink an estimate to a point, which has just this ATE, so
  // that none exceeds it: half of it is an estimate that explains three quarters of the squared
  // distances. Its spread is of the truth as kept for plots, every k-th matched pose.
  const bool shrinks = run.alignment.kind == toString(AlignmentKind::kSim3);
  const double limit = request.max_ate_m.value_or((shrinks ? 0.5 : 1) * spreadOf(run.truth_m));
  const double ate = run.ate_translation_m.rmse;
  if (ate <= limit) return "";  // NaN, too, has diverged
  const char* which = request.max_ate_m ? "the limit"
                      : shrinks         ? "half the ATE of an estimate that never moves"
                                        : "the ATE of an estimate that never moves";
  return fmt::format("diverged: ATE {:.3f} m, more than {:.3f} m ({})", ate, limit, which);
}

/// Failed where it diverged, else complete or partial.
TrajectoryRun withStatus(TrajectoryRun run, const RunsRequest& request) {
  const std::string divergence = divergenceOf(run, request);
  if (!divergence.empty()) return failedRun(std::move(run), divergence);
  return withCompletion(std::move(run), request.min_coverage);
}

// "results/V1_01.txt": "V1_01"; in a folder of EuRoC's layout the recording's name.
std::string nameOfFile(const std::filesystem::path& file) {
  static const std::set<std::string> kLayout{
      "data", "mav0", "vicon0", "leica0", "state_groundtruth_estimate0", "groundtruth"};
  std::string name = file.stem().string();
  for (auto folder = std::filesystem::absolute(file).parent_path();
       kLayout.count(name) > 0 && folder.has_filename(); folder = folder.parent_path()) {
    name = folder.filename().string();
  }
  return name;
}

TrajectoryRun judged(const TrajectoryRun& expected, const Truths& truths,
                     const RunsRequest& request) {
  if (expected.estimate.empty()) {
    return failedRun(expected, "no file, though another calibration has this sequence and run");
  }
  const Truth* truth = truthOf(truths, expected.sequence);
  if (truth == nullptr) {
    return failedRun(expected, fmt::format("no truth for the sequence '{}': {} has {}",
                                           expected.sequence, request.truth, namesOf(truths)));
  }
  return judgedRun(expected, truth->path, truth->file, request);
}

}  // namespace

std::string coverageText(double share, double least, const char* of_what) {
  constexpr int kMostDigits = 9;
  int digits = 1;
  const auto shown = [&] { return fmt::format("{:.{}f}", 100 * share, digits); };
  while (digits < kMostDigits && std::stod(shown()) >= 100 * least) ++digits;
  return fmt::format("covers {} % of {} time, less than {:g} %", shown(), of_what, 100 * least);
}

TrajectoryRun judgedRun(const TrajectoryRun& expected, const std::filesystem::path& truth_path,
                        const TrajectoryFile& truth, const RunsRequest& request) {
  TrajectoryRequest how = request.how;
  how.truth = truth_path;
  how.estimate = expected.estimate;
  try {
    auto result = evaluateFiles(readEstimate(how), truth, how);
    if (!result) return failedRun(expected, problemOf(result.failure()));
    TrajectoryRun run = std::move(result).value();
    run.sequence = expected.sequence;
    run.calibration = expected.calibration;
    run.run = expected.run;
    return withStatus(std::move(run), request);
    // A bad file is the failure of this run and does not end those of the others.
  } catch (const InputError& error) {
    return failedRun(expected, error.what());
  }
}

void RunsRequest::check() const {
  how.metrics.check();
  if (!(min_coverage >= 0 && min_coverage <= 1))
    throw InputError("the least coverage must be a share, 0 to 1");
  if (max_ate_m && !(*max_ate_m > 0))
    throw InputError("the ATE above which a run has diverged must be positive");
  if (threads < 0) throw InputError(fmt::format("{} threads: expected 0 or more", threads));
}

TrajectoryRecord evaluateRuns(const RunsRequest& request) {
  request.check();
  const Truths truths = readTruths(request);
  std::vector<std::string> sequences;
  for (const auto& [sequence, truth] : truths) {
    if (!sequence.empty()) sequences.push_back(sequence);
  }
  const std::vector<RunFile> files = findRuns(request.runs, sequences);
  if (files.empty()) {
    throw InputError(request.runs, 0,
                     "matches no file; expected estimates, e.g. "
                     "'results/{calibration}/{sequence}_{run}.txt'");
  }
  refuseUnknown(files, request);
  refuseWithoutTruths(files, truths, request);
  std::vector<TrajectoryRun> runs = expectedRuns(files, request.calibrations);
  parallelFor(runs.size(), request.threads,
              [&](int, std::size_t i) { runs[i] = judged(runs[i], truths, request); });
  return {studyOf(std::move(runs)), "", {}, {}};
}

TrajectoryRecord studyOfOne(TrajectoryRun run, const RunsRequest& request) {
  run.sequence = nameOfFile(run.truth);
  run.run = nameOfFile(run.estimate);
  const std::string name = run.run;
  // Whoever looks at one run wants its errors, however large; among others it is no complete one.
  const std::string divergence = divergenceOf(run, request);
  run = withCompletion(std::move(run), request.min_coverage);
  if (!divergence.empty()) {
    run.status = RunStatus::kPartial;
    run.problem = divergence;
  }
  return {studyOf({std::move(run)}), name, {}, {}};
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/evaluate_runs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "datasets/files/numbers.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/trajectory/verdict.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExample = "e.g. 'results/{calibration}/{sequence}_{run}.txt'";

/// The text as a regular expression that stands for itself.
std::string escaped(const std::string& text) {
  static const std::regex special(R"([.^$|()\[\]{}*+?\\])");
  return std::regex_replace(text, special, R"(\$&)");
}

// What stands for a field: one of `words` if there are any.
std::string groupOf(const std::string& field, std::vector<std::string> words) {
  if (field == "run") return "([^/_]+)";
  if (words.empty()) return "([^/]+)";
  // Longest first: of alternatives a regular expression takes the first that fits, so that "MH_01"
  // does not take what is "MH_01_easy"'s.
  std::sort(words.begin(), words.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  });
  std::string group;
  for (const std::string& word : words) group += (group.empty() ? "(" : "|") + escaped(word);
  return group + ")";
}

struct Matcher {
  std::regex expression;
  std::vector<std::string> fields;  // of the groups, in their order
};

/// The pattern as a regular expression of the whole path, a group for each field at its first
/// place.
Matcher matcherOf(const std::string& pattern, const std::vector<std::string>& sequences) {
  Matcher matcher;
  std::string expression;
  std::size_t at = 0;
  while (at < pattern.size()) {
    const std::size_t open = std::min(pattern.find('{', at), pattern.size());
    expression += escaped(pattern.substr(at, open - at));
    if (open == pattern.size()) break;
    const std::size_t close = pattern.find('}', open);
    const std::string field =
        close == std::string::npos ? "" : pattern.substr(open + 1, close - open - 1);
    if (field != "sequence" && field != "calibration" && field != "run") {
      throw InputError(pattern, 0,
                       fmt::format("expected the fields {{sequence}}, {{calibration}} and {{run}}, "
                                   "{}",
                                   kExample));
    }
    const auto known = std::find(matcher.fields.begin(), matcher.fields.end(), field);
    if (known != matcher.fields.end()) {
      // A field that stands twice has to stand for the same text: a back reference.
      expression += fmt::format("\\{}", known - matcher.fields.begin() + 1);
    } else {
      matcher.fields.push_back(field);
      expression += groupOf(field, field == "sequence" ? sequences : std::vector<std::string>());
    }
    at = close + 1;
  }
  matcher.expression = std::regex(expression);
  return matcher;
}

std::optional<RunFile> matched(const std::string& path, const Matcher& matcher) {
  std::smatch match;
  if (!std::regex_match(path, match, matcher.expression)) return std::nullopt;
  RunFile file;
  file.path = path;
  for (std::size_t i = 0; i < matcher.fields.size(); ++i) {
    const std::string& field = matcher.fields[i];
    (field == "sequence" ? file.sequence
     : field == "run"    ? file.run
                         : file.calibration) = match[i + 1];
  }
  return file;
}

// The folder above the first field, and how many levels the pattern goes down from there.
struct Reach {
  std::string folder;
  int depth = 0;
};

Reach reachOf(const std::string& pattern) {
  const std::size_t field = pattern.find('{');
  const std::size_t slash = pattern.rfind('/', field);
  const std::size_t rest = slash == std::string::npos ? 0 : slash + 1;
  const auto below =
      std::count(pattern.begin() + static_cast<std::ptrdiff_t>(rest), pattern.end(), '/');
  return {slash == std::string::npos ? "." : pattern.substr(0, rest), static_cast<int>(below)};
}

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

void refuseUnknown(const std::vector<RunFile>& files, const RunsRequest& request) {
  const std::vector<std::string>& known = request.calibrations;
  if (known.empty()) return;
  if (!hasField(request.runs, "calibration")) {
    throw InputError(request.runs, 0,
                     "does not state which calibration a run belongs to; expected {calibration}");
  }
  for (const RunFile& file : files) {
    if (std::find(known.begin(), known.end(), file.calibration) != known.end()) continue;
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

/// RMS distance of points from their mean. It is taken of the truth as kept for plots, every k-th
/// matched pose.
double spreadOf(const std::vector<Eigen::Vector3d>& points) {
  const auto n = static_cast<double>(points.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / n;
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += (p - mean).squaredNorm() / n;
  return std::sqrt(sum);
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
  // distances.
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
  if (truth == nullptr) return failedRun(expected, "no truth for this sequence");
  return judgedRun(expected, truth->path, truth->file, request);
}

}  // namespace

bool hasField(const std::string& pattern, const std::string& field) {
  return pattern.find("{" + field + "}") != std::string::npos;
}

std::vector<RunFile> findRuns(const std::string& pattern,
                              const std::vector<std::string>& sequences) {
  if (pattern.find('{') == std::string::npos) return {{pattern, "", "", ""}};
  const Matcher known = matcherOf(pattern, sequences), any = matcherOf(pattern, {});
  const Reach reach = reachOf(pattern);
  if (!fs::is_directory(reach.folder)) {
    throw InputError(
        reach.folder, 0,
        fmt::format("is not a folder; it stands before the first field of {}", pattern));
  }
  std::vector<RunFile> files;
  for (auto it = fs::recursive_directory_iterator(reach.folder);
       it != fs::recursive_directory_iterator(); ++it) {
    // Files stand as deep as the pattern says; below lie whatever other results there are.
    if (it.depth() >= reach.depth) it.disable_recursion_pending();
    if (it.depth() != reach.depth || !it->is_regular_file()) continue;
    std::string path = it->path().generic_string();
    // A pattern without a folder looks into ".", whose entries have "./" in front.
    if (pattern.find('/') == std::string::npos) path = it->path().filename().string();
    // By the known sequences first: greedy fields alone would split names at the last underscore.
    auto file = matched(path, known);
    if (!file) file = matched(path, any);
    if (file && !isUtf8(path)) {
      throw InputError(path, 0, "has a name that is not UTF-8; rename it");
    }
    if (file) files.push_back(*file);
  }
  std::sort(files.begin(), files.end(),
            [](const RunFile& a, const RunFile& b) { return a.path < b.path; });
  return files;
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

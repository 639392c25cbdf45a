// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/process/process.h"
#include "evaluate/results/progress.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/text.h"
#include "evaluate/study/engine/engines.h"
#include "evaluate/study/run_step.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kAttempts = 3;           // at a step that is lost, though within its limits
constexpr double kTellEvery = 1;       // [s]
constexpr double kBeyondLimits = 120;  // [s] that a step's own process gets to end it

// Seconds of a step that was never done: orders of magnitude, for sessions of a minute.
const std::map<StepKind, double> kGuessedS{{StepKind::kDetect, 60},    {StepKind::kBoard, 3},
                                           {StepKind::kCalibrate, 3},  {StepKind::kPerturb, 5},
                                           {StepKind::kEvaluate, 0.3}, {StepKind::kCompare, 4},
                                           {StepKind::kEstimate, 60},  {StepKind::kTrajectory, 0.2},
                                           {StepKind::kOdometry, 5},   {StepKind::kReplay, 120}};

class LocalEngine {
 public:
  LocalEngine(const fs::path& night, const std::vector<Step>& steps, int jobs,
              const NightSink& sink)
      : night_(night),
        steps_(steps),
        sink_(sink),
        jobs_(static_cast<std::size_t>(threadCount(jobs))),
        seconds_(estimateSeconds(night, steps)),
        results_(settledResults(night, steps)) {
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (results_.count(steps[i].name) == 0) waiting_.insert(i);
      for (const StepNeed& need : steps[i].needs) dependents_[need.name].push_back(i);
    }
    // Of the steps to do, so that an unchanged night begins at its end.
    progress_.all = waiting_.size();
    // From the last to the first: whatever waits for a step comes after it.
    urgency_.resize(steps.size());
    for (std::size_t i = steps.size(); i-- > 0;) {
      // A step's urgency is the length of the longest chain from it to the end [s]: the critical
      // path goes first.
      double longest = 0;
      for (const std::size_t later : dependents_[steps[i].name]) {
        longest = std::max(longest, urgency_[later]);
      }
      urgency_[i] = seconds_.at(steps[i].name) + longest;
      if (waiting_.count(i) > 0) total_s_ += seconds_.at(steps[i].name);
    }
  }

  StepResults run() {
    for (;;) {
      start();
      if (running_.empty()) break;
      std::vector<ChildProcess*> children;
      for (const auto& [step, child] : running_) children.push_back(child.get());
      ChildProcess::waitForAny(children, kTellEvery);
      collect();
    }
    return std::move(results_);
  }

 private:
  enum class Need { kDone, kPending, kFailed };
  Need needOf(const Step& step) const {
    Need all = Need::kDone;
    for (const StepNeed& need : step.needs) {
      // Without a result a step is left out, or yet to be done.
      const auto result = results_.find(need.name);
      if (result == results_.end()) {
        if (left_out_.count(need.name) > 0) return Need::kFailed;
        all = Need::kPending;
      } else if (result->second.status != StepStatus::kDone) {
        return Need::kFailed;
      }
    }
    return all;
  }

  // Steps whose needs are done, the most urgent first; what can never be done is left out on the
  // way. One pass is enough: steps stand after what they need.
  std::vector<std::size_t> ready() {
    std::vector<std::size_t> list;
    for (auto it = waiting_.begin(); it != waiting_.end();) {
      const Need need = needOf(steps_[*it]);
      if (need == Need::kFailed) {
        left_out_.insert(steps_[*it].name);
        total_s_ -= seconds_.at(steps_[*it].name);
        --progress_.all;
        it = waiting_.erase(it);
        continue;
      }
      if (need == Need::kDone) list.push_back(*it);
      ++it;
    }
    std::ranges::stable_sort(list, std::greater(), [&](std::size_t i) { return urgency_[i]; });
    return list;
  }

  void start() {
    if (running_.size() >= jobs_) return;
    const std::vector<std::size_t> list = ready();
    // More threads than one only where the steps that are left cannot occupy all cores.
    const std::size_t wide = std::max<std::size_t>(1, running_.size() + waiting_.size());
    const std::size_t threads = wide < jobs_ ? jobs_ / wide : 1;
    for (const std::size_t i : list) {
      if (running_.size() >= jobs_) return;
      waiting_.erase(i);
      launch(i, threads);
    }
  }

  void launch(std::size_t i, std::size_t threads) {
    ++attempts_[i];
    // If the process dies without a result, an older one must not pass for its own.
    forgetResult(night_ / steps_[i].name);
    ProcessRequest request;
    request.words = {kRunningProgram,        "study",        "run-step",
                     night_.string(),        steps_[i].name, "--threads",
                     std::to_string(threads)};
    request.log = night_ / kEngineLog;
    // The step's process watches over its command's limit itself and writes why it ended; this is
    // for one that hangs.
    request.limit_s = steps_[i].limit_s + kBeyondLimits;
    running_.emplace_back(i, std::make_unique<ChildProcess>(request));
  }

  void collect() {
    for (auto it = running_.begin(); it != running_.end();) {
      const auto end = it->second->waitFor(0);
      if (!end) {
        ++it;
        continue;
      }
      const std::size_t step = it->first;
      it = running_.erase(it);
      finish(step, *end);
    }
    tell("", "");
  }

  void finish(std::size_t i, const ProcessEnd& end) {
    const Step& step = steps_[i];
    // What an earlier plan left under this name does not count. A step that ran into its own limit
    // is not tried again: it would once more.
    auto result = readStepResult(night_ / step.name);
    if (result && result->key != step.key) result.reset();
    const bool lost =
        !result || (result->status == StepStatus::kLost && result->seconds < step.limit_s);
    // A step that hung beyond all limits would do so again, for as long.
    if (lost && !end.beyond_time && attempts_[i] < kAttempts) {
      waiting_.insert(i);
      return;
    }
    if (!result) {
      const std::string how = end.signal != 0 ? fmt::format("signal {}", end.signal)
                                              : fmt::format("exit code {}", end.exit_code);
      result = recordLost(night_, step,
                          fmt::format("its process ended without a result ({}), {} times; see {}",
                                      how, attempts_[i], (night_ / kEngineLog).string()));
    }
    ++progress_.done;
    spent_s_ += result->seconds;
    expected_s_ += seconds_.at(step.name);
    total_s_ -= seconds_.at(step.name);
    const bool failed = result->status != StepStatus::kDone;
    if (failed) ++progress_.failed;
    results_[step.name] = *result;
    tell(step.name, failed ? result->message : "");
  }

  // Estimates are corrected by how far those of the steps done were off. As if all that is left
  // could run at once: where it is one chain, it takes longer.
  void tell(const std::string& step, const std::string& message) {
    progress_.step = step;
    progress_.message = message;
    const double correction = expected_s_ > 0 ? spent_s_ / expected_s_ : 1;
    progress_.seconds_left = correction * total_s_ / static_cast<double>(jobs_);
    if (sink_) sink_(progress_);
  }

  const fs::path night_;
  const std::vector<Step>& steps_;
  const NightSink& sink_;
  const std::size_t jobs_;
  const std::map<std::string, double> seconds_;
  StepResults results_;
  std::set<std::size_t> waiting_;
  std::set<std::string> left_out_;
  std::map<std::string, std::vector<std::size_t>> dependents_;
  std::vector<double> urgency_;
  std::map<std::size_t, int> attempts_;
  std::vector<std::pair<std::size_t, std::unique_ptr<ChildProcess>>> running_;  // by step
  NightProgress progress_;
  double total_s_ = 0, spent_s_ = 0, expected_s_ = 0;
};

}  // namespace

std::map<std::string, double> estimateSeconds(const fs::path& night,
                                              const std::vector<Step>& steps) {
  std::map<std::string, double> seconds;
  std::map<StepKind, std::vector<double>> of_kind;
  for (const Step& step : steps) {
    // Under any key: another version or other data take about as long.
    const auto before = readStepResult(night / step.name);
    if (!before || before->status != StepStatus::kDone) continue;
    seconds[step.name] = before->seconds;
    of_kind[step.kind].push_back(before->seconds);
  }
  for (const Step& step : steps) {
    if (seconds.count(step.name) > 0) continue;
    const auto known = of_kind.find(step.kind);
    seconds[step.name] = known == of_kind.end() ? kGuessedS.at(step.kind) : median(known->second);
  }
  return seconds;
}

StepResults runLocally(const fs::path& night, const std::vector<Step>& steps, int jobs,
                       const NightSink& sink) {
  return LocalEngine(night, steps, jobs, sink).run();
}

std::vector<std::vector<Step>> unsettledStages(const fs::path& night,
                                               const std::vector<Step>& steps) {
  const StepResults settled = settledResults(night, steps);
  std::map<std::string, std::size_t> stage_of;  // of those to do
  std::vector<std::vector<Step>> stages;
  for (const Step& step : steps) {
    if (settled.count(step.name) > 0) continue;
    // The longest chain of unsettled needs before it; those that are settled hold nothing up.
    std::size_t stage = 0;
    for (const StepNeed& need : step.needs) {
      const auto before = stage_of.find(need.name);
      if (before != stage_of.end()) stage = std::max(stage, before->second + 1);
    }
    stage_of[step.name] = stage;
    if (stages.size() <= stage) stages.resize(stage + 1);
    stages[stage].push_back(step);
  }
  return stages;
}

std::string commandList(const fs::path& night, const std::vector<Step>& steps,
                        const std::string& study, const std::string& out) {
  const std::string program = shellWords({thisProgram()});
  Text text;
  int number = 0;
  for (const std::vector<Step>& stage : unsettledStages(night, steps)) {
    add(text, "# stage {}: {} commands\n", ++number, stage.size());
    for (const Step& step : stage) {
      // Names of steps need no quotes: they are made of names that nameOf() lets pass.
      add(text, "{} study run-step {} {}\n", program, shellWords({night.string()}), step.name);
    }
  }
  add(text, "# then\n{} study {} --out {}\n", program,
      shellWords({fs::absolute(study).lexically_normal().string()}),
      shellWords({fs::absolute(out).lexically_normal().string()}));
  return fmt::to_string(text);
}

}  // namespace plumbline

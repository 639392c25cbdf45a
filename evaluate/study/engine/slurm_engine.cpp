// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "calibrator/base/option_check.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "evaluate/study/engine/slurm_round.h"
#include "evaluate/study/run_step.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNightFile = "night.txt";  // whose folder this is: number and since
constexpr auto kPollEvery = std::chrono::milliseconds(500);
// Polls in a row in which no job is known and none has left word: then nothing more will come.
constexpr int kSilentPolls = 6;
// Polls in a row in which Slurm does not answer, five minutes or more: it may be restarting, and
// its jobs run on.
constexpr int kUnansweredPolls = 600;

struct Word {
  bool merged = false;
  SlurmEnd end;
};

fs::path wordFile(const fs::path& night, int round) {
  return night / kSlurmFolder / fmt::format("round_{}.json", round);
}

/// Word of a round that ended, written whole: what the waiting process reads is never half of it.
void leaveWord(const fs::path& night, int round, const Word& word) {
  const nlohmann::ordered_json json{
      {"merged", word.merged}, {"exit_code", word.end.exit_code}, {"text", word.end.text}};
  writeFileAtomically(wordFile(night, round).string(), json.dump() + "\n");
}

/// None until the merging job has left it; a file of another form counts as none.
std::optional<Word> readWord(const fs::path& night, int round) {
  const fs::path file = wordFile(night, round);
  if (!fs::exists(file)) return std::nullopt;
  const auto json = nlohmann::json::parse(MappedFile(file.string()).text(), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return Word{json.value("merged", false), {json.value("exit_code", 1), json.value("text", "")}};
}

void tell(const NightSink& sink, const PreparedNight& night, NightProgress& progress) {
  std::size_t done = 0, failed = 0;
  for (const auto& [name, result] : settledResults(night.folder, night.steps)) {
    ++done;
    if (result.status == StepStatus::kFailed) ++failed;
  }
  progress.all = night.steps.size();
  progress.step = done == progress.done ? "" : "step";
  progress.done = done;
  progress.failed = failed;
  if (sink) sink(progress);
}

// What the merging job said; empty where all jobs are gone without a word.
std::optional<Word> awaitWord(const PreparedNight& night, int round,
                              const std::vector<std::string>& jobs, const NightSink& sink) {
  NightProgress progress;
  // A job that has just ended may have left squeue before its file is seen here.
  for (int silent = 0, unanswered = 0; silent < kSilentPolls;) {
    if (auto word = readWord(night.folder, round)) return word;
    try {
      silent = anyJobLeft(night.folder / kSlurmFolder, jobs) ? 0 : silent + 1;
      unanswered = 0;
    } catch (const BadInput&) {
      if (++unanswered == kUnansweredPolls) throw;
    }
    tell(sink, night, progress);
    std::this_thread::sleep_for(kPollEvery);
  }
  return readWord(night.folder, round);
}

/// Names of the steps that nothing kept from being done, and that are not settled.
std::set<std::string> lostSteps(const PreparedNight& night, const StepResults& settled) {
  std::set<std::string> lost;
  for (const auto& stage : unsettledStages(night.folder, night.steps)) {
    for (const Step& step : stage) {
      // What needs a step that failed is missing for good.
      const bool could = std::ranges::all_of(step.needs, [&](const auto& need) {
        const auto result = settled.find(need.name);
        return result != settled.end() && result->second.status == StepStatus::kDone;
      });
      if (could) lost.insert(step.name);
    }
  }
  return lost;
}

/// Those that were lost in the last round say how; of those that left no result at all that is
/// recorded.
void addLost(const PreparedNight& night, const std::set<std::string>& lost, const fs::path& logs,
             StepResults& results) {
  for (const Step& step : night.steps) {
    auto result = readStepResult(night.folder / step.name);
    if (!result || result->key != step.key) {
      // A result under another key is of the state before an input or the program changed: it
      // stays, and the step is not done.
      if (!lost.contains(step.name) || fs::exists(night.folder / step.name / kStepFile)) continue;
      result =
          recordLost(night.folder, step,
                     fmt::format("it has left no result on the cluster; see {}", logs.string()));
    }
    results.emplace(step.name, *result);  // does not replace what is settled
  }
}

}  // namespace

void refuseWhileUnderWay(const fs::path& night) {
  const fs::path folder = night / kSlurmFolder;
  std::ifstream file(folder / kSlurmJobsFile);
  const std::vector<std::string> jobs{std::istream_iterator<std::string>(file), {}};
  if (jobs.empty()) return;
  bool left = false;
  try {
    left = anyJobLeft(folder, jobs);
  } catch (const BadInput& error) {
    throw badInput(
        (folder / kSlurmJobsFile).string(),
        {InputFault::kOther,
         fmt::format("lists jobs of a night on Slurm, and it cannot be told whether they "
                     "run: {}",
                     error.what()),
         "", "run the night where squeue is, or remove this file if they have ended"});
  }
  if (!left) {
    std::error_code ignored;
    fs::remove(folder / kSlurmJobsFile, ignored);
    return;
  }
  throw badInput(night.string(), {InputFault::kUnwritable,
                                  fmt::format("another night is running here: Slurm's jobs {}",
                                              fmt::join(jobs, ", ")),
                                  "", "wait until it ends, or cancel them (scancel)"});
}

void refuseLateMerge(const fs::path& night, int number, std::time_t since) {
  std::ifstream file(night / kSlurmFolder / kNightFile);
  int last = 0;
  std::time_t last_since = 0;
  // Nights of an older program have no such file.
  if (!(file >> last >> last_since) || (last == number && last_since == since)) return;
  throw badInput(
      night.string(),
      {InputFault::kOther,
       fmt::format("night {} was begun on Slurm after the one that this job merges ({}); "
                   "nothing is changed",
                   last, number)});
}

void SlurmOptions::check() const {
  requireOption(throttle >= 0, "throttle", throttle, "0 (no limit) or more");
  requirePositive("pack_s", pack_s);
  requireOption(rounds >= 1, "rounds", rounds, "1 or more");
}

SlurmEnd runOnSlurm(PreparedNight night, SlurmOptions options, const NightSink& sink) {
  options.check();
  // An earlier night's scripts and words: its round_1.json would pass for this one's.
  std::error_code left_there;
  fs::remove_all(night.folder / kSlurmFolder, left_there);  // of earlier nights
  makeFoldersIn(night.folder, kSlurmFolder);
  options.since = std::time(nullptr);
  writeFileAtomically((night.folder / kSlurmFolder / kNightFile).string(),
                      fmt::format("{} {}\n", night.number, options.since));
  for (int round = 1; round <= options.rounds; ++round) {
    std::error_code ignored;
    fs::remove(wordFile(night.folder, round), ignored);
    const std::vector<std::string> jobs = submitRound(night, options, round);
    night.lock.reset();  // from here on the jobs keep others away, and the last one merges
    const auto word = awaitWord(night, round, jobs, sink);
    if (word && word->merged) return word->end;
    // Again this process: the next round is submitted under the lock.
    night.lock = std::make_unique<NightLock>(night.folder, kSlurmLockWaitS);
  }
  throw BadInput(InputFault::kOther,
                 fmt::format("the merging job was lost {} times; see {}, or run the study again",
                             options.rounds, (night.folder / kSlurmFolder).string()));
}

int mergeSlurmRound(const PreparedNight& night, const SlurmOptions& options, int round,
                    const std::function<int(const NightOutcome&)>& tell_outcome) {
  Word word;
  StepResults results = settledResults(night.folder, night.steps);
  const std::set<std::string> lost = lostSteps(night, results);
  if (lost.empty() || round >= options.rounds) {
    addLost(night, lost, slurmRoundFolder(night.folder, round), results);
    const NightOutcome outcome =
        finishNight(night, results, std::difftime(std::time(nullptr), options.since));
    word.merged = true;
    word.end = {tell_outcome(outcome), nightSummary(outcome, night.folder)};
    std::error_code ignored;
    fs::remove(night.folder / kSlurmFolder / kSlurmJobsFile, ignored);
  }
  leaveWord(night.folder, round, word);
  return word.end.exit_code;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <chrono>
#include <ctime>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "calibrator/base/option_check.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/workplace.h"
#include "evaluate/process/process.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/text.h"
#include "evaluate/study/engine/engines.h"
#include "evaluate/study/run_step.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "slurm";
constexpr const char* kJobsFile = "jobs.txt";    // of a night that is under way
constexpr const char* kNightFile = "night.txt";  // whose folder this is: number and since
constexpr double kCommandLimit = 120;            // [s] of sbatch, squeue, scontrol
constexpr auto kPollEvery = std::chrono::milliseconds(500);
// Slurm's own default of MaxArraySize; the largest index is one less.
constexpr int kDefaultMaxArraySize = 1001;
// Polls in a row in which no job is known and none has left word: then nothing more will come.
constexpr int kSilentPolls = 6;
// Polls in a row in which Slurm does not answer, five minutes or more: it may be restarting, and
// its jobs run on.
constexpr int kUnansweredPolls = 600;

struct Said {
  int exit_code = -1;
  std::string text;
};

/// Runs one of Slurm's tools, found by PATH: both its outputs together, blanks at the end cut.
/// Through env, whose exit code and words say that there is none.
/// `logs`: a folder; each process has its own log there, and one that is lost is no answer.
Said runTool(const fs::path& logs, const std::vector<std::string>& words) {
  const fs::path log = logs / fmt::format("tool.{}.{}.txt", hostName(), getpid());
  std::error_code ignored;
  fs::remove(log, ignored);
  ProcessRequest request;
  request.words = {"/usr/bin/env"};
  request.words.insert(request.words.end(), words.begin(), words.end());
  request.log = log;
  request.limit_s = kCommandLimit;
  Said said;
  said.exit_code = runProcess(request).exit_code;
  std::ifstream file(log);
  if (!file) said.exit_code = -1;
  said.text.assign(std::istreambuf_iterator<char>(file), {});
  while (!said.text.empty() && std::isspace(static_cast<unsigned char>(said.text.back()))) {
    said.text.pop_back();
  }
  fs::remove(log, ignored);
  return said;
}

BadInput slurmFailed(const std::string& tool, const Said& said) {
  return {InputFault::kOther,
          fmt::format("{} failed ({}); --engine slurm needs it, --engine local does not", tool,
                      said.text.empty() ? fmt::format("exit code {}", said.exit_code) : said.text)};
}

/// One submission of everything that is not settled.
class Round {
 public:
  Round(const PreparedNight& night, const SlurmOptions& options, int number)
      : night_(night),
        options_(options),
        number_(number),
        folder_(night.folder / kFolder / fmt::format("round_{}", number)) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    makeFoldersIn(night.folder, fs::path(kFolder) / folder_.filename());
  }

  /// The ids of the jobs.
  std::vector<std::string> submit() {
    const auto stages = unsettledStages(night_.folder, night_.steps);
    const auto seconds = estimateSeconds(night_.folder, night_.steps);
    const auto most = static_cast<std::size_t>(maxArraySize() - 1);
    // Each stage waits for the one before alone, which has waited for all others.
    std::vector<std::string> jobs;
    for (std::size_t i = 0; i < stages.size(); ++i) {
      const auto packs = packed(stages[i], seconds, most);
      jobs.push_back(submitStage(i, packs, jobs.empty() ? "" : jobs.back()));
      writeJobs(jobs);
    }
    jobs.push_back(submitMerge(jobs.empty() ? "" : jobs.back()));
    writeJobs(jobs);
    return jobs;
  }

 private:
  using Pack = std::vector<std::string>;

  // After each submission: where the next one is refused, those before run all the same.
  void writeJobs(const std::vector<std::string>& jobs) const {
    writeFileAtomically((night_.folder / kFolder / kJobsFile).string(),
                        fmt::format("{}\n", fmt::join(jobs, " ")));
  }

  int maxArraySize() const {
    const Said said = runTool(folder_, {"scontrol", "show", "config"});
    if (said.exit_code != 0) throw slurmFailed("scontrol", said);
    std::istringstream lines(said.text);
    for (std::string line; std::getline(lines, line);) {
      if (line.compare(0, 12, "MaxArraySize") != 0) continue;
      // "MaxArraySize            = 1001".
      const int size = std::atoi(line.substr(line.find('=') + 1).c_str());
      if (size > 1) return size;
    }
    return kDefaultMaxArraySize;
  }

  // Tasks of about pack_s, longer ones where the array would have too many.
  std::vector<Pack> packed(const std::vector<Step>& steps,
                           const std::map<std::string, double>& seconds, std::size_t most) const {
    double total = 0;
    for (const Step& step : steps) total += seconds.at(step.name);
    // A twentieth above the even share, as packs are not filled to the brim; the last one takes
    // what is left in any case.
    const double target = std::max(options_.pack_s, 1.05 * total / static_cast<double>(most));
    std::vector<Pack> packs;
    double filled = target;
    for (const Step& step : steps) {
      const double cost = seconds.at(step.name);
      const bool full = filled + cost > target && packs.size() < most;
      if (full || packs.empty()) {
        packs.emplace_back();
        filled = 0;
      }
      packs.back().push_back(step.name);
      filled += cost;
    }
    return packs;
  }

  std::string sbatch(const std::string& name, const std::string& after, const std::string& array,
                     const std::string& command, const std::string& log) const {
    const fs::path script = folder_ / (name + ".sh");
    Text text;
    // The process ends with its job step whatever it does: a task that is killed leaves no marker.
    add(text, "#!/bin/sh\nexec {}\n", command);
    writeNewFile(folder_, script.filename(), fmt::to_string(text));
    // Requeued after a node has failed, a task finds the steps that it had done, and its log goes
    // on.
    std::vector<std::string> words{"sbatch",
                                   "--parsable",
                                   "--requeue",
                                   "--open-mode=append",
                                   "--job-name=plumbline-" + night_.study.name,
                                   "--output=" + (folder_ / log).string()};
    if (!array.empty()) words.push_back("--array=" + array);
    if (!after.empty()) words.push_back("--dependency=afterany:" + after);
    // After ours, which they may replace.
    for (const std::string& word : wordsOf(options_.options)) words.push_back(word);
    words.push_back(script.string());
    const Said said = runTool(folder_, words);
    if (said.exit_code != 0) throw slurmFailed("sbatch", said);
    // sbatch --parsable prints "JOB" or "JOB;CLUSTER"; the last word counts, whatever else a site
    // prints before it.
    std::string job;
    for (const std::string& line : wordsOf(said.text)) job = line;
    return job.substr(0, job.find(';'));
  }

  // After any end of the stage before (afterany): a step whose need failed refuses by itself, and
  // the others of the stage go on.
  std::string submitStage(std::size_t stage, const std::vector<Pack>& packs,
                          const std::string& after) const {
    const std::string name = fmt::format("stage_{}", stage + 1);
    std::string lines;
    for (const Pack& pack : packs) lines += fmt::format("{}\n", fmt::join(pack, " "));
    writeNewFile(folder_, name + ".txt", lines);
    std::string array = fmt::format("0-{}", packs.size() - 1);
    if (options_.throttle > 0) array += fmt::format("%{}", options_.throttle);
    const std::string command = fmt::format(
        "{} study run-pack {} {} \"$SLURM_ARRAY_TASK_ID\"", shellWords({thisProgram()}),
        shellWords({night_.folder.string()}), shellWords({(folder_ / (name + ".txt")).string()}));
    return sbatch(name, after, array, command, name + "_%a.log");
  }

  std::string submitMerge(const std::string& after) const {
    const std::string command = fmt::format(
        "{} study {} --out {} --engine slurm --slurm-rounds {} --merge-round {} "
        "--merge-since {} --merge-night {}",
        shellWords({thisProgram()}), shellWords({night_.study.file.string()}),
        shellWords({night_.folder.string()}), options_.rounds, number_, options_.since,
        night_.number);
    return sbatch("merge", after, "", command, "merge.log");
  }

  const PreparedNight& night_;
  const SlurmOptions& options_;
  const int number_;
  const fs::path folder_;
};

/// Whether jobs of the list still wait or run; those that Slurm has forgotten do not. Throws where
/// squeue fails for another reason, which says nothing of them.
bool anyJobLeft(const fs::path& folder, const std::vector<std::string>& jobs) {
  for (const std::string& job : jobs) {
    const Said said = runTool(folder, {"squeue", "--noheader", "--jobs=" + job});
    if (said.exit_code == 0 && !said.text.empty()) return true;
    const bool forgotten = said.text.find("Invalid job id") != std::string::npos;
    if (said.exit_code != 0 && !forgotten) throw slurmFailed("squeue", said);
  }
  return false;
}

struct Word {
  bool merged = false;
  SlurmEnd end;
};

fs::path wordFile(const fs::path& night, int round) {
  return night / kFolder / fmt::format("round_{}.json", round);
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
      silent = anyJobLeft(night.folder / kFolder, jobs) ? 0 : silent + 1;
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
      const bool could = std::all_of(step.needs.begin(), step.needs.end(), [&](const auto& need) {
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
  const fs::path folder = night / kFolder;
  std::ifstream file(folder / kJobsFile);
  const std::vector<std::string> jobs{std::istream_iterator<std::string>(file), {}};
  if (jobs.empty()) return;
  bool left = false;
  try {
    left = anyJobLeft(folder, jobs);
  } catch (const BadInput& error) {
    throw badInput(
        (folder / kJobsFile).string(), 0,
        {InputFault::kOther,
         fmt::format("lists jobs of a night on Slurm, and it cannot be told whether they "
                     "run: {}",
                     error.what()),
         "", "run the night where squeue is, or remove this file if they have ended"});
  }
  if (!left) {
    std::error_code ignored;
    fs::remove(folder / kJobsFile, ignored);
    return;
  }
  throw badInput(
      night.string(), 0,
      {InputFault::kUnwritable,
       fmt::format("another night is running here: Slurm's jobs {}", fmt::join(jobs, ", ")), "",
       "wait until it ends, or cancel them (scancel)"});
}

void refuseLateMerge(const fs::path& night, int number, std::time_t since) {
  std::ifstream file(night / kFolder / kNightFile);
  int last = 0;
  std::time_t last_since = 0;
  // Nights of an older program have no such file.
  if (!(file >> last >> last_since) || (last == number && last_since == since)) return;
  throw badInput(
      night.string(), 0,
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
  fs::remove_all(night.folder / kFolder, left_there);  // of earlier nights
  makeFoldersIn(night.folder, kFolder);
  options.since = std::time(nullptr);
  writeFileAtomically((night.folder / kFolder / kNightFile).string(),
                      fmt::format("{} {}\n", night.number, options.since));
  for (int round = 1; round <= options.rounds; ++round) {
    std::error_code ignored;
    fs::remove(wordFile(night.folder, round), ignored);
    const std::vector<std::string> jobs = Round(night, options, round).submit();
    night.lock.reset();  // from here on the jobs keep others away, and the last one merges
    const auto word = awaitWord(night, round, jobs, sink);
    if (word && word->merged) return word->end;
    // Again this process: the next round is submitted under the lock.
    night.lock = std::make_unique<NightLock>(night.folder, kSlurmLockWaitS);
  }
  throw BadInput(InputFault::kOther,
                 fmt::format("the merging job was lost {} times; see {}, or run the study again",
                             options.rounds, (night.folder / kFolder).string()));
}

int mergeSlurmRound(const PreparedNight& night, const SlurmOptions& options, int round,
                    const std::function<int(const NightOutcome&)>& tell_outcome) {
  Word word;
  StepResults results = settledResults(night.folder, night.steps);
  const std::set<std::string> lost = lostSteps(night, results);
  if (lost.empty() || round >= options.rounds) {
    addLost(night, lost, night.folder / kFolder / fmt::format("round_{}", round), results);
    const NightOutcome outcome =
        finishNight(night, results, std::difftime(std::time(nullptr), options.since));
    word.merged = true;
    word.end = {tell_outcome(outcome), nightSummary(outcome, night.folder)};
    std::error_code ignored;
    fs::remove(night.folder / kFolder / kJobsFile, ignored);
  }
  leaveWord(night.folder, round, word);
  return word.end.exit_code;
}

std::vector<std::string> stepsOfPack(const std::string& packs, int index) {
  std::ifstream file(packs);
  std::string line;
  for (int i = 0; std::getline(file, line); ++i) {
    if (i == index) return wordsOf(line);
  }
  throw badInput(packs, 0,
                 {InputFault::kMissingKey, fmt::format("has no line {} of steps", index + 1)});
}

}  // namespace plumbline

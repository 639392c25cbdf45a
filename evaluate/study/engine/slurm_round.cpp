// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/engine/slurm_round.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/workplace.h"
#include "evaluate/process/process.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr double kCommandLimit = 120;  // [s] of sbatch, squeue, scontrol
// Slurm's own default of MaxArraySize; the largest index is one less.
constexpr int kDefaultMaxArraySize = 1001;

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
        folder_(slurmRoundFolder(night.folder, number)) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    makeFoldersIn(night.folder, fs::path(kSlurmFolder) / folder_.filename());
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
    writeFileAtomically((night_.folder / kSlurmFolder / kSlurmJobsFile).string(),
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

}  // namespace

fs::path slurmRoundFolder(const fs::path& night, int round) {
  return night / kSlurmFolder / fmt::format("round_{}", round);
}

std::vector<std::string> submitRound(const PreparedNight& night, const SlurmOptions& options,
                                     int number) {
  return Round(night, options, number).submit();
}

bool anyJobLeft(const fs::path& folder, const std::vector<std::string>& jobs) {
  for (const std::string& job : jobs) {
    const Said said = runTool(folder, {"squeue", "--noheader", "--jobs=" + job});
    if (said.exit_code == 0 && !said.text.empty()) return true;
    const bool forgotten = said.text.find("Invalid job id") != std::string::npos;
    if (said.exit_code != 0 && !forgotten) throw slurmFailed("squeue", said);
  }
  return false;
}

std::vector<std::string> stepsOfPack(const std::string& packs, int index) {
  std::ifstream file(packs);
  std::string line;
  for (int i = 0; std::getline(file, line); ++i) {
    if (i == index) return wordsOf(line);
  }
  throw badInput(packs,
                 {InputFault::kMissingKey, fmt::format("has no line {} of steps", index + 1)});
}

}  // namespace plumbline

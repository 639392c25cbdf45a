// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "evaluate/study/night.h"
#include "evaluate/study/step.h"
#include "evaluate/study/step_result.h"

namespace plumbline {

/// Where a night stands.
struct NightProgress {
  std::size_t done = 0, all = 0, failed = 0;  ///< of the steps that had to be done
  double seconds_left = -1;                   ///< estimated; negative: not known
  std::string step;                           ///< that ended last
  std::string message;                        ///< of it, if it failed
};
using NightSink = std::function<void(const NightProgress&)>;

/// Seconds that each step may take, by name: what it took before, under whatever key; else the
/// median of its kind; else a guess.
std::map<std::string, double> estimateSeconds(const std::filesystem::path& night,
                                              const std::vector<Step>& steps);

/// Does the steps that are not settled, `jobs` at once (0: all cores), those first that with all
/// that waits for them take longest; each on one thread, unless there are fewer steps than jobs. A
/// step whose need failed is left out. Returns what settles or ended each step; steps left out have
/// no result.
StepResults runLocally(const std::filesystem::path& night, const std::vector<Step>& steps, int jobs,
                       const NightSink& sink);

/// Steps in stages: what is in one needs only what is in those before. Steps that are settled are
/// left out.
std::vector<std::vector<Step>> unsettledStages(const std::filesystem::path& night,
                                               const std::vector<Step>& steps);

/// The commands that do a night's steps, one a line, for a shell or a scheduler: those of a stage
/// in any order and at once, stages one after the other (a line of "#" between them), and last the
/// one that merges.
std::string commandList(const std::filesystem::path& night, const std::vector<Step>& steps,
                        const std::string& study, const std::string& out);

/// How long processes of a night on Slurm wait for its lock, which another one of them, or a night
/// that is refused meanwhile, holds for a moment [s].
inline constexpr double kSlurmLockWaitS = 30;

/// How steps are put into job arrays.
struct SlurmOptions {
  int throttle = 0;       ///< tasks of an array at once (%M); 0: no limit
  double pack_s = 300;    ///< work of one task: short steps are packed together
  int rounds = 3;         ///< times that steps are submitted, if they were lost
  std::string options;    ///< further ones of sbatch
  std::time_t since = 0;  ///< of a merging job: when the first round was submitted [s since 1970]

  void check() const;  ///< throws InputError naming the field that is out of its range
};

/// How a night on the cluster ended, as the job said that merged it.
struct SlurmEnd {
  int exit_code = 0;
  std::string text;
};

/// Throws InputError where jobs of a night on the cluster still wait or run: its lock is released
/// meanwhile, and what they read and write must not change. Asks squeue only where a night has left
/// its list of jobs.
void refuseWhileUnderWay(const std::filesystem::path& night);

/// Asked by a merging job, which Slurm may run once more after its night: throws InputError where
/// another night was begun on Slurm since, whose jobs and words it would take for its own.
void refuseLateMerge(const std::filesystem::path& night, int number, std::time_t since);

/// Submits the steps that are not settled as one array for each stage (afterany of the one before),
/// and a job after all of them that merges; waits for it. Markers in the night's folder say what is
/// done; sacct is not asked. Steps that were lost with their task are submitted again, `rounds`
/// times in all. The folder must be one that all nodes see, and no night be under way there
/// (refuseWhileUnderWay()). Throws InputError where sbatch cannot be run or refuses.
SlurmEnd runOnSlurm(PreparedNight night, SlurmOptions options, const NightSink& sink);

/// The work of the merging job: merges, unless steps are missing and a round is left, and leaves
/// word for who waits. In the last round those that left no result are recorded as lost.
/// `tell` gives the exit code of a night that was merged.
int mergeSlurmRound(const PreparedNight& night, const SlurmOptions& options, int round,
                    const std::function<int(const NightOutcome&)>& tell);

/// The names of the steps of a task: a line of the file that the array was submitted with.
std::vector<std::string> stepsOfPack(const std::string& packs, int index);

}  // namespace plumbline

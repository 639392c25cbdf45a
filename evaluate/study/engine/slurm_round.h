// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluate/study/engine/engines.h"

namespace plumbline {

// What the engine on Slurm asks of its tools. In a night's folder:
inline constexpr const char* kSlurmFolder = "slurm";
inline constexpr const char* kSlurmJobsFile = "jobs.txt";  ///< of a night that is under way

/// Scripts, packs and logs of one submission.
std::filesystem::path slurmRoundFolder(const std::filesystem::path& night, int round);

/// Submits everything that is not settled, and the job that merges; the ids of the jobs.
std::vector<std::string> submitRound(const PreparedNight& night, const SlurmOptions& options,
                                     int number);

/// Whether jobs of the list still wait or run; those that Slurm has forgotten do not. Throws where
/// squeue fails for another reason, which says nothing of them. `folder` takes its log.
bool anyJobLeft(const std::filesystem::path& folder, const std::vector<std::string>& jobs);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluate/study/step.h"

namespace plumbline {

/// Steps in stages: what is in one needs only what is in those before. Steps that are settled are
/// left out.
std::vector<std::vector<Step>> unsettledStages(const std::filesystem::path& night,
                                               const std::vector<Step>& steps);

/// The commands that do a night's steps, one a line, for a shell or a scheduler: those of a stage
/// in any order and at once, stages one after the other (a line of "#" between them), and last the
/// one that merges.
std::string commandList(const std::filesystem::path& night, const std::vector<Step>& steps,
                        const std::string& study, const std::string& out);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/study/definition/definition.h"
#include "evaluate/study/input_hashes.h"
#include "evaluate/study/step.h"

namespace plumbline {

/// What made a result, besides its inputs.
struct ProgramId {
  std::string version;  ///< programVersion()
  std::string hash;     ///< runningProgramHash()
};

/// The steps of a study's night, each after those that it needs, with their keys: of the contents
/// of what they read, of options, and of the program. Names of sessions and files are in no key but
/// where results show them. Throws InputError where an input cannot be read.
std::vector<Step> planStudy(const StudyDefinition& study, InputHashes& hashes,
                            const ProgramId& program);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/files/yaml_map.h"
#include "evaluate/study/definition.h"

namespace plumbline::study_internal {

/// The key `options_key` of a map: options of a command, by name, checked together. Values that
/// name files, those of `file_options`, are absolute from here on.
StudyCommandOptions optionsOf(const YamlMap& map, const std::string& options_key,
                              const std::string& of_what, const StudyOptionCheck& check,
                              std::initializer_list<const char*> file_options = {});

/// The key `trajectories` of a study whose sequences were read.
void readTrajectories(const YamlMap& map, const StudyOptionCheck& check, StudyDefinition& study);

}  // namespace plumbline::study_internal

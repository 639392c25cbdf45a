// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace plumbline {

/// A study's definition: a YAML mapping from names to a value or a list of values, as text; a list
/// becomes "100,10,1". In the order of the file.
///   offsets-ms: [100, 10, 1]
///   corner-noise-px: 0.1:0.1:0.5
/// Throws InputError for a file that cannot be read, and, with its line, for a name that is not
/// among `known` or a value that is a mapping.
std::vector<std::pair<std::string, std::string>> readStudyDefinition(
    const std::string& path, const std::vector<std::string>& known);

}  // namespace plumbline

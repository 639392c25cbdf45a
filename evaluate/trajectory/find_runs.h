// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace plumbline {

/// A file that a pattern found, with what its fields stood for ("" where the pattern lacks one).
struct RunFile {
  std::filesystem::path path;
  std::string sequence, calibration, run;
};

/// Files such as 'results/{calibration}/{sequence}_{run}.txt', sorted by path. A field stands for
/// one or more characters of one folder's or file's name: {run} without underscores, the others as
/// many as they can. Where `sequences` are known, {sequence} is one of them if the name allows it,
/// so that underscores in both parts do no harm. Without fields the pattern is a file.
///
/// Throws InputError, naming the pattern, for fields of another name and folders that are not
/// there.
std::vector<RunFile> findRuns(const std::string& pattern,
                              const std::vector<std::string>& sequences = {});

/// Whether the pattern has the field, e.g. "sequence".
bool hasField(const std::string& pattern, const std::string& field);

}  // namespace plumbline

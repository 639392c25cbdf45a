// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {

/// Lists on the command line go by one rule, whatever they list: commas between the entries, blanks
/// around an entry ignored; an empty entry is refused, and one that is given twice, which would
/// count twice. InputErrors name the option.

/// The entries of a list that is one word, none of them empty.
std::vector<std::string> entriesOf(const std::string& option, const std::string& list);

/// Refuses a value that stands twice, however it was written.
template <class Value>
void refuseRepeated(const std::string& option, std::vector<Value> values) {
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice == values.end()) return;
  throw InputError(fmt::format("{}: {} is given twice; expected each entry once", option, *twice));
}

/// Of paths, a word that exists as it stands is one entry, with its commas, and one that leads to
/// the same file or folder as another is given twice.
enum class ListOf { kWords, kPaths };

/// An option that takes a list, and may itself be repeated. A word behind its value is none of its
/// entries.
CLI::Option* addList(CLI::App& app, const std::string& name, std::vector<std::string>& entries,
                     const std::string& help, ListOf of = ListOf::kWords);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {

/// Lists on the command line go by one rule, whatever they list: commas between the entries, blanks
/// around an entry ignored; an empty entry is refused, and one that is given twice, which would
/// count twice. InputErrors name the option.

/// The parts of a text. Empty ones are kept, so that they are refused like any other word that is
/// none.
std::vector<std::string> split(const std::string& text, char separator);

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

/// Amounts as a person lists them: numbers and ranges FROM:STEP:TO (both ends included, in either
/// direction), separated by commas: "100,-3.21,0.5" or "-500:50:500". Signed and fractional. Values
/// of a range are FROM + k STEP, cleaned to 12 digits so that 0.1:0.1:0.3 ends in 0.3. Throws
/// InputError naming the option for anything else, or for more than 10,000 amounts.
std::vector<double> amountsFrom(const std::string& option, const std::string& words);

/// --rpe: "1m,10m,1frames,0.5s", or "none".
std::vector<RelativeDelta> relativeDeltasFrom(const std::string& words);

}  // namespace plumbline

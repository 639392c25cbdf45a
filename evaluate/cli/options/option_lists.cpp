// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/option_lists.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "datasets/files/table.h"
#include "datasets/files/workplace.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

bool existsAsItStands(const std::string& word) {
  std::error_code unknown;
  return std::filesystem::exists(word, unknown);
}

void refuseRepeatedPaths(const std::string& option, const std::vector<std::string>& paths) {
  std::set<std::filesystem::path> seen;
  for (const std::string& path : paths) {
    if (!seen.insert(resolvedAsFar(path)).second) refuseRepeated<std::string>(option, {path, path});
  }
}

constexpr std::size_t kMostAmounts = 10'000;

double numberOf(const std::string& option, const std::string& word) {
  // A plus is written where others of the list have a minus; from_chars takes none.
  if (const auto value = finiteNumber(word.rfind('+', 0) == 0 ? word.substr(1) : word))
    return *value;
  throw InputError(fmt::format(
      "{}: '{}' is not a number; expected numbers and ranges FROM:STEP:TO separated by commas",
      option, word));
}

/// Without the last digits that sums of a decimal step leave: 0.3, not 0.30000000000000004.
double cleaned(double value) { return std::strtod(fmt::format("{:.12g}", value).c_str(), nullptr); }

void addRange(const std::string& option, const std::vector<std::string>& ends,
              std::vector<double>& amounts) {
  const double from = numberOf(option, ends[0]);
  const double step = numberOf(option, ends[1]);
  const double to = numberOf(option, ends[2]);
  // The last value belongs to the range though its quotient is rounded down.
  const double count = std::floor((to - from) / step + 1e-9);
  if (step == 0 || !(count >= 0) || count > kMostAmounts) {
    throw InputError(
        fmt::format("{} {}:{}:{}: expected a step that reaches the last value from the first in at "
                    "most {} steps",
                    option, from, step, to, kMostAmounts));
  }
  for (int k = 0; k <= static_cast<int>(count); ++k) amounts.push_back(cleaned(from + k * step));
}

RelativeDelta relativeDeltaFrom(const std::string& word) {
  const auto fail = [&] {
    throw InputError(fmt::format(
        "--rpe {}: expected distances such as 10m, 0.5s or 1frames, separated by commas, or none",
        word));
  };
  RelativeDelta delta;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, delta.delta);
  if (error != std::errc() || !(delta.delta > 0) || !std::isfinite(delta.delta)) fail();
  const std::string unit(rest, end);
  const auto known = enumFrom<RelativeDelta::Unit>(unit);
  if (!known) fail();
  delta.unit = *known;
  // Frames are counted; metres and seconds may be fractions.
  const bool whole = delta.delta == std::floor(delta.delta) && delta.delta < 1e9;
  if (delta.unit == RelativeDelta::Unit::kFrames && !whole) fail();
  return delta;
}

}  // namespace

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::vector<std::string> entriesOf(const std::string& option, const std::string& list) {
  std::vector<std::string> entries = split(list, ',');
  for (std::string& entry : entries) {
    entry = std::string(trimmedText(entry));
    if (!entry.empty()) continue;
    throw InputError(
        fmt::format("{} '{}': has an empty entry; expected entries with one comma between each two",
                    option, list));
  }
  return entries;
}

CLI::Option* addList(CLI::App& app, const std::string& name, std::vector<std::string>& entries,
                     const std::string& help, ListOf of) {
  // Not CLI11's delimiter, which passes over empty entries, and takes the next option for an entry
  // where all are empty.
  const auto take = [&entries, name, of](const std::vector<std::string>& words) {
    entries.clear();
    for (const std::string& word : words) {
      if (of == ListOf::kPaths && existsAsItStands(word)) {
        entries.push_back(word);
      } else {
        append(entries, entriesOf(name, word));
      }
    }
    of == ListOf::kPaths ? refuseRepeatedPaths(name, entries) : refuseRepeated(name, entries);
  };
  return app.add_option_function<std::vector<std::string>>(name, take, help)
      ->allow_extra_args(false);
}

std::vector<double> amountsFrom(const std::string& option, const std::string& words) {
  std::vector<double> amounts;
  for (const std::string& word : entriesOf(option, words)) {
    const auto parts = split(word, ':');
    if (parts.size() == 1) {
      amounts.push_back(numberOf(option, word));
    } else if (parts.size() == 3) {
      addRange(option, parts, amounts);
    } else {
      throw InputError(fmt::format("{}: '{}' is not a range; expected FROM:STEP:TO", option, word));
    }
  }
  if (amounts.size() > kMostAmounts) {
    throw InputError(fmt::format("{}: expected at most {} values", option, kMostAmounts));
  }
  refuseRepeated(option, amounts);
  return amounts;
}

std::vector<RelativeDelta> relativeDeltasFrom(const std::string& words) {
  std::vector<RelativeDelta> deltas;
  if (words == "none") return deltas;
  for (const std::string& word : entriesOf("--rpe", words)) {
    deltas.push_back(relativeDeltaFrom(word));
  }
  std::vector<std::string> lengths;
  for (const RelativeDelta& d : deltas) {
    lengths.push_back(fmt::format("{}{}", d.delta, toString(d.unit)));
  }
  refuseRepeated("--rpe", std::move(lengths));
  return deltas;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/option_lists.h"

#include <filesystem>
#include <set>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>

#include "datasets/files/table.h"
#include "datasets/files/workplace.h"
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

}  // namespace

std::vector<std::string> entriesOf(const std::string& option, const std::string& list) {
  std::vector<std::string> entries;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t to = std::min(list.find(',', from), list.size());
    entries.emplace_back(trimmedText(std::string_view(list).substr(from, to - from)));
    if (entries.back().empty()) {
      throw InputError(fmt::format(
          "{} '{}': has an empty entry; expected entries with one comma between each two", option,
          list));
    }
    from = to + 1;
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

}  // namespace plumbline

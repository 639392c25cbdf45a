// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/find_runs.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <regex>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExample = "e.g. 'results/{calibration}/{sequence}_{run}.txt'";

/// The text as a regular expression that stands for itself.
std::string escaped(const std::string& text) {
  static const std::regex special(R"([.^$|()\[\]{}*+?\\])");
  return std::regex_replace(text, special, R"(\$&)");
}

// What stands for a field: one of `words` if there are any.
std::string groupOf(const std::string& field, std::vector<std::string> words) {
  if (field == "run") return "([^/_]+)";
  if (words.empty()) return "([^/]+)";
  // Longest first: of alternatives a regular expression takes the first that fits, so that "MH_01"
  // does not take what is "MH_01_easy"'s.
  std::ranges::sort(words, [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  });
  std::string group;
  for (const std::string& word : words) group += (group.empty() ? "(" : "|") + escaped(word);
  return group + ")";
}

struct Matcher {
  std::regex expression;
  std::vector<std::string> fields;  // of the groups, in their order
};

/// The pattern as a regular expression of the whole path, a group for each field at its first
/// place.
Matcher matcherOf(const std::string& pattern, const std::vector<std::string>& sequences) {
  Matcher matcher;
  std::string expression;
  std::size_t at = 0;
  while (at < pattern.size()) {
    const std::size_t open = std::min(pattern.find('{', at), pattern.size());
    expression += escaped(pattern.substr(at, open - at));
    if (open == pattern.size()) break;
    const std::size_t close = pattern.find('}', open);
    const std::string field =
        close == std::string::npos ? "" : pattern.substr(open + 1, close - open - 1);
    if (field != "sequence" && field != "calibration" && field != "run") {
      throw InputError(pattern, 0,
                       fmt::format("expected the fields {{sequence}}, {{calibration}} and {{run}}, "
                                   "{}",
                                   kExample));
    }
    const auto known = std::ranges::find(matcher.fields, field);
    if (known != matcher.fields.end()) {
      // A field that stands twice has to stand for the same text: a back reference.
      expression += fmt::format("\\{}", known - matcher.fields.begin() + 1);
    } else {
      matcher.fields.push_back(field);
      expression += groupOf(field, field == "sequence" ? sequences : std::vector<std::string>());
    }
    at = close + 1;
  }
  matcher.expression = std::regex(expression);
  return matcher;
}

std::optional<RunFile> matched(const std::string& path, const Matcher& matcher) {
  std::smatch match;
  if (!std::regex_match(path, match, matcher.expression)) return std::nullopt;
  RunFile file;
  file.path = path;
  for (std::size_t i = 0; i < matcher.fields.size(); ++i) {
    const std::string& field = matcher.fields[i];
    (field == "sequence" ? file.sequence
     : field == "run"    ? file.run
                         : file.calibration) = match[i + 1];
  }
  return file;
}

// The folder above the first field, and how many levels the pattern goes down from there.
struct Reach {
  std::string folder;
  int depth = 0;
};

Reach reachOf(const std::string& pattern) {
  const std::size_t field = pattern.find('{');
  const std::size_t slash = pattern.rfind('/', field);
  const std::size_t rest = slash == std::string::npos ? 0 : slash + 1;
  const auto below =
      std::count(pattern.begin() + static_cast<std::ptrdiff_t>(rest), pattern.end(), '/');
  return {slash == std::string::npos ? "." : pattern.substr(0, rest), static_cast<int>(below)};
}

}  // namespace

bool hasField(const std::string& pattern, const std::string& field) {
  return pattern.find("{" + field + "}") != std::string::npos;
}

std::vector<RunFile> findRuns(const std::string& pattern,
                              const std::vector<std::string>& sequences) {
  if (pattern.find('{') == std::string::npos) return {{pattern, "", "", ""}};
  const Matcher known = matcherOf(pattern, sequences), any = matcherOf(pattern, {});
  const Reach reach = reachOf(pattern);
  if (!fs::is_directory(reach.folder)) {
    throw InputError(
        reach.folder, 0,
        fmt::format("is not a folder; it stands before the first field of {}", pattern));
  }
  std::vector<RunFile> files;
  for (auto it = fs::recursive_directory_iterator(reach.folder);
       it != fs::recursive_directory_iterator(); ++it) {
    // Files stand as deep as the pattern says; below lie whatever other results there are.
    if (it.depth() >= reach.depth) it.disable_recursion_pending();
    if (it.depth() != reach.depth || !it->is_regular_file()) continue;
    std::string path = it->path().generic_string();
    // A pattern without a folder looks into ".", whose entries have "./" in front.
    if (pattern.find('/') == std::string::npos) path = it->path().filename().string();
    // By the known sequences first: greedy fields alone would split names at the last underscore.
    auto file = matched(path, known);
    if (!file) file = matched(path, any);
    if (file && !isUtf8(path)) {
      throw InputError(path, 0, "has a name that is not UTF-8; rename it");
    }
    if (file) files.push_back(*file);
  }
  std::ranges::sort(files, {}, &RunFile::path);
  return files;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/command_tree.h"

#include <algorithm>
#include <cstddef>
#include <regex>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

void collect(const CLI::App& app, const std::string& path, std::vector<CommandNode>& nodes) {
  nodes.push_back({path, &app});
  for (const CLI::App* sub : shownCommands(app)) {
    collect(*sub, path + " " + sub->get_name(), nodes);
  }
}

}  // namespace

std::vector<const CLI::App*> shownCommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
}

std::vector<CommandNode> nodesOf(const CLI::App& app) {
  std::vector<CommandNode> nodes;
  collect(app, "", nodes);
  return nodes;
}

std::vector<const CLI::Option*> shownOptions(const CLI::App& app, bool positional) {
  std::vector<const CLI::Option*> shown;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty() && option->get_positional() == positional) {
      shown.push_back(option);
    }
  }
  return shown;
}

bool takesValue(const CLI::Option& option) { return option.get_expected_max() != 0; }

std::string firstLongName(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

const CLI::App& chosenCommand(const CLI::App& app) {
  const CLI::App* chosen = &app;
  while (!chosen->get_subcommands().empty()) chosen = chosen->get_subcommands().front();
  return *chosen;
}

std::vector<std::string> wordsOf(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::App* sub : shownCommands(app)) words.push_back(sub->get_name());
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  }
  return words;
}

std::string withOwners(const std::string& text, const CLI::App& command) {
  const CLI::App* root = &command;
  while (root->get_parent() != nullptr) root = root->get_parent();
  const auto owners =
      root->get_subcommands([](const CLI::App* sub) { return sub->get_name() == "calibrate"; });
  static const std::regex kOption("--[a-z][a-z-]*");
  std::string out;
  auto end = text.begin();
  for (std::sregex_iterator at(text.begin(), text.end(), kOption), none; at != none; ++at) {
    out.append(end, (*at)[0].first);
    end = (*at)[0].second;
    const bool elsewhere = command.get_option_no_throw(at->str()) == nullptr && !owners.empty() &&
                           owners.front()->get_option_no_throw(at->str()) != nullptr;
    out += (elsewhere ? "calibrate's " : "") + at->str();
  }
  return out.append(end, text.end());
}

int editDistance(std::string_view a, std::string_view b) {
  // Three rows of the table: of a's prefixes with two, one and no letters less.
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1] ? 1 : 0)});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  // The exchange after a row has put it here.
  return last[b.size()];
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  std::string nearest;
  // One more than what is near enough, for it has to be less.
  int least = std::max(1, static_cast<int>(word.size()) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const int distance = editDistance(word, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string usageText(const CLI::ParseError& error, const CLI::App& app) {
  static const std::regex kRepeated("(\\S+): At Most 1 required but received (\\d+)");
  static const std::regex kMissing("(\\S+): 1 required \\S+ missing");
  static const std::regex kNoNumber("Could not convert: (\\S+) = (.*)");
  const std::string text = error.what();
  std::smatch part;
  if (std::regex_match(text, part, kRepeated)) {
    return fmt::format("{} is given {} times; expected once", part.str(1), part.str(2));
  }
  if (std::regex_match(text, part, kMissing)) return part.str(1) + ": expected a value";
  const CLI::Option* option = nullptr;
  if (std::regex_match(text, part, kNoNumber)) {
    option = chosenCommand(app).get_option_no_throw(part.str(1));
  }
  if (option == nullptr) return text;
  const bool whole = option->get_type_name().find("INT") != std::string::npos;
  return fmt::format("{}: {}: expected {}", part.str(1), part.str(2),
                     !takesValue(*option) ? "no value"
                     : whole              ? "a whole number below 2147483648"
                                          : "a number");
}

void parseReversed(CLI::App& app, const char* command, std::vector<std::string> reversed) {
  app.set_help_flag();
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("plumbline {}: {}", command, usageText(error, app)));
  }
}

std::string didYouMean(const CLI::App& app) {
  for (const std::string& argument : app.remaining(true)) {
    // "--ouT=x" is looked up without its value.
    const std::string word = argument.substr(0, argument.find('='));
    const std::string nearest = nearestWord(word, wordsOf(chosenCommand(app)));
    if (!nearest.empty()) return "; did you mean " + nearest + "?";
  }
  return "";
}

}  // namespace plumbline

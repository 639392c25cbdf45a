// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>

namespace plumbline {

/// The commands and options that parse, as completion, the manual page and messages walk them: they
/// cannot fall behind it.

/// Those for people, which have a group.
std::vector<const CLI::App*> shownCommands(const CLI::App& app);
std::vector<const CLI::Option*> shownOptions(const CLI::App& app, bool positional);

/// A command of the tree: " evaluate trajectory", what comes below it, and its options.
struct CommandNode {
  std::string path;
  const CLI::App* app = nullptr;
};
std::vector<CommandNode> nodesOf(const CLI::App& app);

/// A flag expects no value.
bool takesValue(const CLI::Option& option);
std::string firstLongName(const CLI::Option& option);

/// Least number of insertions, deletions, replacements and swaps of neighbours that make one word
/// of the other (optimal string alignment: no part is edited twice).
int editDistance(std::string_view a, std::string_view b);

/// The candidate nearest to a word that was mistyped, at most a third of its letters away (one at
/// least); "" where none is. The first of equals.
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

/// After a parse, the innermost command that was recognised; `app` where none was.
const CLI::App& chosenCommand(const CLI::App& app);

/// The subcommands and options of a command that help shows: what is hidden has no group.
std::vector<std::string> wordsOf(const CLI::App& app);

/// Sentences of the libraries name options of `calibrate` wherever they are said: the text, in
/// which those that `command` lacks are "calibrate's --imu-shift-ms".
std::string withOwners(const std::string& text, const CLI::App& command);

/// What is wrong with a line that cannot be parsed, where CLI11's words are its own: an option that
/// is given twice, without its value, or with one that is no number.
std::string usageText(const CLI::ParseError& error, const CLI::App& app);

/// Parses words, the last one first, as CLI11 takes a vector, with the options of `command` but
/// --help. Throws InputError in the words of that command.
void parseReversed(CLI::App& app, const char* command, std::vector<std::string> reversed);

/// "; did you mean --out?" where an argument that the chosen command does not know resembles one
/// that it does; "" otherwise. `app` after a parse that failed.
std::string didYouMean(const CLI::App& app);

}  // namespace plumbline

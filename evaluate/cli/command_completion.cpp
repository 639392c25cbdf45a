// SPDX-License-Identifier: BSD-3-Clause
// What the table of commands tells a shell, a reader of manuals and who mistypes a word:
// completion, the man page and what was probably meant. All walk the same tree of commands and
// options that parses, so that they cannot fall behind it.
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <functional>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/provenance.h"

namespace plumbline {
namespace {

/// Those for people, which have a group.
std::vector<const CLI::App*> shownCommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
}

/// A command of the tree: " evaluate trajectory", what comes below it, and its options.
struct Node {
  std::string path;
  const CLI::App* app = nullptr;
};

void collect(const CLI::App& app, const std::string& path, std::vector<Node>& nodes) {
  nodes.push_back({path, &app});
  for (const CLI::App* sub : shownCommands(app)) {
    collect(*sub, path + " " + sub->get_name(), nodes);
  }
}

std::vector<Node> nodesOf(const CLI::App& app) {
  std::vector<Node> nodes;
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

// A flag expects no value.
bool takesValue(const CLI::Option& option) { return option.get_expected_max() != 0; }

std::string firstLongName(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

// Commands stand first, in all three shells: a later word of their names is an option's value.
// Words of commands are offered first; where none begins like the word under the cursor, files.
std::string bashCompletion(const CLI::App& app) {
  std::string cases, paths;
  for (const Node& node : nodesOf(app)) {
    cases +=
        fmt::format("    '{}') words='{}' ;;\n", node.path, fmt::join(wordsOf(*node.app), " "));
    if (!node.path.empty()) paths += fmt::format("{}'{}'", paths.empty() ? "" : "|", node.path);
  }
  return fmt::format(R"(# bash completion of plumbline
_plumbline() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path='' words='' word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$path $word" in
      {}) path="$path $word" ;;
      *) break ;;
    esac
  done
  case "$path" in
{}  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o default -F _plumbline plumbline
)",
                     paths, cases);
}

// Within apostrophes; a colon parts a word from its description.
std::string zshQuoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') out += "'\\'";
    if (c == '[' || c == ']' || c == ':') out += '\\';
    out += c;
  }
  return out;
}

// Sourced it registers itself; from a folder of fpath it is the function's body, and has to run.
std::string zshCompletion(const CLI::App& app) {
  std::string cases, paths;
  for (const Node& node : nodesOf(app)) {
    std::string commands, specs;
    for (const CLI::App* sub : shownCommands(*node.app)) {
      commands += fmt::format(" '{}:{}'", sub->get_name(), zshQuoted(sub->get_description()));
    }
    for (const CLI::Option* option : shownOptions(*node.app, false)) {
      specs +=
          fmt::format(" '{}:{}'", firstLongName(*option), zshQuoted(option->get_description()));
    }
    cases += fmt::format("    '{}') commands=({}) options=({}) ;;\n", node.path, commands, specs);
    if (!node.path.empty()) paths += fmt::format("{}'{}'", paths.empty() ? "" : "|", node.path);
  }
  return fmt::format(R"(#compdef plumbline
_plumbline() {{
  local path_='' word
  local -a commands options
  for word in "${{(@)words[2,CURRENT-1]}}"; do
    case "$path_ $word" in
      {}) path_="$path_ $word" ;;
      *) break ;;
    esac
  done
  case "$path_" in
{}  esac
  _describe 'command' commands || _describe -o 'option' options || _files
}}
if [[ ${{funcstack[1]}} == _plumbline ]]; then _plumbline "$@"; else compdef _plumbline plumbline; fi
)",
                     paths, cases);
}

// Within apostrophes, where fish takes a backslash before an apostrophe or a backslash (other
// shells end the quotes).
std::string fishQuoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return "'" + out + "'";
}

// By the whole path of commands: `study` is one, and a part of `simulate`.
std::string fishCompletion(const CLI::App& app) {
  std::string paths, rules;
  for (const Node& node : nodesOf(app)) {
    if (!node.path.empty()) paths += fmt::format(" '{}'", node.path);
    const std::string condition = fmt::format("__plumbline_is_at \"{}\"", node.path);
    // -f: no files beside the subcommands; -r, below: the next word is the option's value.
    for (const CLI::App* sub : shownCommands(*node.app)) {
      rules += fmt::format("complete -c plumbline -n '{}' -f -a {} -d {}\n", condition,
                           sub->get_name(), fishQuoted(sub->get_description()));
    }
    for (const CLI::Option* option : shownOptions(*node.app, false)) {
      rules += fmt::format("complete -c plumbline -n '{}' -l {}{} -d {}\n", condition,
                           firstLongName(*option).substr(2), takesValue(*option) ? " -r" : "",
                           fishQuoted(option->get_description()));
    }
  }
  return fmt::format(R"(# fish completion of plumbline
function __plumbline_is_at
  set -l path ''
  for word in (commandline -opc)[2..]
    if contains -- "$path $word"{}
      set path "$path $word"
    else
      break
    end
  end
  test "$path" = "$argv[1]"
end
{})",
                     paths, rules);
}

// A bare - may be set as a hyphen, which no shell takes for an option; a line that begins with a
// stop or an apostrophe is a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
      out += c;
    }
  }
  return out;
}

std::string manOption(const CLI::Option& option) {
  std::string value;
  if (takesValue(option) && !option.get_positional()) value = " \\fIVALUE\\fR";
  const std::string standard = option.get_default_str();
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}{}\n",
                     roff(option.get_positional() ? option.get_name(true) : firstLongName(option)),
                     value, roff(option.get_description()),
                     standard.empty() ? "" : roff(" (default: " + standard + ")"));
}

std::string manPage(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH PLUMBLINE 1 \"\" \"plumbline {}\"\n.SH NAME\nplumbline \\- {}\n"
      ".SH SYNOPSIS\n\\fBplumbline\\fR \\fICOMMAND\\fR [\\fIARGUMENTS\\fR]\n.SH COMMANDS\n",
      roff(programVersion()), roff(app.get_description()));
  for (const Node& node : nodesOf(app)) {
    if (node.path.empty()) continue;
    text +=
        fmt::format(".SS plumbline{}\n{}.\n", roff(node.path), roff(node.app->get_description()));
    for (const bool positional : {true, false}) {
      for (const CLI::Option* option : shownOptions(*node.app, positional)) {
        text += manOption(*option);
      }
    }
    if (!node.app->get_footer().empty()) {
      // Lines of an example stay lines.
      text += ".PP\n.nf\n" + roff(node.app->get_footer()) + "\n.fi\n";
    }
  }
  return text +
         ".SH EXIT STATUS\n.TP\n0\nSuccess.\n.TP\n1\nFailure: the message states the cause and the "
         "remedy.\n.TP\n2\nBad input or usage.\n.TP\n3\nA study found a regression.\n.TP\n4\nThe "
         "verdict is at least as bad as \\-\\-fail\\-on states.\n.SH "
         "ENVIRONMENT\n.TP\nNO_COLOR\nNo colours on a terminal.\n.TP\nSOURCE_DATE_EPOCH\nThe date "
         "of results [s since 1970], so that they can be reproduced byte for byte.\n";
}

}  // namespace

Command completionCommand() {
  return {"completion", "Print the command-line completion for a shell",
          "plumbline completion bash > ~/.local/share/bash-completion/completions/plumbline",
          [](CLI::App& app) {
            auto shell = std::make_shared<std::string>();
            app.add_option("shell", *shell, "bash, zsh or fish")
                ->required()
                ->check(CLI::IsMember({"bash", "zsh", "fish"}));
            return std::function<int()>([shell, &app] {
              const CLI::App& root = *app.get_parent();
              writeOut(*shell == "bash"  ? bashCompletion(root)
                       : *shell == "zsh" ? zshCompletion(root)
                                         : fishCompletion(root));
              return kDone;
            });
          }};
}

Command manCommand() {
  return {"man", "Print the manual page", "plumbline man | man -l -", [](CLI::App& app) {
            return std::function<int()>([&app] {
              writeOut(manPage(*app.get_parent()));
              return kDone;
            });
          }};
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

// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/cli/command_tree.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/terminal.h"

namespace plumbline {
namespace {

// Commands stand first, in all three shells: a later word of their names is an option's value.
// Words of commands are offered first; where none begins like the word under the cursor, files.
std::string bashCompletion(const CLI::App& app) {
  std::string cases, paths;
  for (const CommandNode& node : nodesOf(app)) {
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
  for (const CommandNode& node : nodesOf(app)) {
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
  for (const CommandNode& node : nodesOf(app)) {
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

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// What bash, zsh and fish offer after a tab, and the page of the manual.
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

class CommandCompletion : public CommandLine {};

TEST_F(CommandCompletion, CompletionKnowsEveryCommandAndItsOptions) {
  const Outcome bash = plumbline("completion bash");
  ASSERT_EQ(bash.exit_code, 0);
  fs::create_directories(scratch());
  const fs::path file = scratch() / "completion.bash";
  write(file, bash.text);
  const auto completed = [&](const std::string& words) {
    return shell("bash -c 'source " + file.string() + "; COMP_WORDS=(plumbline " + words +
                 "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _plumbline; echo ${COMPREPLY[@]}'")
        .text;
  };
  EXPECT_EQ(completed("evaluate calibration --fol"), "--folds\n");
  // A value that is named like a subcommand.
  EXPECT_EQ(completed("simulate --out study --moti"), "--motion\n");
  const std::string fish = plumbline("completion fish").text;
  const std::string zsh = plumbline("completion zsh").text;
  const std::string man = plumbline("man").text;
  for (const std::string& name : listedCommands(plumbline("--help").text)) {
    EXPECT_THAT(fish, HasSubstr("-a " + name + " "));
    EXPECT_THAT(zsh, HasSubstr("'" + name + ":"));
    EXPECT_THAT(man, HasSubstr(".SS plumbline " + name));
  }
  EXPECT_EQ(plumbline("completion tcsh").exit_code, 2);
}

#define NEED_SHELL(name)                            \
  ASSERT_EQ(shell("command -v " name).exit_code, 0) \
      << name " is missing: its completion cannot be asked; scripts/test.sh installs it"

TEST_F(CommandCompletion, FishCompletesCommandsAndOptions) {
  NEED_SHELL("fish");
  fs::create_directories(scratch());
  const fs::path file = scratch() / "plumbline.fish";
  write(file, plumbline("completion fish").text);
  const auto completed = [&](const std::string& line) {
    // Candidates, each with its description after a tab.
    const Outcome out = shell("HOME=" + scratch().string() + " fish --no-config -c 'source " +
                              file.string() + "; complete -C \"plumbline " + line + "\"'");
    return out.text;
  };
  EXPECT_THAT(completed("calib"), testing::StartsWith("calibrate\tCalibrate"));
  EXPECT_THAT(completed("evaluate calibration --fol"), testing::StartsWith("--folds\t"));
  EXPECT_THAT(completed("evaluate traj"), HasSubstr("trajectory\t"));
  EXPECT_EQ(completed("evaluate calibration --part"), "");  // simulate study's
  EXPECT_THAT(completed("simulate study --part"), testing::StartsWith("--participants\t"));
  EXPECT_EQ(completed("study --part"), "") << "the command study is not simulate study";
  EXPECT_THAT(completed("simulate --out study --moti"), testing::StartsWith("--motion\t"));
}

TEST_F(CommandCompletion, ZshCompletesCommandsAndOptions) {
  NEED_SHELL("zsh");
  fs::create_directories(scratch() / "functions");
  write(scratch() / "functions" / "_plumbline", plumbline("completion zsh").text);
  write(scratch() / "sourced.zsh", plumbline("completion zsh").text);
  // A terminal in which a line is typed, a tab, and what then stands there is printed.
  const auto completed = [&](const std::string& line, bool sourced) {
    const std::string folder = scratch().string();
    const std::string load =
        sourced
            ? "autoload -Uz compinit; compinit -u -d " + folder + "/dump1; source " + folder +
                  "/sourced.zsh"
            : "fpath=(" + folder + "/functions $fpath); autoload -Uz compinit; compinit -u -d " +
                  folder + "/dump2";
    write(scratch() / "ask.zsh",
          "zmodload zsh/zpty\nzpty line zsh -f -i\n"
          "zpty -w line 'PS1=; TERM=dumb; unsetopt zle_bracketed_paste; " +
              load +
              "; show() { print -r -- \"<$BUFFER>\"; BUFFER=; zle accept-line }; zle -N show; "
              "bindkey \"^I\" complete-word \"^X\" show; print ready'\n"
              "zpty -r line out '*ready*ready*'\n"
              "zpty -w -n line $'plumbline " +
              line +
              "\\t\\x18'\n"
              "zpty -r line out '*<*>*'\nprint -r -- \"${${out##*<}%%>*}\"\nzpty -d line\n");
    return shell("cd " + folder + " && timeout 300 zsh -f ask.zsh").text;
  };
  for (const bool sourced : {true, false}) {
    EXPECT_EQ(completed("calib", sourced), "plumbline calibrate \n");
    EXPECT_EQ(completed("evaluate calibration --fol", sourced),
              "plumbline evaluate calibration --folds \n");
    EXPECT_EQ(completed("simulate study --part", sourced),
              "plumbline simulate study --participants \n");
    EXPECT_EQ(completed("simulate --out study --moti", sourced),
              "plumbline simulate --out study --motion \n");
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/cli/command_tree.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/provenance.h"

namespace plumbline {
namespace {

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
  for (const CommandNode& node : nodesOf(app)) {
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

Command manCommand() {
  return {"man", "Print the manual page", "plumbline man | man -l -", [](CLI::App& app) {
            return std::function<int()>([&app] {
              writeOut(manPage(*app.get_parent()));
              return kDone;
            });
          }};
}

}  // namespace plumbline

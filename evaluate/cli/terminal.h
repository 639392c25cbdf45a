// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace plumbline {

/// A text as a terminal may show it, line ends kept: control characters, those that turn the
/// direction of writing, and bytes that are no UTF-8 appear as \n, \t, \xHH or \uHHHH.
std::string shownText(std::string_view text);

/// One line of it: line ends are shown too.
std::string shownLine(std::string_view text);

bool isUtf8(std::string_view text);

/// Writes on standard output as it is, for machines. Faults are kept for closeOutput().
void writeOut(std::string_view bytes);

/// Writes a formatted text on standard output, as a terminal may show it.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  writeOut(shownText(fmt::format(format, std::forward<Args>(args)...)));
}

/// Writes "plumbline: MESSAGE" as one line on standard error.
void complain(std::string_view message);

/// Whether all of standard output was written; says so on standard error where not. After it
/// nothing more can be written.
bool closeOutput();

}  // namespace plumbline

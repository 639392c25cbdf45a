// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "datasets/files/shown_text.h"

namespace plumbline {

/// Writes on standard output as it is, for machines. Faults are kept for closeOutput().
void writeOut(std::string_view bytes);

/// Writes a document on standard output: as it is, for machines; on a terminal as one may show it.
void writeDocument(std::string_view document);

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

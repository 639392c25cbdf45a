// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace plumbline {

/// A text as a terminal may show it, line ends kept: control characters, those that turn the
/// direction of writing, and bytes that are no UTF-8 appear as \n, \t, \xHH or \uHHHH.
std::string shownText(std::string_view text);

/// One line of it: line ends are shown too.
std::string shownLine(std::string_view text);

bool isUtf8(std::string_view text);

}  // namespace plumbline

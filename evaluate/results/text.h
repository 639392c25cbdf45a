// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace plumbline {

/// What a summary or a table is written into; fmt::to_string() gives the text.
using Text = fmt::memory_buffer;

/// Appends; format and arguments as fmt::format() has them.
template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

}  // namespace plumbline

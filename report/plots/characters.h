// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace plumbline::internal {

// Here and not in a source: the pages and the module of the plots, which is loaded when it is
// needed, each have it.

/// Whether a byte of UTF-8 continues the character before it.
inline bool continuesCharacter(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// Characters (code points) of a text in UTF-8: how wide it is, about.
inline std::size_t characterCount(std::string_view text) {
  return text.size() - static_cast<std::size_t>(std::ranges::count_if(text, continuesCharacter));
}

/// The last characters of a text in UTF-8; all where it has no more.
inline std::string_view lastCharacters(std::string_view text, std::size_t count) {
  std::size_t at = text.size();
  while (at > 0 && count > 0) {
    if (!continuesCharacter(text[--at])) --count;
  }
  return text.substr(at);
}

}  // namespace plumbline::internal

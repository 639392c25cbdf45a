// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <iterator>

#include <fmt/format.h>

#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

/// A character of a text: its code point and how many bytes it takes; 0 bytes: no UTF-8.
struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
};

// RFC 3629: shortest forms only, no surrogates, nothing above U+10FFFF.
Character characterAt(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  if (byte(0) < 0x80) return {byte(0), 1};
  const std::size_t bytes = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = byte(0) & (0xFFU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[bytes] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {code, bytes};
}

// C0, DEL and C1; marks, embeddings, overrides and isolates of direction; separators of lines.
bool isHarmless(std::uint32_t code) {
  if (code < 0x20 || (code >= 0x7F && code <= 0x9F)) return false;
  if (code == 0x61C || code == 0xFEFF || code == 0x2028 || code == 0x2029) return false;
  return code != 0x200E && code != 0x200F && !(code >= 0x202A && code <= 0x202E) &&
         !(code >= 0x2066 && code <= 0x2069);
}

void appendEscaped(std::string& text, std::uint32_t code) {
  if (code == '\n') {
    text += "\\n";
  } else if (code == '\t') {
    text += "\\t";
  } else if (code < 0x100) {
    fmt::format_to(std::back_inserter(text), "\\x{:02x}", code);
  } else {
    fmt::format_to(std::back_inserter(text), "\\u{:04x}", code);
  }
}

std::string shown(std::string_view text, bool lines) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    Character c = characterAt(text);
    const bool valid = c.bytes > 0;
    if (!valid) c = {static_cast<std::uint8_t>(text[0]), 1};
    if (valid && (isHarmless(c.code) || (lines && c.code == '\n'))) {
      out += text.substr(0, c.bytes);
    } else {
      appendEscaped(out, c.code);
    }
    text.remove_prefix(c.bytes);
  }
  return out;
}

}  // namespace

std::string shownText(std::string_view text) { return shown(text, true); }

std::string shownLine(std::string_view text) { return shown(text, false); }

bool isUtf8(std::string_view text) {
  while (!text.empty()) {
    const Character c = characterAt(text);
    if (c.bytes == 0) return false;
    text.remove_prefix(c.bytes);
  }
  return true;
}

}  // namespace plumbline

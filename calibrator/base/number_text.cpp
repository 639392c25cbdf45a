// SPDX-License-Identifier: BSD-3-Clause
#include <cctype>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

constexpr std::string_view kMinus = "\u2212";

/// After such a character '-' is a hyphen or an exponent's sign: "cam-0", "1e-0".
bool isPartOfWord(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalnum(byte) != 0 || c == '_' || c == '.' || c == '-' || byte >= 0x80;
}

/// Length of the sign at this place; 0: there is none.
std::size_t signAt(std::string_view text, std::size_t at) {
  if (text[at] == '-') return 1;
  return text.substr(at).starts_with(kMinus) ? kMinus.size() : 0;
}

/// Whether "0" or "0.00" begins here, and neither digits nor a word follow it.
bool isZero(std::string_view text, std::size_t at) {
  if (at >= text.size() || text[at] != '0') return false;
  ++at;
  if (at + 1 < text.size() && text[at] == '.' && text[at + 1] == '0') {
    at = text.find_first_not_of('0', at + 1);
    if (at == std::string_view::npos) return true;
  }
  if (at >= text.size()) return true;
  // A stop that ends a sentence is no decimal point.
  const bool decimals = text[at] == '.' && at + 1 < text.size() &&
                        std::isdigit(static_cast<unsigned char>(text[at + 1])) != 0;
  return !decimals && std::isalnum(static_cast<unsigned char>(text[at])) == 0 && text[at] != '_';
}

}  // namespace

std::string withoutNegativeZeros(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t sign = signAt(text, at);
    if (sign > 0 && (at == 0 || !isPartOfWord(text[at - 1])) && isZero(text, at + sign)) {
      // The sign is left out, whichever of the two it is; the zeros follow.
      at += sign - 1;
      continue;
    }
    out += text[at];
  }
  return out;
}

}  // namespace plumbline

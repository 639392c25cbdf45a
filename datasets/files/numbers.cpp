// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/numbers.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <limits>

#include <fmt/format.h>

namespace plumbline {
namespace {

// A decimal as mantissa * 10^exponent. Digits beyond the 19 that fit are dropped and counted.
struct Decimal {
  std::uint64_t mantissa = 0;
  int exponent = 0;
  bool negative = false;
  const char* next = nullptr;
};

// Up to here ten times the mantissa and one more digit stay below 2^64.
constexpr std::uint64_t kRoomForOneMore = std::numeric_limits<std::uint64_t>::max() / 10 - 1;

// Takes the digits at `at`; each one moves the exponent by `per_digit` (-1 behind the point).
const char* takeDigits(const char* at, const char* end, int per_digit, Decimal& number) {
  const char* const first = at;
  std::uint64_t mantissa = number.mantissa;
  while (at != end && isDigit(*at) && mantissa <= kRoomForOneMore) {
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(*at++ - '0');
  }
  number.mantissa = mantissa;
  number.exponent += per_digit * static_cast<int>(at - first);
  for (; at != end && isDigit(*at); ++at) number.exponent += per_digit + 1;
  return at;
}

// The exponent behind 'e', where digits follow it; else leaves the number as it was.
const char* takeExponent(const char* at, const char* end, Decimal& number) {
  const char* c = at;
  if (c == end || (*c != 'e' && *c != 'E')) return at;
  ++c;
  const bool negative = c != end && *c == '-';
  if (c != end && (*c == '-' || *c == '+')) ++c;
  if (c == end || !isDigit(*c)) return at;
  int exponent = 0;
  // Clamped, so that an exponent of many digits does not overflow an int; no double and no stamp
  // has one of 9999.
  for (; c != end && isDigit(*c); ++c) exponent = std::min(exponent * 10 + (*c - '0'), 9999);
  number.exponent += negative ? -exponent : exponent;
  return c;
}

Decimal scanDecimal(const char* at, const char* end) {
  Decimal number;
  if (at != end && (*at == '-' || *at == '+')) number.negative = *at++ == '-';
  const char* const first = at;
  at = takeDigits(at, end, 0, number);
  auto digits = at - first;
  if (at != end && *at == '.') {
    const char* const point = ++at;
    at = takeDigits(at, end, -1, number);
    digits += at - point;
  }
  if (digits > 0) number.next = takeExponent(at, end, number);
  return number;
}

// Nothing where the product leaves 64 bits; 0 stays 0 whatever the power.
std::optional<std::uint64_t> scaledUp(std::uint64_t mantissa, int power) {
  for (; power > 0 && mantissa != 0; --power) {
    if (mantissa > kRoomForOneMore) return std::nullopt;
    mantissa *= 10;
  }
  return mantissa;
}

/// Rounded at the last digit, halves away from zero.
std::uint64_t scaledDown(std::uint64_t mantissa, int power) {
  // A mantissa is below 2^64, about 1.8e19: a 10^20th of it rounds to 0.
  if (power > 19) return 0;
  for (; power > 1; --power) mantissa /= 10;  // digits below the first dropped one cannot round up
  return power == 0 ? mantissa : (mantissa / 10) + (mantissa % 10 >= 5 ? 1 : 0);
}

/// Words that YAML readers take for something else than text.
bool isYamlWord(const std::string& text) {
  constexpr std::string_view kWords[] = {"null", "true", "false", "yes", "no",
                                         "on",   "off",  "y",     "n"};
  return std::ranges::find(kWords, lowered(text)) != std::end(kWords);
}

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
    text += fmt::format("\\x{:02x}", code);
  } else {
    text += fmt::format("\\u{:04x}", code);
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

bool isPlain(char c, std::string_view also) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || isDigit(c) ||
         also.find(c) != also.npos;
}

std::string lowered(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

ScannedNumber scanNumber(const char* at, const char* end) {
  // from_chars() takes no plus, and behind one would take a minus.
  const char* const first = at != end && *at == '+' ? at + 1 : at;
  ScannedNumber scanned;
  const auto [stop, error] = std::from_chars(first, end, scanned.value);
  if (error == std::errc::invalid_argument || (first != at && *first == '-')) return {};
  if (error == std::errc::result_out_of_range) {  // then from_chars leaves the value alone
    const Decimal number = scanDecimal(first, end);
    scanned.value = number.exponent > 0 ? std::numeric_limits<double>::infinity() : 0.0;
  }
  scanned.next = stop;
  return scanned;
}

std::optional<double> parseNumber(std::string_view text) {
  const char* const end = text.data() + text.size();
  const ScannedNumber scanned = scanNumber(text.data(), end);
  if (text.empty() || scanned.next != end) return std::nullopt;
  return scanned.value;
}

std::optional<TimeNs> parseStamp(std::string_view text, int power) {
  const char* const end = text.data() + text.size();
  // Never through a double: at 1.4e9 s a double's steps are 0.24 us, and stamps must match exactly.
  const Decimal number = scanDecimal(text.data(), end);
  if (text.empty() || number.next != end) return std::nullopt;
  const int shift = number.exponent + power;
  const auto magnitude =
      shift >= 0 ? scaledUp(number.mantissa, shift) : scaledDown(number.mantissa, -shift);
  if (!magnitude || *magnitude > static_cast<std::uint64_t>(std::numeric_limits<TimeNs>::max())) {
    return std::nullopt;
  }
  const auto stamp = static_cast<TimeNs>(*magnitude);
  return number.negative ? -stamp : stamp;
}

std::string yamlNumber(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".ni") != std::string::npos) return text;  // has one, or nan, inf
  return text.insert(std::min(text.find('e'), text.size()), ".0");
}

std::string yamlText(const std::string& text) {
  const auto plain = [](char c) { return isPlain(c, "_/.-"); };
  const bool begins =
      !text.empty() && (text[0] == '/' || std::isalpha(static_cast<unsigned char>(text[0])) != 0);
  if (begins && !isYamlWord(text) && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      quoted += fmt::format("\\x{:02x}", byte);
    } else {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string yamlList(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + yamlNumber(value);
  return "[" + text + "]";
}

std::string yamlRows(const Eigen::MatrixXd& M, const std::string& indent) {
  std::string text;
  for (Eigen::Index i = 0; i < M.rows(); ++i) text += indent + "- " + yamlList(M.row(i)) + "\n";
  return text;
}

}  // namespace plumbline

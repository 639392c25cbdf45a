// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/csv_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace plumbline {
namespace {

// The beginning of a field for a message, without bytes that a terminal would act upon.
std::string quotable(std::string_view text) {
  std::string out(text.substr(0, 40));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

constexpr std::array<double, 16> kPowersOfTen = {1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

// A plain decimal of at most 15 digits at the start of [c, end): mantissa and power of ten are both
// exact doubles, so that one division rounds correctly. Returns where it ends, null for anything
// else.
const char* parsePlain(const char* c, const char* end, double& value, int& decimals) {
  const bool negative = c != end && *c == '-';
  if (negative) ++c;
  const char* const first = c;
  std::uint64_t mantissa = 0;
  while (c != end && isDigit(*c)) mantissa = mantissa * 10 + static_cast<std::uint64_t>(*c++ - '0');
  const auto whole = c - first;
  decimals = 0;
  if (c != end && *c == '.') {
    const char* const point = ++c;
    while (c != end && isDigit(*c)) {
      mantissa = mantissa * 10 + static_cast<std::uint64_t>(*c++ - '0');
    }
    decimals = static_cast<int>(c - point);
  }
  if (whole + decimals == 0 || whole + decimals > 15) return nullptr;
  const double magnitude =
      static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(decimals)];
  value = negative ? -magnitude : magnitude;
  return c;
}

// Any decimal, with an exponent or many digits. False: not a number.
bool parseAny(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

}  // namespace

CsvTable::CsvTable(const std::string& path, const std::string& layout, NoRows no_rows)
    : path_(path), layout_(layout), file_(path) {
  const std::string_view text = file_.text();
  at_ = text.data();
  end_ = at_ + text.size();
  if (text.substr(0, 3) == "\xEF\xBB\xBF") at_ += 3;
  row_end_ = field_ = at_;
  readHeader();
  const char* c = at_;
  while (c != end_ && std::isspace(static_cast<unsigned char>(*c)) != 0) ++c;
  if (c == end_ && (no_rows == NoRows::kRefuse || header_.empty())) {
    throw badInput(path_, 0,
                   {text.empty() ? "is empty" : "has no rows", "rows of " + layout_,
                    "was the recording or the copy interrupted? Export the file again"});
  }
}

void CsvTable::readHeader() {
  while (at_ != end_) {
    const auto* stop =
        static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
    if (stop == nullptr) stop = end_;
    std::string_view text = trimmed({at_, static_cast<std::size_t>(stop - at_)});
    const bool comment = !text.empty() && text.front() == '#';
    const bool words = !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0;
    if (!text.empty() && !comment && !(words && header_.empty() && line_ == 0)) return;
    if (comment) text = trimmed(text.substr(1));
    if (!text.empty() && header_.empty()) {
      for (std::size_t from = 0; from <= text.size();) {
        const std::size_t comma = std::min(text.find(',', from), text.size());
        header_.emplace_back(trimmed(text.substr(from, comma - from)));
        from = comma + 1;
      }
    }
    ++line_;
    at_ = stop == end_ ? end_ : stop + 1;
  }
}

bool CsvTable::next() {
  while (at_ != end_) {
    const auto* stop =
        static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
    const char* const begin = at_;
    row_end_ = stop == nullptr ? end_ : stop;
    at_ = stop == nullptr ? end_ : stop + 1;
    ++line_;
    if (row_end_ != begin && row_end_[-1] == '\r') --row_end_;
    if (row_end_ == begin || *begin == '#') continue;
    field_ = begin;
    return true;
  }
  return false;
}

bool CsvTable::truncatedHere() const { return at_ == end_ && end_[-1] != '\n'; }

std::string_view CsvTable::field(const char* name) {
  if (field_ == nullptr) {
    const std::string cut = truncatedHere() ? "the last line is cut: " : "";
    throw fault({cut + "column '" + name + "' is missing", "a row of " + layout_,
                 truncatedHere() ? "the file is truncated: copy it again or delete this line"
                                 : "repair or delete this line"});
  }
  const char* const begin = field_;
  const char* c = begin;
  while (c != row_end_ && *c != ',') ++c;
  field_ = c == row_end_ ? nullptr : c + 1;
  std::string_view text(begin, static_cast<std::size_t>(c - begin));
  if (!text.empty() && (text.front() <= ' ' || text.back() <= ' ')) text = trimmed(text);
  return text;
}

void CsvTable::failField(const char* name, std::string_view text, const char* expected) const {
  throw fault({"column '" + std::string(name) + "' is '" + quotable(text) + "'", expected,
               truncatedHere() ? "the file is truncated: copy it again or delete this line"
                               : "repair or delete this line"});
}

bool CsvTable::takeUpTo(const char* stop) {
  if (stop != row_end_ && *stop != ',') return false;
  field_ = stop == row_end_ ? nullptr : stop + 1;
  return true;
}

TimeNs CsvTable::stamp() {
  // Rows of one frame: the text of the row above once more.
  if (stamp_text_ != nullptr && field_ != nullptr &&
      row_end_ - field_ > static_cast<std::ptrdiff_t>(stamp_size_) &&
      std::memcmp(field_, stamp_text_, stamp_size_) == 0 && takeUpTo(field_ + stamp_size_)) {
    return stamp_;
  }
  const std::string_view text = field("timestamp [ns]");
  TimeNs value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && stop == text.data() + text.size();
  if (!whole && text.find('.') != std::string_view::npos) {
    throw fault({"the stamp '" + quotable(text) + "' has a decimal point",
                 "an integer number of nanoseconds",
                 "stamps in seconds must be multiplied by 1e9 and written as integers"});
  }
  if (!whole) failField("timestamp [ns]", text, "an integer number of nanoseconds");
  if (value < 0) failField("timestamp [ns]", text, "a stamp that is not negative");
  stamp_text_ = text.data();
  stamp_size_ = text.size();
  stamp_ = value;
  return value;
}

int CsvTable::integer(const char* name) {
  int value = 0;
  if (field_ != nullptr) {
    const auto [stop, error] = std::from_chars(field_, row_end_, value);
    if (error == std::errc() && takeUpTo(stop)) return value;
  }
  const std::string_view text = field(name);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) {
    failField(name, text, "an integer");
  }
  return value;
}

double CsvTable::number(const char* name) {
  const int decimals_before = decimals_;
  double value = 0;
  const char* const begin = field_;
  const char* stop = begin == nullptr ? nullptr : parsePlain(begin, row_end_, value, decimals_);
  std::string_view text;
  if (stop != nullptr && takeUpTo(stop)) {
    text = {begin, static_cast<std::size_t>(stop - begin)};
  } else {  // blanks around it, an exponent, many digits, or no number
    text = field(name);
    stop = text.data() + text.size();
    if (parsePlain(text.data(), stop, value, decimals_) != stop) {
      if (!parseAny(text, value)) failField(name, text, "a number");
      if (!std::isfinite(value)) failField(name, text, "a finite number");
    }
  }
  // A last line without its newline may have lost digits of its last number: that would be a wrong
  // value rather than a missing one.
  if (field_ == nullptr && truncatedHere() && decimals_ < decimals_before) {
    throw fault({"the last line ends without a newline and '" + std::string(text) +
                     "' has fewer decimals than the numbers before it, so it may be cut",
                 "a whole last line", "copy the file again, or end the line if it is complete"});
  }
  return value;
}

std::string_view CsvTable::word(const char* name) { return field(name); }

void CsvTable::endRow() {
  if (field_ == nullptr) return;
  throw fault({"the row has more columns than expected", "a row of " + layout_,
               "repair or delete this line"});
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/amount_list.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostAmounts = 10'000;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(separator, from), text.size());
    parts.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return parts;
}

double numberOf(const std::string& option, std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size() && std::isfinite(value)) {
    return value;
  }
  throw InputError(fmt::format(
      "{}: '{}' is no number; expected numbers and ranges FROM:STEP:TO separated by commas", option,
      word));
}

double cleaned(double value) { return std::strtod(fmt::format("{:.12g}", value).c_str(), nullptr); }

void addRange(const std::string& option, const std::vector<std::string_view>& ends,
              std::vector<double>& amounts) {
  const double from = numberOf(option, ends[0]);
  const double step = numberOf(option, ends[1]);
  const double to = numberOf(option, ends[2]);
  const double count = std::floor((to - from) / step + 1e-9);
  if (step == 0 || !(count >= 0) || count > kMostAmounts) {
    throw InputError(fmt::format(
        "{} {}:{}:{}: expected a step that leads from the first to the last in at most {} steps",
        option, from, step, to, kMostAmounts));
  }
  for (int k = 0; k <= static_cast<int>(count); ++k) amounts.push_back(cleaned(from + k * step));
}

}  // namespace

std::vector<double> amountsFrom(const std::string& option, const std::string& words) {
  std::vector<double> amounts;
  for (const std::string_view word : split(words, ',')) {
    const auto parts = split(word, ':');
    if (parts.size() == 1) {
      amounts.push_back(numberOf(option, word));
    } else if (parts.size() == 3) {
      addRange(option, parts, amounts);
    } else {
      throw InputError(fmt::format("{}: '{}' is no range; expected FROM:STEP:TO", option, word));
    }
  }
  if (amounts.size() > kMostAmounts) {
    throw InputError(fmt::format("{}: more than {} amounts", option, kMostAmounts));
  }
  return amounts;
}

}  // namespace plumbline

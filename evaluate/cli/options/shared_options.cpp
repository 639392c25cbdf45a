// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/shared_options.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <set>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "evaluate/trajectory/find_runs.h"

namespace plumbline {

CLI::Validator numberThat(const std::string& is, const std::function<bool(double)>& holds) {
  return CLI::Validator(
      [is, holds](const std::string& word) {
        double value = 0;
        // CLI11 takes inf for a number, which is above every least one.
        const bool number = CLI::detail::lexical_cast(word, value) && std::isfinite(value);
        return number && holds(value) ? "" : fmt::format("{}: expected {}", word, is);
      },
      "");
}

CLI::Validator positiveNumber() {
  return numberThat("a positive number", [](double value) { return value > 0; });
}

CLI::Validator numberWithin(double least, double most) {
  return numberThat(fmt::format("{:g} to {:g}", least, most),
                    [=](double value) { return value >= least && value <= most; });
}

CLI::Validator numberFrom(double least) {
  return numberThat(fmt::format("{:g} or more", least),
                    [=](double value) { return value >= least; });
}

CLI::Validator seedFrom(std::uint64_t least) {
  return CLI::Validator(
      [least](const std::string& word) {
        std::uint64_t value = 0;
        const char* const end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data(), end, value);
        if (error == std::errc() && stop == end && value >= least) return std::string();
        return fmt::format("{}: expected a whole number from {} to 18446744073709551615", word,
                           least);
      },
      "");
}

std::vector<std::pair<std::string, std::string>> givenOptions(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name(false, false);
    // Where results go and how they are told and made stays out, so that equal results state equal
    // options (the command line, beside them, has all); the session is the input, which is stated
    // beside its hash.
    static const std::set<std::string> kWithoutEffect = {
        "--out",     "--force", "--json",     "session", "--fail-on", "--no-report",
        "--threads", "--cache", "--no-cache", "--jobs",  "--engine"};
    if (option->count() == 0 || kWithoutEffect.contains(name)) continue;
    if (name.starts_with("--slurm-") || name.starts_with("--merge-")) continue;
    // A flag has no value.
    given.emplace_back(name, option->get_expected_max() == 0
                                 ? "yes"
                                 : fmt::format("{}", fmt::join(option->results(), ",")));
  }
  return given;
}

void refuseBefore(const CLI::App& app, const CLI::App& sub) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0) continue;
    throw InputError(
        fmt::format("{} stands before {}, which it is no option of; omit it, or give it after {}",
                    option->get_name(), sub.get_name(), sub.get_name()));
  }
}

std::vector<std::string> givenInputs(std::vector<std::optional<std::string>> inputs) {
  std::vector<std::string> given;
  for (auto& input : inputs) {
    if (input && !input->empty()) given.push_back(*std::move(input));
  }
  return given;
}

std::vector<std::string> filesOf(const std::string& pattern) {
  if (pattern.empty()) return {};
  std::vector<std::string> files;
  for (const RunFile& file : findRuns(pattern)) files.push_back(file.path.string());
  return files;
}

}  // namespace plumbline

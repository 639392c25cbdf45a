// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>

namespace plumbline {

/// Names and values of the options that were given, in their order, for the provenance; without
/// those that no result depends on.
std::vector<std::pair<std::string, std::string>> givenOptions(const CLI::App& app);

/// Throws InputError where an option was given before the subcommand `sub` of `app`, for which it
/// would have no effect.
void refuseBefore(const CLI::App& app, const CLI::App& sub);

/// An option whose default help shows.
template <class Value>
CLI::Option* addWithDefault(CLI::App& app, const char* name, Value& value,
                            const std::string& help) {
  return app.add_option(name, value, help)->capture_default_str();
}

/// What an option's number must be; NaN and infinity never are. Whole numbers where it is an int.
CLI::Validator numberThat(const std::string& is, const std::function<bool(double)>& holds);
CLI::Validator positiveNumber();
CLI::Validator numberWithin(double least, double most);
CLI::Validator numberFrom(double least);
/// A whole number of at most 64 bits: beyond them it would be cut silently.
CLI::Validator seedFrom(std::uint64_t least);

/// The inputs that were given, of options that need not be.
std::vector<std::string> givenInputs(std::vector<std::optional<std::string>> inputs);

/// The files that a pattern of `evaluate trajectories` finds; none for "".
std::vector<std::string> filesOf(const std::string& pattern);

}  // namespace plumbline

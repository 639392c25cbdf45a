// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>

namespace plumbline {

/// Least number of insertions, deletions, replacements and swaps of neighbours that make one word
/// of the other (optimal string alignment: no part is edited twice).
int editDistance(std::string_view a, std::string_view b);

/// The candidate nearest to a word that was mistyped, at most a third of its letters away (one at
/// least); "" where none is. The first of equals.
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

/// "; did you mean --out?" where an argument that the chosen command does not know resembles one
/// that it does; "" otherwise. `app` after a parse that failed.
std::string didYouMean(const CLI::App& app);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/view_terms.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline {

/// The words of the command line as values. Each throws InputError naming the option, the word and
/// what it may be.

/// A finite number that is the whole word, with a decimal point; empty for all else.
std::optional<double> finiteNumber(const std::string& word);

/// The value of a word among those that are known.
template <class Value>
Value wordFrom(const char* option, const std::string& word,
               const std::vector<std::pair<std::string, Value>>& known) {
  for (const auto& [name, value] : known) {
    if (name == word) return value;
  }
  const auto name_of = [](const auto& each) { return each.first; };
  throw InputError(fmt::format("{} {}: expected {}", option, word, joined(known, name_of, " or ")));
}

/// The value of an enumeration's word, of the option named.
template <WordedEnum E>
E enumValue(const std::string& option, const std::string& word) {
  if (const auto value = enumFrom<E>(word)) return *value;
  throw InputError(fmt::format("{} {}: expected one of {}", option, word, allWords<E>()));
}

/// "none" or "cauchy:SCALE" -> scale of the Cauchy loss [px]; 0 for none.
double lossFrom(const std::string& word);

/// "none", "sigma:K", "kalibr" -> filter and K (0 where it has none).
std::pair<CornerFilter, double> outliersFrom(const std::string& word);

/// "mi:0.2bits" (or "mi:0.139nats"): by mutual information with this threshold; "predicted-error"
/// or "predicted-error:2%": by predicted error, until it adds no more than this. Without a seed.
ViewSelectionOptions viewSelectionFrom(const std::string& word);

/// "pinhole-radtan,pinhole-equidistant" -> one per camera; a single one stands for all cameras.
std::vector<CameraModelPair> modelsFrom(const std::string& words);
/// A single one, of the option named.
CameraModelPair modelFrom(const std::string& option, const std::string& word);

/// "752x480", of the option named.
Resolution resolutionFrom(const std::string& word, const char* option = "--resolution");

/// "rmse_px=1.5,3" (caution, bad) changes one threshold of the verdict.
void setThreshold(const std::string& assignment, VerdictThresholds& thresholds);

/// Milliseconds as written on the command line to nanoseconds, rounded to the nearest. Anything
/// that is not a number, or longer than a day, is refused in the option's name.
TimeNs nanosecondsFromMilliseconds(const std::string& option, double milliseconds);

}  // namespace plumbline

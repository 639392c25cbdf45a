// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/core.h>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

std::string evidenceOf(const HalvesBlock& b) {
  const auto [unit, factor] = shownUnit(b.unit);
  const std::string word = *unit == '\0' ? "" : std::string(" ") + unit;
  return fmt::format(
      "{} of the second half minus that of the first is {:+.4g}{}, with a standard deviation of "
      "{:.2g}{} (chi-square of {}: {:.1f} for {} parameters, 99 % bound {:.1f})",
      b.worst, factor * b.difference, word, factor * b.std, word, b.name, b.chi2, b.parameters,
      b.limit);
}

}  // namespace

Findings judgeHalves(const StageSummary& summary, const std::string& stage,
                     const VerdictThresholds& t) {
  if (!summary.halves || summary.halves->blocks.empty()) return {};
  // Over its own limit, as blocks have different numbers of parameters.
  const auto ratio = [](const HalvesBlock& b) { return b.chi2 / b.limit; };
  const std::vector<HalvesBlock>& blocks = summary.halves->blocks;
  // NaN is the largest, which above() then calls bad.
  const auto worst = std::max_element(
      blocks.begin(), blocks.end(),
      [&](const HalvesBlock& a, const auto& b) { return isLarger(ratio(b), ratio(a)); });
  const Rule rule{fmt::format("Halves of the recording ({})", stage), "x", t.halves,
                  "The halves differ by more than their standard deviations explain: take the "
                  "difference as the accuracy. Something changed during the recording, or the "
                  "model lacks an effect: resolve the other findings first, then calibrate each "
                  "half (--to, --from) and see which one a second recording confirms."};
  return {above(rule, ratio(*worst), evidenceOf(*worst))};
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/html/comparison/sections.h"
#include "report/html/page.h"

namespace plumbline::html_internal {
namespace {

using Values = std::vector<std::optional<double>>;

/// Empty also where the column ends earlier: a record may have been read from a store.
std::optional<double> at(const Values& column, std::size_t k) {
  return k < column.size() ? column[k] : std::nullopt;
}

/// "458.654 ± 0.080", or the reason why there is nothing.
std::string estimateText(const ComparedParameter& p, std::size_t k, double factor) {
  const auto value = at(p.values, k);
  if (!value) return "\u2013 (not in this file)";
  const auto std = at(p.std, k);
  // Without a deviation, six significant digits.
  if (!std || !(*std > 0)) return withPrecisionOf(factor * *value, 0);
  return withPrecisionOf(factor * *value, factor * *std) + " \u00b1 " + twoDigits(factor * *std);
}

Cell significanceCell(const ComparedParameter& p, std::size_t k) {
  const auto n = at(p.significance, k);
  if (n) {
    // The level is the record's. Most are good, which has no dot and no words.
    const VerdictLevel judged = k < p.levels.size() ? p.levels[k] : VerdictLevel::kGood;
    const char* words[] = {"", ", notable", ", differs"};
    std::optional<VerdictLevel> level;
    if (judged != VerdictLevel::kGood) level = judged;
    return {fmt::format("{:.1f} \u03c3{}", *n, words[static_cast<int>(judged)]), kNumber, level};
  }
  if (!at(p.values, k) || !at(p.values, 0)) return number(kDash);
  return number("\u2013 (no std)");
}

/// What a table shows of each calibration but the first: its values too, or what differs alone.
enum class Shown { kValues, kDifferences };

std::vector<Cell> parameterColumns(const std::vector<std::string>& labels, Shown shown) {
  std::vector<Cell> columns = {code("Parameter"), words("Unit"), number(labels.front())};
  for (std::size_t k = 1; k < labels.size(); ++k) {
    if (shown == Shown::kValues) columns.push_back(number(labels[k]));
    columns.push_back(number(shown == Shown::kValues ? "Difference" : "\u0394 " + labels[k]));
    columns.push_back(number("Significance"));
  }
  return columns;
}

/// In the unit in which people read it; differences are to the first calibration.
std::vector<Cell> parameterRow(const ComparedParameter& p, std::size_t calibrations, Shown shown) {
  const auto [unit, factor] = readable(p.unit);
  std::vector<Cell> row = {code(p.name), {unit}, number(estimateText(p, 0, factor))};
  for (std::size_t k = 1; k < calibrations; ++k) {
    if (shown == Shown::kValues) row.push_back(number(estimateText(p, k, factor)));
    const auto difference = at(p.difference, k);
    // Of equal values the logarithm of a rotation leaves 1e-15.
    const bool none = difference && std::abs(factor * *difference) < 1e-9;
    const auto* form = p.hasSign() && !none ? "{:+.3g}" : "{:.3g}";
    row.push_back(number(
        difference ? fmt::format(fmt::runtime(form), none ? 0 : factor * *difference) : kDash));
    row.push_back(significanceCell(p, k));
  }
  return row;
}

/// A table for each camera, and for the IMU.
std::vector<Block> parameterBlocks(const std::vector<ComparedParameter>& parameters,
                                   const std::vector<std::string>& labels, Shown shown) {
  std::vector<Block> blocks;
  for (const ComparedParameter& p : parameters) {
    const std::string owner = groupOf(p.name);
    // What the first calibration lacks comes last, under the same heading.
    auto block = std::ranges::find(blocks, owner, &Block::heading);
    if (block == blocks.end()) {
      block = blocks.insert(block, {owner, "", Table{parameterColumns(labels, shown)}});
    }
    block->table->rows.push_back(parameterRow(p, labels.size(), shown));
  }
  return blocks;
}

/// Which calibrations' deviations are robust, and which formal; others state none.
std::string deviationWords(const std::vector<ComparedParameter>& parameters,
                           const std::vector<std::string>& labels) {
  std::string robust, formal;
  const auto add = [](std::string& list, const std::string& entry) {
    list += (list.empty() ? "" : ", ") + entry;
  };
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const auto any = [&](bool with_dof) {
      return std::ranges::any_of(parameters, [&](const ComparedParameter& p) {
        return at(p.std, k) && at(p.dof, k).has_value() == with_dof;
      });
    };
    const bool has_robust = any(true), has_formal = any(false);
    if (has_robust) add(robust, labels[k] + (has_formal ? " (in part)" : ""));
    if (has_formal) add(formal, labels[k] + (has_robust ? " (the others)" : ""));
  }
  std::string text;
  if (!robust.empty())
    text += " Cluster-robust deviations, from blocks of the recording: " + robust + ".";
  if (!formal.empty()) {
    text += " Formal deviations, valid only if model and assumed noise are right: " + formal + ".";
  }
  return text;
}

std::vector<std::string> labelsOf(const ComparisonRecord& record) {
  std::vector<std::string> labels;
  for (const ComparedCalibration& c : record.calibrations) labels.push_back(c.label);
  return labels;
}

/// "ours, kalibr": those that are not known to be of other data than the session.
std::string notHeldOut(const ComparisonRecord& record) {
  std::string names;
  for (const CalibrationScore& s : record.scores) {
    // A fold's in-sample part says nothing of the whole recording.
    if (s.part != "all" || s.held_out) continue;
    names += (names.empty() ? "" : ", ") + s.label;
  }
  return names;
}

}  // namespace

Section comparedParametersSection(const ComparisonRecord& record) {
  Section section{
      "parameters", "Parameters",
      "In one convention: p_A = T_AB p_B, rotations as rotation vectors, t_imu = t_cam "
      "+ t_d. Significance is |difference| over the combined standard deviation of "
      "both; from 2 \u03c3 it is notable, from 3 \u03c3 the two differ by more than "
      "their stated deviations explain. Few degrees of freedom lower it. Without standard "
      "deviations of both there is none. Differences of rotations are rotation vectors of the "
      "rotation from the first to the other, those of angle and lever the angle and distance "
      "between the two: no differences of the columns."};
  section.lead += deviationWords(record.parameters, labelsOf(record));
  section.blocks = parameterBlocks(record.parameters, labelsOf(record), Shown::kValues);
  return section;
}

Section sessionEstimateSection(const ComparisonRecord& record) {
  Section section{"session-estimate", "Comparison with the session's own estimate",
                  "The session itself was calibrated, with the first calibration's camera models. "
                  "\u0394 is each calibration minus that estimate."};
  if (!record.session_estimate) return section;
  const SessionEstimate& own = *record.session_estimate;
  if (!own.problem.empty()) section.blocks.push_back({"", "None: " + own.problem});
  const std::string same = notHeldOut(record);
  if (!same.empty()) {
    section.lead +=
        " Not known to be from other data: " + same +
        ". An estimate from the same session shares its corners: that the two agree shows little.";
  }
  std::vector<std::string> labels = {"the session itself"};
  for (std::string& label : labelsOf(record)) labels.push_back(std::move(label));
  for (Block& block : parameterBlocks(own.parameters, labels, Shown::kDifferences)) {
    section.blocks.push_back(std::move(block));
  }
  return section;
}

}  // namespace plumbline::html_internal

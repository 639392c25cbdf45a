// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

/// Whether a is further off than b; what is not a number is further off than all.
bool further(double a, double b) {
  return !std::isnan(b) && (std::isnan(a) || std::abs(a) > std::abs(b));
}

std::vector<const PerturbationCase*> solvedCases(const PerturbationRecord& record,
                                                 PerturbationKind kind) {
  std::vector<const PerturbationCase*> cases;
  for (const PerturbationCase& c : record.cases) {
    if (c.kind == toString(kind) && c.problem.empty()) cases.push_back(&c);
  }
  return cases;
}

/// "within 1 ms: 3 of 6 tested between -300 and +300 ms; nearest to zero of the others: -200 and
/// +300 ms".
std::string recoveredText(const TestedOffsets& tested, double bound_s) {
  std::string text = fmt::format("within {:g} ms: ", 1e3 * bound_s);
  text += tested.recovered == tested.count
              ? fmt::format("all {} tested", tested.count)
              : fmt::format("{} of {} tested", tested.recovered, tested.count);
  text += tested.from_ms == tested.to_ms
              ? fmt::format(" at {:+g} ms", tested.from_ms)
              : fmt::format(" between {:+g} and {:+g} ms", tested.from_ms, tested.to_ms);
  const auto& below = tested.lost_below_ms;
  const auto& above = tested.lost_above_ms;
  if (!below && !above) return text;
  text += "; nearest to zero of the others:";
  if (below) text += fmt::format(" {:+g}", *below);
  if (above) text += fmt::format("{} {:+g}", below ? " and" : "", *above);
  return text + " ms";
}

std::optional<Finding> offsetFinding(const PerturbationRecord& record,
                                     const PerturbationThresholds& bounds) {
  constexpr const char* kRule = "Injected time offsets recovered";
  const auto shifts = solvedCases(record, PerturbationKind::kImuShift);
  if (shifts.empty()) return std::nullopt;
  // Which is recovered by definition.
  if (std::ranges::all_of(shifts, [](const PerturbationCase* c) { return c->amount == 0; })) {
    return Finding{kRule, VerdictLevel::kCaution, "not tested: no offset other than 0 was solved",
                   "inject offsets such as --offsets-ms 100,10,1"};
  }
  const PerturbationCase& worst = **std::max_element(
      shifts.begin(), shifts.end(), [](const PerturbationCase* a, const PerturbationCase* b) {
        return further(b->offset_error_s, a->offset_error_s);
      });
  const double error = std::abs(worst.offset_error_s);
  const VerdictLevel level = levelAbove(error, bounds.offset_error_s);
  const TestedOffsets tested = testedOffsets(record, bounds.offset_error_s.bad);
  const bool one = tested.count == 1;  // is no worst of several, and says nothing of a range
  std::string evidence =
      fmt::format("the {}, {:+g} ms, is recovered to {} (recovered - injected - base)",
                  one ? "only one tested" : "worst", worst.amount,
                  error < 1e-9   ? "less than 0.001 us"
                  : error < 1e-3 ? fmt::format("{:.4g} us", 1e6 * error)
                                 : fmt::format("{:.4g} ms", 1e3 * error));
  if (!one) evidence += "; " + recoveredText(tested, bounds.offset_error_s.bad);
  return Finding{kRule,
                 level,
                 evidence,
                 level == VerdictLevel::kGood
                     ? ""
                     : "the cause was not tested; the offset is found by rotation: record "
                       "faster rotation about all axes, or take a known offset out of the stamps",
                 error,
                 bounds.offset_error_s.caution,
                 "s"};
}

/// Shifted stamps move the time offset and nothing else: any other change is an error of the
/// estimation, hence a bound far below one deviation.
std::optional<Finding> othersFinding(const PerturbationRecord& record,
                                     const PerturbationThresholds& bounds) {
  double largest = 0;
  std::string name;
  double amount = 0;
  for (const PerturbationCase* c : solvedCases(record, PerturbationKind::kImuShift)) {
    if (c->amount == 0) continue;
    const auto i = largestOtherChange(record.parameters, *c);
    // The first is taken whatever it is, also 0.
    if (!i || (!name.empty() && !further(c->changes_sigma[*i], largest))) continue;
    largest = std::abs(c->changes_sigma[*i]);
    name = record.parameters[*i];
    amount = c->amount;
  }
  if (name.empty()) return std::nullopt;
  const VerdictLevel level = levelAbove(largest, bounds.change_sigma);
  return Finding{"Other parameters under shifted IMU stamps",
                 level,
                 fmt::format("largest change: {} by {:.2g} of its standard deviations, at {:+g} ms",
                             name, largest, amount),
                 level == VerdictLevel::kGood
                     ? ""
                     : "the offset biases other parameters; record motion that separates them",
                 largest,
                 bounds.change_sigma.caution,
                 "sigma"};
}

// First order: of independent errors, leaving out a share q of the data moves an estimate by
// sqrt(q / (1 - q)) of its standard deviation, and further corner noise s by s / sigma. What is
// stated otherwise (the target's size, densities, starting values) should not move it at all.
double predictedSigma(const PerturbationRecord& record, const PerturbationCase& c) {
  const bool dropped = c.kind == toString(PerturbationKind::kDroppedFrames) ||
                       c.kind == toString(PerturbationKind::kDroppedImu);
  // As if one per cent were kept at least, so that the root stays small near 100 %.
  // Hausman (1978): of an efficient estimate from all data and one from a part, the variance of the
  // difference is the difference of the variances, 1 / (1 - q) - 1 = q / (1 - q).
  if (dropped) return std::sqrt(c.amount / std::max(100 - c.amount, 1.0));
  if (c.kind == toString(PerturbationKind::kCornerNoise)) {
    return c.amount / record.assumptions.pixel_sigma_px;
  }
  return 0;
}

struct LargestChange {
  const PerturbationCase* of = nullptr;
  std::string parameter;
  double sigmas = 0, bound = 0;
};

// What the largest of so many independent normal deviates exceeds as rarely as one exceeds three
// deviations, or more rarely.
double boundOfLargest(std::size_t count) {
  return std::sqrt(9 + 2 * std::log(static_cast<double>(std::max<std::size_t>(count, 1))));
}

// Of a kind of perturbations, where it stands highest over its bound: three predicted deviations,
// more of many changes (boundOfLargest()), and at least what offsets may do.
LargestChange largestChange(const PerturbationRecord& record, PerturbationKind kind,
                            double least_bound) {
  LargestChange largest;
  const auto cases = solvedCases(record, kind);
  std::size_t count = 0;
  for (const PerturbationCase* c : cases) count += c->changes_sigma.size();
  for (const PerturbationCase* of : cases) {
    const PerturbationCase& c = *of;
    const double bound = std::max(least_bound, boundOfLargest(count) * predictedSigma(record, c));
    for (std::size_t i = 0; i < c.changes_sigma.size(); ++i) {
      // No deviation is stated: the change is finite, and there is nothing to hold it against.
      const bool unknown_std = std::isnan(c.changes_sigma[i]) && std::isfinite(c.changes[i]);
      if (unknown_std) continue;
      const double change = std::abs(c.changes_sigma[i]);
      if (largest.of != nullptr && !further(change / bound, largest.sigmas / largest.bound)) {
        continue;
      }
      largest = {&c, record.parameters[i], change, bound};
    }
  }
  return largest;
}

constexpr const char* kUnexplained =
    "more than independent errors explain; the cause was not tested: see the verdict of the "
    "calibration, and whether its halves agree";

/// What to do where a kind of perturbations moves the parameters, in the order of the findings.
constexpr std::pair<PerturbationKind, const char*> kAdvice[] = {
    {PerturbationKind::kTargetSize,
     "lengths follow the stated target: measure tagSize on the printed board"},
    {PerturbationKind::kNoiseDensities,
     "the result depends on imu.yaml: take the densities from a static recording (Allan "
     "deviation), or record more motion"},
    {PerturbationKind::kInitialIntrinsics,
     "the solution depends on its start values: give better ones with --cameras and "
     "--free-cameras"},
    {PerturbationKind::kDroppedFrames, kUnexplained},
    {PerturbationKind::kDroppedImu, kUnexplained},
    {PerturbationKind::kCornerNoise, kUnexplained}};

/// Caution at most: perturbed inputs are worse inputs.
std::optional<Finding> kindFinding(const PerturbationRecord& record, PerturbationKind kind,
                                   const char* advice, const PerturbationThresholds& bounds) {
  const LargestChange largest = largestChange(record, kind, bounds.change_sigma.caution);
  if (largest.of == nullptr) return std::nullopt;
  // Written so that NaN is no good.
  const bool good = largest.sigmas <= largest.bound;
  Finding f{fmt::format("Parameters under {}", toString(kind)),
            good ? VerdictLevel::kGood : VerdictLevel::kCaution,
            fmt::format("largest change: {} by {:.2g} of its standard deviations, at {}",
                        largest.parameter, largest.sigmas, amountText(*largest.of)),
            good ? "" : advice,
            largest.sigmas,
            largest.bound,
            "sigma"};
  if (const double predicted = predictedSigma(record, *largest.of); predicted > 0) {
    f.evidence += fmt::format("; first order predicts {:.2g} (one sigma)", predicted);
  }
  return f;
}

Finding failuresFinding(const PerturbationRecord& record) {
  std::size_t failed = 0;
  const PerturbationCase* first = nullptr;
  for (const PerturbationCase& c : record.cases) {
    if (c.problem.empty()) continue;
    if (failed++ == 0) first = &c;
  }
  VerdictLevel level = failed == 0 ? VerdictLevel::kGood : VerdictLevel::kCaution;
  // Then the study says nothing.
  if (failed > 0 && failed == record.cases.size()) level = VerdictLevel::kBad;
  Finding f{
      "Solved cases",
      level,
      fmt::format("{} of {} cases were solved", record.cases.size() - failed, record.cases.size()),
      "",
      static_cast<double>(failed),
      0,
      "cases"};
  if (first != nullptr) {
    f.evidence += fmt::format("; the first that failed, {} {}: {}", first->kind, amountText(*first),
                              first->problem);
    f.advice = "cases fail where the perturbation is too large to start from, or must be refused";
  }
  return f;
}

}  // namespace

TestedOffsets testedOffsets(const PerturbationRecord& record, double bound_s) {
  TestedOffsets tested;
  for (const PerturbationCase& c : record.cases) {
    if (c.kind != toString(PerturbationKind::kImuShift)) continue;
    tested.from_ms = tested.count == 0 ? c.amount : std::min(tested.from_ms, c.amount);
    tested.to_ms = tested.count == 0 ? c.amount : std::max(tested.to_ms, c.amount);
    ++tested.count;
    if (c.problem.empty() && std::abs(c.offset_error_s) <= bound_s) {
      ++tested.recovered;
      continue;
    }
    std::optional<double>& lost = c.amount < 0 ? tested.lost_below_ms : tested.lost_above_ms;
    if (!lost || std::abs(c.amount) < std::abs(*lost)) lost = c.amount;
  }
  return tested;
}

std::vector<Finding> perturbationFindings(const PerturbationRecord& record,
                                          const PerturbationThresholds& thresholds) {
  std::vector<Finding> findings;
  if (auto f = offsetFinding(record, thresholds)) findings.push_back(std::move(*f));
  if (auto f = othersFinding(record, thresholds)) findings.push_back(std::move(*f));
  for (const auto& [kind, advice] : kAdvice) {
    if (auto f = kindFinding(record, kind, advice, thresholds)) findings.push_back(std::move(*f));
  }
  // Always there, so that no study is without a finding.
  findings.push_back(failuresFinding(record));
  return findings;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/lone_parameters.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/compare/findings.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostNamedPlaces = 4;
constexpr std::size_t kFewest = 3;  // of two that differ, neither is the odd one

struct Estimate {
  std::size_t calibration = 0;
  double difference = 0;  ///< to the first calibration
  EstimatedVariance variance;
};

std::vector<Estimate> estimatesOf(const ComparedParameter& p) {
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < p.values.size(); ++i) {
    if (!p.values[i] || !p.std[i] || !(*p.std[i] > 0)) continue;
    // A value alone is not enough: of another camera model it does not compare.
    if (i > 0 && !p.difference[i]) continue;
    estimates.push_back({i, i == 0 ? 0 : *p.difference[i], p.variance(i)});
  }
  // Without the first there is nothing that the others' differences refer to.
  if (estimates.empty() || estimates.front().calibration != 0) return {};
  return estimates;
}

/// As if the two estimates were independent; those of one recording share its noise and differ by
/// less.
double sigmas(const Estimate& a, const Estimate& b) {
  return normalDeviate(a.difference - b.difference, sumOf(a.variance, b.variance));
}

/// How far the k-th is from the others at least, and these from each other at most.
LoneParameter against(const std::vector<Estimate>& estimates, std::size_t k) {
  LoneParameter lone;
  lone.calibration = estimates[k].calibration;
  lone.sigmas = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (i == k) continue;
    lone.sigmas = std::min(lone.sigmas, sigmas(estimates[i], estimates[k]));
    for (std::size_t j = 0; j < i; ++j) {
      if (j != k) lone.others = std::max(lone.others, sigmas(estimates[i], estimates[j]));
    }
  }
  return lone;
}

/// Every parameter with every calibration as the one that stands alone; at most one can, as the
/// others have to agree.
std::vector<LoneParameter> loneAmong(const std::vector<ComparedParameter>& parameters) {
  std::vector<LoneParameter> all;
  for (const ComparedParameter& p : parameters) {
    const std::vector<Estimate> estimates = estimatesOf(p);
    if (estimates.size() < kFewest) continue;
    for (std::size_t k = 0; k < estimates.size(); ++k) {
      LoneParameter lone = against(estimates, k);
      // Two bounds, so that between them nobody is accused: far from all others, and these close
      // together.
      if (lone.sigmas <= kThresholds.significance || lone.others > kThresholds.notable) continue;
      lone.name = p.name;
      all.push_back(std::move(lone));
    }
  }
  std::ranges::stable_sort(all, [](const LoneParameter& a, const LoneParameter& b) {
    return a.calibration != b.calibration ? a.calibration < b.calibration : a.sigmas > b.sigmas;
  });
  return all;
}

/// Whether all but this one are known to be from other data than the session.
bool othersHeldOut(const ComparisonRecord& record, std::size_t calibration) {
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    if (i != calibration && !isHeldOut(record, record.calibrations[i].label)) return false;
  }
  return true;
}

/// Whether the recording contradicts every calibration but this one: a majority is no proof.
bool areContradictedBut(const ComparisonRecord& record, std::size_t calibration) {
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    const std::optional<bool>& contradicted = record.calibrations[i].contradicted;
    if (!contradicted || *contradicted == (i == calibration)) return false;
  }
  return true;
}

/// A finding where a calibration stands alone in some parameter against `whom`.
void addLone(const ComparisonRecord& record, const std::vector<LoneParameter>& lone, std::size_t i,
             const char* whom, std::vector<Finding>& findings) {
  const std::string& label = record.calibrations[i].label;
  const std::string names = loneNames(lone, i);
  if (names.empty()) return;
  double most = 0, others = 0;
  for (const LoneParameter& p : lone) {
    if (p.calibration != i) continue;
    most = std::max(most, p.sigmas);
    others = std::max(others, p.others);
  }
  const bool others_are_wrong = areContradictedBut(record, i);
  findings.push_back(finding(
      {fmt::format("{} against {}", label, whom),
       "sigma",
       {kThresholds.significance, 0},
       others_are_wrong
           ? "check what the others share, such as the stated size of their board"
           : "check the recording and the options of " + label + " before the others'"},
      VerdictLevel::kCaution, most,
      fmt::format("{} is the outlier: at least this many standard deviations from each of the "
                  "others, which agree within {:.2g}: {}{}",
                  label, others, names,
                  others_are_wrong
                      ? "; yet the recording contradicts each of them, and not " + label
                      : "")));
}

}  // namespace

std::vector<LoneParameter> loneParameters(const ComparisonRecord& record) {
  return loneAmong(record.parameters);
}

std::vector<LoneParameter> loneAgainstSession(const ComparisonRecord& record) {
  if (!record.session_estimate) return {};
  std::vector<LoneParameter> all;
  for (LoneParameter& p : loneAmong(record.session_estimate->parameters)) {
    // In that list the session's own estimate is the first and no calibration of the comparison;
    // the others come one place later than here.
    if (p.calibration == 0 || !othersHeldOut(record, --p.calibration)) continue;
    all.push_back(std::move(p));
  }
  return all;
}

std::string loneNames(const std::vector<LoneParameter>& lone, std::size_t calibration) {
  std::vector<std::string> names;
  for (const LoneParameter& p : lone) {
    if (p.calibration == calibration) names.push_back(fmt::format("{} ({:.1f})", p.name, p.sigmas));
  }
  return firstNames(std::move(names), kMostNamedPlaces);
}

std::vector<Finding> loneFindings(const ComparisonRecord& record) {
  const std::vector<LoneParameter> lone = loneParameters(record);
  const std::vector<LoneParameter> session = loneAgainstSession(record);
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    addLone(record, lone, i, "all others", findings);
    addLone(record, session, i, "all others and the session itself", findings);
  }
  return findings;
}

}  // namespace plumbline

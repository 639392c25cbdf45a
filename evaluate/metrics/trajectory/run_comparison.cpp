// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include <boost/math/distributions/binomial.hpp>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/trajectory/verdict.h"

namespace plumbline {
namespace {

constexpr std::size_t kLeastPairs = 5;
// So that 250 draws lie beyond either end of a 95 % interval.
constexpr int kResamples = 10'000;

using Place = std::pair<std::string, std::string>;  // sequence, run

/// RMSE of every place of one calibration; NaN where the run is not complete.
std::map<Place, double> errorsOf(const std::vector<TrajectoryRun>& runs, const std::string& which) {
  std::map<Place, double> errors;
  for (const TrajectoryRun& run : runs) {
    if (run.calibration != which) continue;
    // A run without truth is complete and has no error.
    const bool complete = run.status == RunStatus::kComplete && run.ate_translation_m.n > 0;
    errors[{run.sequence, run.run}] = complete ? run.ate_translation_m.rmse : std::nan("");
  }
  return errors;
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Means of bootstrap samples of the pairs, for a percentile interval. Seeded: equal runs give
/// equal intervals.
std::vector<double> resampledMeans(const std::vector<double>& values) {
  std::mt19937_64 random(1);
  std::vector<double> means;
  for (int i = 0; i < kResamples; ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += values[random() % values.size()];
    means.push_back(sum / static_cast<double>(values.size()));
  }
  return means;
}

/// For a test of the mean at 95 % with a power of 80 %.
std::optional<double> pairsNeeded(const PairedDifference& d) {
  // Normal quantiles of 97.5 % and 80 %: n = (sum times deviation over mean)^2.
  constexpr double kNormal = 1.959964 + 0.841621;
  // A deviation of two differences is no basis to plan by; no difference needs no number.
  if (d.pairs < 3 || d.mean_m == 0) return std::nullopt;
  const auto n = static_cast<double>(d.pairs);
  const double spread = kNormal * d.std_m / d.mean_m;
  // std_m has n in its denominator, the power calculation n - 1.
  return std::max(2.0, std::ceil(spread * spread * n / (n - 1)));
}

/// Of differences d [m], b - a: mean, median, deviation (n in the denominator), sign test, and from
/// kLeastPairs pairs on the bootstrap interval of the mean. Nothing is set for no pairs.
void summarise(const std::vector<double>& d, PairedDifference& result) {
  result.pairs = d.size();
  if (d.empty()) return;
  result.mean_m = meanOf(d);
  result.median_m = median(d);
  double squares = 0;
  for (const double value : d) squares += (value - result.mean_m) * (value - result.mean_m);
  result.std_m = std::sqrt(squares / static_cast<double>(d.size()));
  for (const double value : d) {
    if (value < 0) ++result.b_better;
    if (value == 0) ++result.ties;
  }
  result.pairs_needed = pairsNeeded(result);
  result.sign_test_p = signTest(result.b_better, d.size() - result.ties);
  // The percentile interval of a mean of n values is narrower than Student's, by sqrt((n - 1) / n)
  // and by 1.96 / t: of five normal differences it covers about 85 %, not 95. Runs of one sequence
  // count as independent pairs besides. The sign test cannot fall below 0.06 with five.
  if (d.size() < kLeastPairs) return;
  const std::vector<double> means = resampledMeans(d);
  result.low_m = quantile(means, 0.025);
  result.high_m = quantile(means, 0.975);
  // d = error of b - error of a: below zero b is better.
  if (*result.low_m > 0 || *result.high_m < 0)
    result.better = result.mean_m < 0 ? result.b : result.a;
}

PairedDifference compare(const std::vector<TrajectoryRun>& runs, const std::string& a,
                         const std::string& b) {
  PairedDifference result;
  result.a = a;
  result.b = b;
  const auto first = errorsOf(runs, a), second = errorsOf(runs, b);
  std::set<Place> places;
  for (const auto* errors : {&first, &second}) {
    for (const auto& [place, error] : *errors) places.insert(place);
  }
  std::vector<double> d;
  for (const Place& place : places) {
    const auto at_a = first.find(place), at_b = second.find(place);
    const bool both = at_a != first.end() && at_b != second.end() && std::isfinite(at_a->second) &&
                      std::isfinite(at_b->second);
    if (both) {
      d.push_back(at_b->second - at_a->second);
    } else {
      ++result.left_out;
    }
  }
  summarise(d, result);
  return result;
}

std::vector<std::string> inOrder(const std::vector<TrajectoryRun>& runs,
                                 std::string TrajectoryRun::*field) {
  std::vector<std::string> names;
  for (const TrajectoryRun& run : runs) {
    if (std::find(names.begin(), names.end(), run.*field) == names.end()) {
      names.push_back(run.*field);
    }
  }
  return names;
}

/// The median over `expected` runs, of which those without an error stand behind all others: none
/// where half of them or more have no error.
std::optional<double> medianOf(std::vector<double> complete, std::size_t expected) {
  complete.resize(expected, std::numeric_limits<double>::infinity());
  if (expected == 0) return std::nullopt;
  std::sort(complete.begin(), complete.end());
  const double median = 0.5 * (complete[(expected - 1) / 2] + complete[expected / 2]);
  return std::isfinite(median) ? std::optional(median) : std::nullopt;
}

// Of one sequence, or of all where there is none.
RunsSummary summaryOf(const std::vector<TrajectoryRun>& runs, const std::string* sequence,
                      const std::string& calibration) {
  RunsSummary s;
  s.sequence = sequence != nullptr ? *sequence : "";
  s.calibration = calibration;
  std::vector<double> ate;
  for (const TrajectoryRun& run : runs) {
    if (run.calibration != calibration) continue;
    if (sequence != nullptr && run.sequence != *sequence) continue;
    ++s.expected;
    if (run.status == RunStatus::kPartial) ++s.partial;
    if (run.status == RunStatus::kFailed) ++s.failed;
    if (run.status != RunStatus::kComplete) continue;
    ++s.complete;
    if (!run.without_truth) ate.push_back(run.ate_translation_m.rmse);
  }
  if (s.expected > 0) {
    s.completion = static_cast<double>(s.complete) / static_cast<double>(s.expected);
  }
  if (!ate.empty()) s.ate_complete_median_m = median(ate);
  if (s.partial > 0) s.level = VerdictLevel::kCaution;
  if (s.failed > 0) s.level = VerdictLevel::kBad;
  // Complete runs without truth have no error and are not asked for one; failed and partial ones
  // are, and count as larger than any.
  const std::size_t judged = s.expected - (s.complete - ate.size());
  s.ate_median_m = medianOf(std::move(ate), judged);
  return s;
}

}  // namespace

double signTest(std::size_t successes, std::size_t n) {
  if (n == 0) return 1;
  const boost::math::binomial_distribution<double> coin(static_cast<double>(n), 0.5);
  // Twice the smaller tail; the two overlap where successes are half of n.
  return std::min(1.0, 2 * cdf(coin, static_cast<double>(std::min(successes, n - successes))));
}

std::vector<PairedDifference> pairedDifferences(const std::vector<TrajectoryRun>& runs) {
  const auto names = inOrder(runs, &TrajectoryRun::calibration);
  std::vector<PairedDifference> differences;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t k = i + 1; k < names.size(); ++k) {
      differences.push_back(compare(runs, names[i], names[k]));
    }
  }
  return differences;
}

std::vector<RunsSummary> summarised(const std::vector<TrajectoryRun>& runs) {
  std::vector<RunsSummary> list;
  const auto sequences = inOrder(runs, &TrajectoryRun::sequence);
  const auto calibrations = inOrder(runs, &TrajectoryRun::calibration);
  for (const std::string& sequence : sequences) {
    for (const std::string& name : calibrations) list.push_back(summaryOf(runs, &sequence, name));
  }
  if (sequences.size() < 2) return list;
  for (const std::string& name : calibrations) list.push_back(summaryOf(runs, nullptr, name));
  return list;
}

TrajectoryStudy studyOf(std::vector<TrajectoryRun> runs) {
  TrajectoryStudy study;
  study.summary = summarised(runs);
  study.paired = pairedDifferences(runs);
  study.runs = std::move(runs);
  return study;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/run_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

constexpr std::size_t kLeastSequences = 5;  // for an interval

using Place = std::pair<std::string, std::string>;  // sequence, run

struct Errors {
  double a = std::nan(""), b = std::nan("");
};

/// RMSE of both calibrations at every place that either has; NaN where a run is not complete.
std::map<Place, Errors> errorsOf(const std::vector<TrajectoryRun>& runs, const std::string& a,
                                 const std::string& b) {
  std::map<Place, Errors> errors;
  for (const TrajectoryRun& run : runs) {
    if (run.calibration != a && run.calibration != b) continue;
    Errors& both = errors[{run.sequence, run.run}];
    // A run without truth is complete and has no error.
    const bool complete = run.status == RunStatus::kComplete && run.ate_translation_m.n > 0;
    (run.calibration == a ? both.a : both.b) = complete ? run.ate_translation_m.rmse : std::nan("");
  }
  return errors;
}

/// The least number of sequences that gives an interval and a power of 80 % at 95 % to the test of
/// the mean of their `means`: (t_{0.975, n-1} + t_{0.8, n-1}) s / sqrt(n) <= |mean|.
std::optional<double> sequencesNeeded(const std::vector<double>& means) {
  const SampleStatistics s = sampleStatistics(means, 1);
  // A deviation of two differences is no basis to plan by; no difference needs no number.
  if (s.n < 3 || s.mean == 0) return std::nullopt;
  const auto suffices = [&s](double sequences) {
    const double dof = sequences - 1;
    const double quantiles = studentsQuantile(dof, 0.975) + studentsQuantile(dof, 0.8);
    return quantiles * s.std <= std::abs(s.mean) * std::sqrt(sequences);
  };
  // By normal quantiles, which are smaller, it is two sequences less: from there upwards. Of a
  // million, two more are no matter.
  constexpr double kNormal = 1.959964 + 0.841621, kMany = 1e6;
  const double spread = kNormal * s.std / s.mean;
  double n = std::max(static_cast<double>(kLeastSequences), std::ceil(spread * spread));
  while (n < kMany && !suffices(n)) ++n;
  return n;
}

/// Of differences d [m], b - a, by sequence. Runs of one sequence are alike, so that sequences are
/// the units of mean, interval and sign test. Nothing is set for no pairs.
void summarise(const std::map<std::string, std::vector<double>>& by_sequence,
               PairedDifference& result) {
  std::vector<double> d, means;
  for (const auto& [sequence, values] : by_sequence) {
    append(d, values);
    means.push_back(sampleStatistics(values).mean);
  }
  result.pairs = d.size();
  if (d.empty()) return;
  result.mean_m = sampleStatistics(means).mean;
  result.median_m = median(d);
  result.std_m = sampleStatistics(d).std;
  for (const double value : d) {
    if (value < 0) ++result.b_better;
    if (value == 0) ++result.ties;
  }
  result.pairs_needed = sequencesNeeded(means);
  std::size_t negative = 0, signs = 0;
  for (const double mean : means) {
    if (mean < 0) ++negative;
    if (mean != 0) ++signs;
  }
  result.sign_test_p = signTest(negative, signs);
  if (means.size() < kLeastSequences) return;
  const double half = halfWidth95(standardError(means), static_cast<double>(means.size() - 1));
  result.low_m = result.mean_m - half;
  result.high_m = result.mean_m + half;
  // d = error of b - error of a: below zero b is better.
  if (*result.low_m > 0 || *result.high_m < 0)
    result.better = result.mean_m < 0 ? result.b : result.a;
}

PairedDifference compare(const std::vector<TrajectoryRun>& runs, const std::string& a,
                         const std::string& b) {
  PairedDifference result;
  result.a = a;
  result.b = b;
  std::map<std::string, std::vector<double>> d;
  for (const auto& [place, error] : errorsOf(runs, a, b)) {
    // What one of the two lacks is left out, and counted as left out.
    if (std::isfinite(error.a) && std::isfinite(error.b)) {
      d[place.first].push_back(error.b - error.a);
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
  // Twice the smaller tail; the two overlap where successes are half of n.
  const auto fewer = static_cast<double>(std::min(successes, n - successes));
  return std::min(1.0, 2 * coinShare(static_cast<double>(n), fewer));
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

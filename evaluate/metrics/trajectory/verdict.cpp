// SPDX-License-Identifier: BSD-3-Clause
// What a study of trajectories says: its verdict, and its calibrations compared run by run.
#include "evaluate/metrics/trajectory/verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/trajectory/mismatch.h"

namespace plumbline {
namespace {

using Findings = std::vector<Finding>;

std::string ofCalibration(const std::string& calibration) {
  return calibration.empty() ? "" : " of " + calibration;
}

/// Whose reason is shown: the first that failed, or the first partial one where none did.
const TrajectoryRun* firstIncomplete(const TrajectoryStudy& study, const RunsSummary& s) {
  const auto found =
      std::find_if(study.runs.begin(), study.runs.end(), [&](const TrajectoryRun& r) {
        return r.calibration == s.calibration && r.status != RunStatus::kComplete &&
               (s.failed == 0 || r.status == RunStatus::kFailed);
      });
  return found == study.runs.end() ? nullptr : &*found;
}

/// Both are empty where the pattern of the runs has no such fields.
std::string nameOf(const TrajectoryRun& run) {
  const char* gap = run.sequence.empty() || run.run.empty() ? "" : " ";
  return run.sequence + gap + run.run;
}

/// All runs complete or not, with the reason of one that is not.
Finding completion(const TrajectoryStudy& study, const RunsSummary& s) {
  Finding f{"Complete runs" + ofCalibration(s.calibration),
            s.level,
            fmt::format("{} of {} complete, {} partial, {} failed", s.complete, s.expected,
                        s.partial, s.failed),
            "",
            s.completion,
            1,
            "share"};
  const TrajectoryRun* run = firstIncomplete(study, s);
  if (run != nullptr && !run->problem.empty()) {
    const std::string name = nameOf(*run);
    f.evidence += fmt::format("; {}{}{}", name, name.empty() ? "" : ": ", run->problem);
  }
  return f;
}

/// What was left out because of a file's conventions, once for each calibration.
void addConventions(const TrajectoryStudy& study, Findings& findings) {
  for (const TrajectoryRun& run : study.runs) {
    if (run.cure.empty()) continue;
    Finding f{"Conventions" + ofCalibration(run.calibration), VerdictLevel::kCaution, run.left_out,
              "run again with " + run.cure};
    // Runs of one calibration mostly come from one program, and so in one convention.
    if (!findBy(findings, &Finding::rule, f.rule)) findings.push_back(std::move(f));
  }
}

/// Whether `scale` is `factor` or its inverse, up to what an estimator's own scale is off by.
bool isNear(double scale, double factor) {
  return std::abs(std::abs(std::log(scale)) - std::log(factor)) < 0.1;
}

Finding scaleFinding(const ScaleMismatch& m) {
  const char* unit = isNear(m.scale, 1000) ? "mm" : isNear(m.scale, 100) ? "cm" : nullptr;
  std::string advice;
  if (unit != nullptr) {
    advice = fmt::format("if the file of the {} is in {}, convert it to metres; ",
                         m.scale > 1 ? "truth" : "estimate", unit);
  }
  advice +=
      "for an estimate without a scale of its own (one camera alone) use --align sim3; otherwise "
      "lengths of the estimate or of the truth are wrong";
  return {"Scale",
          VerdictLevel::kCaution,
          fmt::format("lengths of the truth are {:.4g} times those of the estimate: after sim3 the "
                      "RMSE is {:.3g} m, after se3 {:.3g} m",
                      m.scale, m.scaled_ate_m, m.ate_m),
          std::move(advice),
          m.scaled_ate_m / m.ate_m,
          0.5,
          "share"};
}

/// What to do where stamps are off by the positions, by whether angular rates say so, too.
std::string clockAdvice(const ClockMismatch& m) {
  const std::string given = fmt::format("--time-offset {:.4f}", m.given_s + m.positions_s);
  const std::optional<bool> confirmed = ratesConfirm(m);
  if (!confirmed) {
    return fmt::format(
        "if the clocks are off, run again with {} in all; where the motion is mostly "
        "forward, a body that travels ahead of the other does the same",
        given);
  }
  if (!*confirmed) {
    return "the clocks are not off so far: look for a body that travels ahead of the other, with "
           "--hand-eye auto";
  }
  constexpr double kDefaultRange = 0.8;  // with room to the default of --clock-range, 1 s
  return fmt::format("run again with --clock-offset auto{}, and find out whose stamps are wrong",
                     std::abs(*m.rates_s) > kDefaultRange ? " --clock-range 3" : "");
}

Finding clockFinding(const ClockMismatch& m) {
  std::string evidence = fmt::format(
      "with the estimate's stamps moved by {:+.3f} s the RMSE is {:.3g} m, as they are {:.3g} m "
      "(after {})",
      m.positions_s, m.moved_ate_m, m.ate_m, m.alignment);
  if (m.rates_s) evidence += fmt::format("; angular rates ask for {:+.3f} s", *m.rates_s);
  return {"Clocks",       VerdictLevel::kCaution,  std::move(evidence),
          clockAdvice(m), m.moved_ate_m / m.ate_m, 0.5,
          "share"};
}

/// The run of `calibration` to which `what` matters most, and of how many it is one.
template <class Mismatch>
void addMismatch(const TrajectoryStudy& study, const std::string& calibration,
                 std::optional<Mismatch> TrajectoryRun::*what,
                 Finding (*findingOf)(const Mismatch&), Findings& findings) {
  std::size_t with = 0, compared = 0;
  std::optional<Finding> worst;
  std::string name;
  for (const TrajectoryRun& run : study.runs) {
    if (run.calibration != calibration) continue;
    if (run.*what || run.ate_translation_m.n > 0) ++compared;
    if (!(run.*what)) continue;
    ++with;
    Finding finding = findingOf(*(run.*what));
    if (worst && worst->value <= finding.value) continue;
    worst = std::move(finding);
    name = nameOf(run);
  }
  if (!worst) return;
  worst->rule += ofCalibration(calibration);
  if (compared > 1) {
    worst->evidence = fmt::format("{} of {} runs{}{}: {}", with, compared, name.empty() ? "" : "; ",
                                  name, worst->evidence);
  }
  findings.push_back(*std::move(worst));
}

/// Causes that were tried out, before what they do to the runs.
void addMismatches(const TrajectoryStudy& study, Findings& findings) {
  for (const RunsSummary& s : overAll(study)) {
    addMismatch(study, s.calibration, &TrajectoryRun::scale_mismatch, scaleFinding, findings);
    addMismatch(study, s.calibration, &TrajectoryRun::clock_mismatch, clockFinding, findings);
  }
}

/// Rotations that are off by more than an estimator errs. Runs whose file conventions are known to
/// differ have no rotation errors, and are not counted.
void addOrientation(const TrajectoryStudy& study, Findings& findings) {
  constexpr double kMostDeg = 15;
  std::size_t off = 0, known = 0;
  const TrajectoryRun* worst = nullptr;
  for (const TrajectoryRun& run : study.runs) {
    if (run.ate_rotation_deg.n == 0) continue;
    ++known;
    if (!(run.ate_rotation_deg.rmse > kMostDeg)) continue;
    ++off;
    if (!worst || run.ate_rotation_deg.rmse > worst->ate_rotation_deg.rmse) worst = &run;
  }
  if (!worst) return;
  findings.push_back(
      {"Orientation", VerdictLevel::kCaution,
       fmt::format("{} of {} runs have more than {:g} deg RMSE, the worst {:.3g} deg", off, known,
                   kMostDeg, worst->ate_rotation_deg.rmse),
       "look for an axis that is mirrored or exchanged, a clock that is off "
       "(--clock-offset auto), inverted quaternions (--truth-inverted, "
       "--estimate-inverted), worlds that were not aligned (--align se3), or an "
       "estimate that diverged",
       worst->ate_rotation_deg.rmse, kMostDeg, "deg"});
}

/// Of means above their bound alone: covariances that are too large are stated with the figures
/// (NeesReading) and are no finding.
void addCovariances(const TrajectoryStudy& study, Findings& findings) {
  std::size_t judged = 0, small = 0;
  double worst = 0;
  for (const TrajectoryRun& run : study.runs) {
    for (const NeesRecord& nees : run.nees) {
      ++judged;
      if (!(nees.mean > nees.upper)) continue;
      ++small;
      worst = std::max(worst, nees.mean / nees.upper);
    }
  }
  if (judged == 0) return;
  // Never bad: the bound is for independent poses, those of one run err alike for a while, and a
  // mean just above it proves nothing (neesOf()).
  Finding f{"Covariances of the estimates",
            small > 0 ? VerdictLevel::kCaution : VerdictLevel::kGood,
            fmt::format("{} of {} mean NEES above their chi-square bound", small, judged)};
  if (small > 0) {
    f.evidence += fmt::format(", the worst {:.2g} times", worst);
    f.advice = "the covariances are too small for the errors: do not use them as weights";
  }
  findings.push_back(std::move(f));
}

/// "0.054 m RMSE from the truth (se3 alignment, 2310 pairs, 98 % of the truth's time), 1.2 deg".
std::string oneRun(const TrajectoryRun& run) {
  if (run.without_truth) return "there is no ground truth, and so no error";
  if (run.status == RunStatus::kFailed) return "the run failed";
  std::string text = fmt::format(
      "the estimate is {:.3g} m RMSE from the truth ({} alignment, {} pairs, {:.0f} % of the "
      "truth's time)",
      run.ate_translation_m.rmse, run.alignment.kind, run.association.matches, 100 * run.coverage);
  if (run.ate_rotation_deg.n > 0) {
    text += fmt::format(", its orientation {:.3g} deg RMSE", run.ate_rotation_deg.rmse);
  }
  return text;
}

std::string pairedWords(const PairedDifference& d) {
  if (d.pairs == 0) return "";
  const std::string& other = d.better == d.a ? d.b : d.a;
  if (d.better.empty() || !d.low_m || !d.high_m) {
    return fmt::format("; {} and {} were not shown to differ", d.b, d.a);
  }
  const auto [low, high] = std::minmax({std::abs(*d.low_m), std::abs(*d.high_m)});
  return fmt::format("; {} is better than {} by {:.2g} m (95 % interval {:.2g} to {:.2g})",
                     d.better, other, std::abs(d.mean_m), low, high);
}

/// Medians by calibration, then every pair of calibrations. A median over failed runs may be
/// unknown, which is said rather than left out.
std::string manyRuns(const TrajectoryStudy& study) {
  const std::vector<RunsSummary> all = overAll(study);
  const auto complete = [](const RunsSummary& s) { return s.complete > 0; };
  if (!all.empty() && std::none_of(all.begin(), all.end(), complete)) return "no run is complete";
  const bool truth = std::any_of(study.runs.begin(), study.runs.end(),
                                 [](const TrajectoryRun& run) { return !run.without_truth; });
  if (!truth && !study.runs.empty()) return "there is no ground truth, and so no error";
  std::string text;
  for (const RunsSummary& s : all) {
    text += text.empty() ? "median ATE" : ",";
    if (!s.calibration.empty()) text += " of " + s.calibration;
    text += s.ate_median_m    ? fmt::format(" {:.3g} m", *s.ate_median_m)
            : s.complete == 0 ? " unknown (no complete run)"
                              : " unknown (half or more of the runs with a ground truth are not "
                                "complete)";
  }
  for (const PairedDifference& d : study.paired) text += pairedWords(d);
  return text.empty() ? "no run has an error" : text;
}

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

Verdict trajectoryVerdict(const TrajectoryStudy& study) {
  Findings findings;
  addMismatches(study, findings);
  for (const RunsSummary& s : overAll(study)) findings.push_back(completion(study, s));
  addConventions(study, findings);
  addOrientation(study, findings);
  addCovariances(study, findings);
  Verdict verdict = makeVerdict(std::move(findings));
  std::string what = study.runs.size() == 1 ? oneRun(study.runs.front()) : manyRuns(study);
  what[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(what[0])));
  verdict.headline = what + ".";
  if (const std::string worst = worstFinding(verdict); !worst.empty()) {
    verdict.headline += " " + worst;
  }
  return verdict;
}

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

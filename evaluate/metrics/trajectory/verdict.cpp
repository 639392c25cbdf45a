// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "evaluate/metrics/headline.h"

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
    // Both are empty where the pattern of the runs has no such fields.
    const char* gap = run->sequence.empty() || run->run.empty() ? "" : " ";
    const std::string name = run->sequence + gap + run->run;
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
    const bool known = std::any_of(findings.begin(), findings.end(),
                                   [&](const Finding& g) { return g.rule == f.rule; });
    if (!known) findings.push_back(std::move(f));
  }
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
    text += fmt::format(", its orientation {:.2g} deg RMSE", run.ate_rotation_deg.rmse);
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

}  // namespace

Verdict trajectoryVerdict(const TrajectoryStudy& study) {
  Findings findings;
  for (const RunsSummary& s : overAll(study)) findings.push_back(completion(study, s));
  addConventions(study, findings);
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

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// What a study of trajectories says.
#include "evaluate/metrics/trajectory/verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/initialise/clock_offset.h"
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
          kFarBetter,
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
  // Not at the edge of the range that is searched without the option.
  const bool is_far = std::abs(*m.rates_s) > 0.8 * ClockOffsetOptions().max_offset_s;
  return fmt::format("run again with --clock-offset auto{}, and find out whose stamps are wrong",
                     is_far ? fmt::format(" --clock-range {:g}", kRatesRange) : "");
}

Finding clockFinding(const ClockMismatch& m) {
  std::string evidence = fmt::format(
      "with the estimate's stamps moved by {:+.3f} s the RMSE is {:.3g} m, as they are {:.3g} m "
      "(after {})",
      m.positions_s, m.moved_ate_m, m.ate_m, m.alignment);
  if (m.rates_s) evidence += fmt::format("; angular rates ask for {:+.3f} s", *m.rates_s);
  return {"Clocks",       VerdictLevel::kCaution,  std::move(evidence),
          clockAdvice(m), m.moved_ate_m / m.ate_m, kFarBetter,
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
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/summary.h"

#include <cstddef>
#include <functional>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

std::string row(const std::string& name, const SampleStatistics& s) {
  // No row rather than one of zeros: errors of no poses are none.
  if (s.n == 0) return "";
  return fmt::format("{:<28}{:>12.6g}{:>12.6g}{:>12.6g}{:>12.6g}{:>12.6g}{:>12.6g}{:>8}\n", name,
                     s.rmse, s.mean, s.median, s.std, s.min, s.max, s.n);
}

std::string table(const TrajectoryRun& run) {
  std::string text = fmt::format("{:<28}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}\n", "", "rmse",
                                 "mean", "median", "std", "min", "max", "n");
  text += row("ATE translation [m]", run.ate_translation_m);
  text += row("ATE rotation [deg]", run.ate_rotation_deg);
  for (const RelativeErrorRecord& rpe : run.rpe) {
    const std::string over = fmt::format("RPE {:g} {} ", rpe.delta, rpe.unit);
    text += row(over + "translation [m]", rpe.translation_m);
    text += row(over + "rotation [deg]", rpe.rotation_deg);
  }
  return text;
}

std::string pairsLine(const TrajectoryRun& run) {
  const AssociationRecord& r = run.association;
  std::string bound;
  if (r.max_dt_s > 0) bound = fmt::format(", within {:g} s", r.max_dt_s);
  if (r.time_offset_s != 0) bound += fmt::format(", estimate shifted by {:g} s", r.time_offset_s);
  return fmt::format(
      "{} pairs of {} estimated and {} true poses ({}{}; median difference {:+.3f} ms), {:.0f} % "
      "of the truth's time\n",
      r.matches, r.estimate_poses, r.truth_poses, r.rule, bound, 1e3 * r.median_dt_s,
      100 * run.coverage);
}

std::string alignmentLine(const AlignmentRecord& a) {
  const Transform& T = a.T_truth_estimate;
  const std::string first = a.first_n > 0 ? fmt::format(" by the first {} pairs", a.first_n) : "";
  return fmt::format(
      "aligned {}{}: scale {:.6f}, rotated {:.3f} deg, t [{:.4f}, {:.4f}, {:.4f}] m\n", a.kind,
      first, a.scale, rotationAngle(T.R) * kDegrees, T.t.x(), T.t.y(), T.t.z());
}

std::string neesLines(const TrajectoryRun& run) {
  std::string text;
  for (const NeesRecord& r : run.nees) {
    text += fmt::format("NEES {:<12} mean {:.3f} of {} dof, {:.0f} % bounds [{:.3f}, {:.3f}]: {}\n",
                        r.part, r.mean, r.dof, 100 * r.confidence, r.lower, r.upper,
                        toString(r.reading));
  }
  return text;
}

std::string nameOr(const std::string& name, const char* otherwise) {
  return name.empty() ? otherwise : name;
}

std::string summaryTable(const TrajectoryStudy& study) {
  const std::size_t sequence = nameWidth(study.summary, 16, std::mem_fn(&RunsSummary::sequence));
  const std::size_t calibration =
      nameWidth(study.summary, 24, std::mem_fn(&RunsSummary::calibration));
  std::string text =
      fmt::format("{:<{}}{:<{}}{:>10}{:>9}{:>8}{:>18}\n", "sequence", sequence, "calibration",
                  calibration, "complete", "partial", "failed", "median ATE [m]");
  for (const RunsSummary& s : study.summary) {
    const std::string ate = s.ate_median_m ? fmt::format("{:.4f}", *s.ate_median_m) : "-";
    text += fmt::format("{:<{}}{:<{}}{:>10}{:>9}{:>8}{:>18}\n", nameOr(s.sequence, "all"), sequence,
                        nameOr(s.calibration, "-"), calibration,
                        fmt::format("{}/{}", s.complete, s.expected), s.partial, s.failed, ate);
  }
  return text;
}

std::string differenceLines(const TrajectoryStudy& study) {
  std::string text;
  for (const PairedDifference& d : study.paired) {
    if (d.pairs == 0) {
      text += fmt::format("{} - {}: no sequence and run that both completed\n", d.b, d.a);
      continue;
    }
    text += fmt::format(
        "{} - {}: ATE {:+.4f} m (mean over sequences, of {} pairs, median {:+.4f}, std {:.4f}); "
        "lower in {}; {} excluded\n",
        d.b, d.a, d.mean_m, d.pairs, d.median_m, d.std_m, d.b_better, d.left_out);
  }
  return text;
}

std::string problemLines(const TrajectoryStudy& study) {
  std::string text;
  for (const TrajectoryRun& run : study.runs) {
    if (run.status == RunStatus::kComplete) continue;
    text += fmt::format("{}: {} {} run {}: {}\n", toString(run.status), nameOr(run.sequence, "-"),
                        nameOr(run.calibration, "-"), nameOr(run.run, "-"), run.problem);
  }
  return text;
}

std::string rowOf(const TrajectoryRun& run) {
  std::string text =
      fmt::format("{},{},{},{},{:.6f},", csvCell(run.sequence), csvCell(run.calibration),
                  csvCell(run.run), toString(run.status), run.coverage);
  if (run.ate_translation_m.n > 0) {
    text +=
        fmt::format("{},{:.9g},{:.9g},{:.9g},", run.ate_translation_m.n, run.ate_translation_m.rmse,
                    run.ate_translation_m.median, run.ate_translation_m.max);
  } else {
    // Empty, for 0 would be a perfect run.
    text += ",,,,";
  }
  if (run.ate_rotation_deg.n > 0) text += fmt::format("{:.9g}", run.ate_rotation_deg.rmse);
  return text + "," + csvCell(run.problem) + "," + csvCell(run.estimate) + "\n";
}

}  // namespace

std::string trajectorySummary(const TrajectoryRun& run) {
  std::string text =
      table(run) + "\n" + pairsLine(run) + alignmentLine(run.alignment) + neesLines(run);
  for (const std::string& remark : run.remarks) text += "note: " + remark + "\n";
  return text;
}

std::string runsSummary(const TrajectoryStudy& study) {
  const std::string paired = differenceLines(study), problems = problemLines(study);
  std::string text = summaryTable(study);
  if (!paired.empty()) text += "\n" + paired;
  if (!problems.empty()) text += "\n" + problems;
  return text;
}

std::string runsTable(const TrajectoryRecord& record) {
  std::string text =
      "sequence,calibration,run,status,coverage,n,ate_rmse_m,ate_median_m,ate_max_m,"
      "ate_rotation_rmse_deg,problem,estimate\n";
  for (const TrajectoryRun& run : record.runs) text += rowOf(run);
  return text;
}

}  // namespace plumbline

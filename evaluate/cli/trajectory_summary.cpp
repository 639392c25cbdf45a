// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/trajectory_summary.h"

#include <numbers>

#include <fmt/format.h>

namespace plumbline {
namespace {

std::string row(const std::string& name, const SampleStatistics& s) {
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
  if (r.time_offset_s != 0) bound += fmt::format(", estimate moved by {:g} s", r.time_offset_s);
  return fmt::format(
      "{} pairs of {} estimated and {} true poses ({}{}; median difference {:+.3f} ms), {:.0f} % "
      "of "
      "the truth's time\n",
      r.matches, r.estimate_poses, r.truth_poses, r.rule, bound, 1e3 * r.median_dt_s,
      100 * run.coverage);
}

std::string alignmentLine(const AlignmentRecord& a) {
  const Transform& T = a.T_truth_estimate;
  const std::string first = a.first_n > 0 ? fmt::format(" by the first {} pairs", a.first_n) : "";
  return fmt::format(
      "aligned {}{}: scale {:.6f}, rotated {:.3f} deg, t [{:.4f}, {:.4f}, {:.4f}] m\n", a.kind,
      first, a.scale, rotationAngle(T.R) * 180 / std::numbers::pi, T.t.x(), T.t.y(), T.t.z());
}

std::string neesLines(const TrajectoryRun& run) {
  std::string text;
  for (const NeesRecord& r : run.nees) {
    const char* verdict = r.mean > r.upper   ? "overconfident"
                          : r.mean < r.lower ? "cautious"
                                             : "consistent";
    text += fmt::format("NEES {:<12} mean {:.3f} of {} dof, {:.0f} % bounds [{:.3f}, {:.3f}]: {}\n",
                        r.part, r.mean, r.dof, 100 * r.confidence, r.lower, r.upper, verdict);
  }
  return text;
}

}  // namespace

std::string trajectorySummary(const TrajectoryEvaluation& evaluation) {
  const TrajectoryRun& run = evaluation.run;
  std::string text =
      table(run) + "\n" + pairsLine(run) + alignmentLine(run.alignment) + neesLines(run);
  for (const std::string& remark : evaluation.remarks) text += "note: " + remark + "\n";
  return text;
}

}  // namespace plumbline

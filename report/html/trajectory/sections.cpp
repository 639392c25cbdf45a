// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/trajectory/sections.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html/page.h"
#include "report/html/pages.h"

namespace plumbline::html_internal {
namespace {

/// Differences in metres; the reading is the record's, `better` of the interval.
std::vector<Cell> pairedRow(const PairedDifference& d) {
  // The record's difference is b - a, so that below 0 b is the better one.
  const bool interval = d.low_m && d.high_m;
  const auto figure = [&](const std::string& text) { return number(d.pairs > 0 ? text : kDash); };
  return {words(d.b + " \u2212 " + d.a),
          number(d.pairs),
          number(d.left_out),
          figure(fmt::format("{:+.4f}", d.mean_m)),
          figure(interval ? fmt::format("{:+.4f} to {:+.4f}", *d.low_m, *d.high_m) : kDash),
          figure(fmt::format("{:+.4f}", d.median_m)),
          figure(fmt::format("{} of {}", d.b_better, d.pairs)),
          figure(fmt::format("{:.3g}", d.sign_test_p)),
          figure(d.pairs_needed ? grouped(static_cast<std::size_t>(*d.pairs_needed)) : kDash),
          {d.pairs == 0       ? "no pair is complete under both"
           : !interval        ? "too few sequences for an interval (five are needed)"
           : d.better.empty() ? "no difference at 95 %"
                              : d.better + " is better"}};
}

std::vector<Cell> associationRow(const TrajectoryRun& run) {
  const AssociationRecord& a = run.association;
  const auto count = [](std::size_t n) { return number(grouped(n)); };
  return {words(runName(run)),
          words(a.rule),
          count(a.matches),
          number(grouped(a.estimate_poses) + " / " + grouped(a.truth_poses)),
          number("{:g}", 1e3 * a.max_dt_s),
          number("{:+.3f}", 1e3 * a.median_dt_s),
          number("{:g}", 1e3 * a.time_offset_s),
          number(grouped(a.estimate_duplicates) + " / " + grouped(a.truth_duplicates)),
          number("{:.3f} / {:.3f}", a.largest_estimate_gap_s, a.largest_truth_gap_s),
          count(a.stamps_in_gaps),
          {run.alignment.first_n > 0
               ? fmt::format("{}, first {}", run.alignment.kind, run.alignment.first_n)
               : run.alignment.kind},
          number("{:.6g}", run.alignment.scale)};
}

// Deviations by component; of the rotation the angle alone, whose three components say little by
// themselves.
std::vector<Cell> handEyeRow(const TrajectoryRun& run) {
  const HandEyeRecord& h = *run.hand_eye;
  const Eigen::Vector3d t = 1e3 * h.T_SM.t;
  const Vector6d& s = h.T_SM_std;
  const double degrees = readable("rad").factor;
  return {
      words(runName(run)),
      number("({:.2f}, {:.2f}, {:.2f})", t.x(), t.y(), t.z()),
      number("({}, {}, {})", twoDigits(1e3 * s[0]), twoDigits(1e3 * s[1]), twoDigits(1e3 * s[2])),
      number("{:.3f}", degrees * rotationAngle(h.T_SM.R)),
      number("({}, {}, {})", twoDigits(degrees * s[3]), twoDigits(degrees * s[4]),
             twoDigits(degrees * s[5])),
      number("{:.2f}", 1e3 * h.rms_translation_m),
      number("{:.3f}", degrees * h.rms_rotation_rad)};
}

/// Below its lower bound the estimate is too cautious, above the upper one too confident.
std::vector<Cell> neesRow(const TrajectoryRun& run, const NeesRecord& n) {
  const bool consistent = n.reading == NeesReading::kConsistent;
  const char* why = n.reading == NeesReading::kOverconfident ? ": covariances too small"
                    : n.reading == NeesReading::kCautious    ? ": covariances too large"
                                                             : "";
  return {words(runName(run)),
          words(n.part),
          number(n.dof),
          number("{:.3f}", n.mean),
          number("{:.3f} to {:.3f}", n.lower, n.upper),
          number("{:g}", 100 * n.confidence),
          {toString(n.reading) + why, Cell::Kind::kText,
           // Covariances that are too large are a caution as well: either way they mislead whoever
           // weighs by them.
           consistent ? VerdictLevel::kGood : VerdictLevel::kCaution}};
}

}  // namespace

std::vector<std::string> calibrationsOf(const std::vector<TrajectoryRun>& runs) {
  return distinct(runs, [](const TrajectoryRun& run) { return run.calibration; });
}

std::string runName(const TrajectoryRun& run) {
  std::string name;
  for (const std::string& part : {run.sequence, run.calibration, run.run}) {
    if (!part.empty()) name += (name.empty() ? "" : " \u00b7 ") + part;
  }
  return name.empty() ? run.estimate : name;
}

Section pairedSection(const std::vector<PairedDifference>& differences) {
  Section section{
      "paired", "Paired differences",
      "ATE RMSE under one calibration minus that under the other, for the same sequence and run; "
      "negative means that the first one is better. Runs of one sequence are alike: mean, interval "
      "(Student\u2019s t) and the exact two-sided sign test (p) are of the sequences\u2019 means. "
      "The median is over pairs. Pairs that are not complete under both are excluded and counted. "
      "A single run cannot rank small errors: its error depends on chance as much as on the "
      "calibration. With \u201csequences needed\u201d, a pair each, such a mean difference would "
      "be significant at 95 % in four of five studies, given the spread of the sequences\u2019 "
      "means; fewer than three give no spread, fewer than five no interval."};
  Table table{{words("Difference"), number("Pairs"), number("Left out"), number("Mean [m]"),
               number("95 % interval [m]"), number("Median [m]"), number("Better"),
               number("p (sign test)"), number("Sequences needed"), words("Reading")}};
  for (const PairedDifference& d : differences) table.rows.push_back(pairedRow(d));
  return withTable(std::move(section), std::move(table));
}

Section clockSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"clock-offset", "Clock offset",
                  "t_truth = t_estimate + offset, from correlating the angular rates of both."};
  Table table{{words("Run"), number("Offset [ms]"), number("Std [ms]"), number("Correlation")}};
  for (const TrajectoryRun& run : runs) {
    if (!run.clock_offset) continue;
    const ClockOffsetRecord& c = *run.clock_offset;
    table.rows.push_back({words(runName(run)),
                          number(withPrecisionOf(1e3 * c.offset_s, 1e3 * c.std_s)),
                          number(twoDigits(1e3 * c.std_s)), number("{:.4f}", c.correlation)});
  }
  return withTable(std::move(section), std::move(table));
}

Section handEyeSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"hand-eye", "Hand-eye",
                  "T_SM maps points of the marker body M into the IMU frame S, estimated from the "
                  "trajectories themselves, with the residuals after it."};
  Table table{{words("Run"), number("t_SM [mm]"), number("Std [mm]"), number("Angle [\u00b0]"),
               number("Std [\u00b0]"), number("RMS residual [mm]"),
               number("RMS residual [\u00b0]")}};
  Block matrices;
  for (const TrajectoryRun& run : runs) {
    if (!run.hand_eye) continue;
    table.rows.push_back(handEyeRow(run));
    matrices.matrices.push_back(
        {"T_SM, " + runName(run), run.hand_eye->T_SM, "p_S = T_SM p_M [m]"});
  }
  if (table.rows.empty()) return section;
  section.blocks = {{"", "", std::move(table)}, std::move(matrices)};
  return section;
}

Section neesSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"nees", "Consistency (NEES)",
                  "Mean normalised estimation error squared against its two-sided chi-square "
                  "bounds: are the estimate's covariances consistent with its errors?"};
  Table table{{words("Run"), words("Part"), number("Dof"), number("Mean"), number("Bounds"),
               number("Confidence [%]"), words("Reading")}};
  for (const TrajectoryRun& run : runs) {
    for (const NeesRecord& n : run.nees) table.rows.push_back(neesRow(run, n));
  }
  return withTable(std::move(section), std::move(table));
}

Section associationSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"association", "Pairing and alignment",
                  "How the stamps of estimate and truth were paired, and their anomalies. A median "
                  "difference far from zero indicates a clock offset."};
  Table table{{words("Run"), words("Rule"), number("Pairs"), number("Poses, estimate / truth"),
               number("Max \u0394t [ms]"), number("Median \u0394t [ms]"),
               number("Offset added [ms]"), number("Duplicates"), number("Largest gap [s]"),
               number("In gaps"), words("Alignment"), number("Scale")}};
  for (const TrajectoryRun& run : runs) {
    // A run that failed before its stamps were paired.
    if (run.association.estimate_poses + run.association.matches == 0) continue;
    table.rows.push_back(associationRow(run));
  }
  return withTable(std::move(section), std::move(table));
}

Table withoutEmptyColumns(Table table) {
  // From the last: what is taken out moves those after it.
  for (std::size_t c = table.columns.size(); c-- > 0;) {
    const bool empty = std::ranges::all_of(
        table.rows, [&](const auto& row) { return row[c].text == kDash || row[c].text.empty(); });
    if (empty && !table.rows.empty()) eraseColumns(table, static_cast<std::ptrdiff_t>(c));
  }
  return table;
}

std::vector<Section> trajectorySections(const TrajectoryStudy& study) {
  const std::vector<TrajectoryRun>& runs = study.runs;
  return {runsSection(study),          errorSection(runs),
          pairedSection(study.paired), sensitivitySection(study.sensitivity),
          overlaySection(runs),        timeSection(runs),
          relativeSection(runs),       selfSection(runs),
          clockSection(runs),          handEyeSection(runs),
          neesSection(runs),           associationSection(runs)};
}

}  // namespace plumbline::html_internal

namespace plumbline {

using namespace html_internal;

std::string renderTrajectoryPage(const TrajectoryRecord& record) {
  // A verdict that was made has a headline.
  std::optional<Verdict> verdict;
  if (!record.verdict.headline.empty()) verdict = record.verdict;
  Page page{"Trajectories against ground truth",
            record.name,
            record.provenance,
            verdict,
            trajectoryCards(record),
            trajectorySections(record),
            std::nullopt};
  page.good_word = kCompleteWord;
  return renderPage(page);
}

}  // namespace plumbline

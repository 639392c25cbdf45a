// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/replay/sections.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/transform.h"

namespace plumbline::html_internal {
namespace {

std::string secondsText(const ReplayRecord& record, TimeNs t) {
  return fmt::format("{:.2f}", secondsBetween(beginOf(record), t));
}

std::string secondsText(const ReplayRecord& record, const std::optional<TimeNs>& t) {
  return t ? secondsText(record, *t) : kDash;
}

std::string titleOf(GuideStage stage) {
  return stage == GuideStage::kCamera ? "cameras" : "camera-IMU";
}

/// Seconds of a stage's stop, or of its end without one.
std::string endText(const ReplayRecord& record, std::optional<TimeNs> finished,
                    std::optional<TimeNs> ended) {
  return ended ? "ended " + secondsText(record, ended) : secondsText(record, finished);
}

/// Times count from beginOf().
std::vector<Cell> stageRow(const ReplayRecord& record, const ReplayStageSummary& s) {
  std::vector<Cell> row = {tight(titleOf(s.stage))};
  const auto count = [&row](bool known, int n) {
    row.push_back(number(known ? grouped(static_cast<std::size_t>(n)) : kDash));
  };
  // Of a stage that did not run there are no counts, rather than zeros.
  for (const int n : {s.frames_offered, s.frames_dropped, s.views_used}) count(s.ran, n);
  // Hindsight is that of the camera stage's batch over the views kept.
  const bool in_hindsight = s.stage == GuideStage::kCamera && s.kept_batch;
  for (const int n : {s.views_redundant, s.views_missed}) count(in_hindsight, n);
  for (const int n : {s.suggestions, s.reached}) count(s.ran, n);
  row.push_back(number(secondsText(record, s.started)));
  row.push_back(number(endText(record, s.finished, s.ended)));
  row.push_back(number(s.finished ? bitsAndNats(s.information_after_finish_nats) : kDash));
  return row;
}

Table stageTable(const ReplayRecord& record) {
  // Hindsight is of gains, whatever the guide went by.
  const std::string by = record.rule.by_error ? " by mutual information" : "";
  Table table{{words("Stage"), number("Offered"), number("Dropped"), number("Used"),
               number("Redundant" + by), number("Missed" + by), number("Suggested"),
               number("Reached"), number("Started [s]"), number("Finish [s]"),
               number("Gained after it")}};
  for (const ReplayStageSummary& s : record.stages) table.rows.push_back(stageRow(record, s));
  return table;
}

/// Entropy in both units: the guide's threshold is in bits, documents have nats.
std::vector<Cell> batchRow(const ReplayStageSummary& s, const char* over,
                           const StageSummary& batch) {
  return {tight(titleOf(s.stage)),
          tight(over),
          number(grouped(static_cast<std::size_t>(batch.views_used))),
          number(grouped(batch.corners_used)),
          number("{:.4f}", batch.reprojection.rmse_px),
          number("{:.3f}", batch.entropy_nats),
          number("{:.3f}", batch.entropy_nats / std::numbers::ln2),
          tight(batch.converged ? "yes" : "no")};
}

Table batchTable(const ReplayRecord& record) {
  Table table{{words("Stage"), words("Batch over"), number("Views, all cameras"), number("Corners"),
               number("RMSE [px]"), number("Entropy [nats]"), number("Entropy [bits]"),
               words("Converged")}};
  for (const ReplayStageSummary& s : record.stages) {
    if (s.kept_batch) table.rows.push_back(batchRow(s, "views kept", *s.kept_batch));
    if (s.full_batch) table.rows.push_back(batchRow(s, "all frames", *s.full_batch));
  }
  return table;
}

std::string endText(const SuggestionOutcome& o) {
  return o.end == SuggestionEvent::kNone ? "still open" : toString(o.end);
}

// Only a suggestion that nobody reached in its time is bad; one that the recording's end cut off
// might have been.
std::optional<VerdictLevel> levelOf(SuggestionEvent end) {
  if (end == SuggestionEvent::kReached) return VerdictLevel::kGood;
  if (end == SuggestionEvent::kWithdrawn) return std::nullopt;  // nothing was missed
  return end == SuggestionEvent::kExpired ? VerdictLevel::kBad : VerdictLevel::kCaution;
}

// Of the suggestions' table.
constexpr int kGainColumn = 3, kOpenColumn = 5;

std::string bitsText(double nats) {
  return std::isinf(nats) ? "unbounded" : fmt::format("{:.3f}", nats / std::numbers::ln2);
}

std::vector<Cell> outcomeRow(const ReplayRecord& record, const SuggestionOutcome& o) {
  // 0: the record does not know its end.
  const bool ended = o.ended >= o.suggestion.t && o.ended != 0;
  return {number(o.suggestion.id),
          tight(titleOf(o.suggestion.stage)),
          words(o.suggestion.candidate),
          // A gain of 0 is one that could not be predicted yet (Suggestion::mi_nats).
          // In bits alone: thirteen columns have no room for both.
          number(o.suggestion.mi_nats != 0 ? bitsText(o.suggestion.mi_nats) : kDash),
          number(secondsText(record, o.suggestion.t)),
          number(ended ? fmt::format("{:.1f}", secondsBetween(o.suggestion.t, o.ended)) : kDash),
          {endText(o), Cell::Kind::kTight, levelOf(o.end)},
          orDash(o.suggestion.reach_s, 1, "{:.1f}"),
          orDash(o.reached_s, 1, "{:.1f}"),
          orDash(o.closest_px, 1, "{:.1f}"),
          orDash(o.mean_px, 1, "{:.1f}"),
          orDash(o.closest_m, 1e3, "{:.0f}"),
          orDash(o.closest_rad, kDegrees, "{:.1f}")};
}

bool haveErrors(const std::vector<SuggestionOutcome>& outcomes) {
  return std::ranges::any_of(
      outcomes, [](const SuggestionOutcome& o) { return o.suggestion.error_px.has_value(); });
}

void insertErrors(Table& table, int column, const std::vector<SuggestionOutcome>& outcomes) {
  table.columns.insert(table.columns.begin() + column, number("Predicted error [px]"));
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    std::vector<Cell>& row = table.rows[i];
    row.insert(row.begin() + column, orDash(outcomes[i].suggestion.error_px, 1, "{:.3f}"));
  }
}

Table outcomeTable(const ReplayRecord& record, const std::vector<SuggestionOutcome>& outcomes) {
  Table table{{number("#"), words("Stage"), words("Suggestion"), number("Predicted gain [bits]"),
               number("Shown [s]"), number("Open [s]"), words("End"), number("Predicted time [s]"),
               number("Reached after [s]"), number("Closest [px]"), number("Mean [px]"),
               number("Position [mm]"), number("Rotation [\u00b0]")}};
  for (const SuggestionOutcome& o : outcomes) table.rows.push_back(outcomeRow(record, o));
  // Suggestions of another guide, read from a file, have none.
  if (haveErrors(outcomes)) {
    // Thirteen columns fit: how long it was open follows from its end, nearly always.
    eraseColumns(table, kOpenColumn);
    // First that by which they were chosen.
    insertErrors(table, record.rule.by_error ? kGainColumn : kGainColumn + 1, outcomes);
  }
  return table;
}

Cell verdictCell(StopAudit::Verdict verdict) {
  // In the order of the verdicts. What was not judged has no colour: where that matters, the page's
  // verdict says so.
  static constexpr std::pair<const char*, std::optional<VerdictLevel>> kCells[] = {
      {"never stopped", VerdictLevel::kCaution},
      {"too early", VerdictLevel::kBad},
      {"late", VerdictLevel::kCaution},
      {"right", VerdictLevel::kGood},
      {"not judged", std::nullopt}};
  const auto& [text, level] = kCells[static_cast<std::size_t>(verdict)];
  return {text, Cell::Kind::kTight, level};
}

/// Measured is what a stage had when it stopped, with the deviation of what it is held against.
Cell measuredCell(const StopAudit& a) {
  if (a.predicted_px && !a.measured_px && !a.finished) return tight("no stop");
  if (!a.measured_px || !a.reference_std_px) return orDash(a.measured_px, 1, "{:.3f}");
  return number(fmt::format("{:.3f} \u00b1 {:.3f}", *a.measured_px, *a.reference_std_px));
}

/// An entropy of 0 is one that is not known.
std::vector<Cell> auditRow(const ReplayRecord& record, const StopAudit& a) {
  return {
      tight(titleOf(a.stage)),
      verdictCell(a.verdict),
      number(endText(record, a.finished, a.ended)),
      number(secondsText(record, a.enough)),
      number(a.seconds != 0 ? fmt::format("{:.2f}", a.seconds) : kDash),
      number(a.finished ? fmt::format("{:.2f}", a.saved_s) : kDash),
      orDash(a.predicted_excess, 100, "{:.1f}"),
      orDash(a.held_out_excess, 100, "{:.1f}"),
      orDash(a.measured_excess, 100, "{:.1f}"),
      orDash(a.predicted_px, 1, "{:.3f}"),
      measuredCell(a),
      number(a.finished && a.entropy_at_finish_nats != 0
                 ? fmt::format("{:.1f}", a.entropy_at_finish_nats)
                 : kDash),
      number(a.entropy_of_all_nats != 0 ? fmt::format("{:.1f}", a.entropy_of_all_nats) : kDash)};
}

}  // namespace

Section replayStagesSection(const ReplayRecord& record) {
  Section section{
      "stages", "Stages",
      "Used: in the estimate. Redundant: used, but in hindsight below the threshold of mutual "
      "information; missed: not used, but in hindsight above it. Started: with the first estimate "
      "of the stage. Times count "
      "from the first frame, of which a wrong stamp does not count. Gained after \"finish\": "
      "information that the rest of the recording would "
      "have added."};
  if (!record.target.shape.isFlat()) {
    section.remarks.push_back("The board's shape is known and used, so it causes no misfit.");
  }
  for (const ReplayStageSummary& s : record.stages) {
    if (!s.problem.empty()) section.remarks.push_back(titleOf(s.stage) + ": " + s.problem);
  }
  section = withTable(std::move(section), stageTable(record));
  return withTable(std::move(section), batchTable(record),
                   "Batch over the views kept, and over all");
}

Section replaySuggestionsSection(const ReplayRecord& record) {
  return withTable({"suggestions", "Suggestions",
                    "What the guide suggested, and how close the recording came to it while the "
                    "suggestion was open: mean distance of the corners, and the distance of the "
                    "camera at the closest frame. In an unguided recording nobody followed the "
                    "suggestions. Withdrawn: the stage finished or restarted while it was open."},
                   outcomeTable(record, record.suggestions));
}

Section stopAuditSection(const ReplayRecord& record) {
  Section section{
      "stop-audit", "Stopping rule",
      "The guide's \"finish\" compared with the first instant at which the frames kept were "
      "sufficient: the error to be expected of their calibration, its distance from that of all "
      "frames together with the standard deviation of the latter, is within the bars named below. "
      "Off by: the time that was missing, or wasted (never stopped: at least). Saved: the part of "
      "the recording after it. Excess: relative increase of the error with the views kept over "
      "that with all frames: as predicted by the guide for later use, likewise predicted with the "
      "held-out frames as later use, and measured on these frames, where poses absorb most of an "
      "error of the cameras. Distance: camera stage: of the worst camera's projections, RMS over "
      "the image; camera-IMU stage: of points that the IMU predicts; as expected by the guide, and "
      "measured from the calibration of all frames \u00b1 its deviation. Ended: without a stop, so "
      "that the other stage is replayed."};
  Table table{{words("Stage"), words("Judgement"), number("Finish [s]"), number("Sufficient [s]"),
               number("Off by [s]"), number("Saved [s]"), number("Excess, by the guide [%]"),
               number("Held out, predicted [%]"), number("Measured [%]"),
               number("Distance, expected [px]"), number("Measured [px]"),
               number("Entropy then [nats]"), number("Of all frames [nats]")}};
  for (const StopAudit& a : record.stop_audits) {
    table.rows.push_back(auditRow(record, a));
    if (!a.explanation.empty()) section.remarks.push_back(titleOf(a.stage) + ": " + a.explanation);
  }
  return withTable(std::move(section), std::move(table));
}

Section complianceSection(const ReplayRecord& record) {
  Section section{"compliance", "Operator compliance",
                  "What the guide showed to the operator during the recording, and how close and "
                  "how fast the operator came."};
  if (!record.compliance) return section;
  const OperatorCompliance& c = *record.compliance;
  if (c.suggestions.empty()) {
    section.remarks.emplace_back("No suggestion was shown.");
    return section;
  }
  const std::size_t open = c.suggestions.size() - static_cast<std::size_t>(endedSuggestions(c));
  section.remarks.push_back(
      fmt::format("{} of {} suggestions were reached{}{}.", c.reached, endedSuggestions(c),
                  c.median_seconds_to_reach
                      ? fmt::format(", after {:.1f} s in the median", *c.median_seconds_to_reach)
                      : "",
                  open > 0 ? fmt::format("; {} open at the end", open) : ""));
  return withTable(std::move(section), outcomeTable(record, c.suggestions));
}

}  // namespace plumbline::html_internal

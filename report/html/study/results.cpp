// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/study/sections.h"

namespace plumbline::html_internal {
namespace {

/// Factors as changes in percent, differences in their unit. Below a percent with two digits, so
/// that the end of an interval that excludes no change is not shown as none.
std::string changeText(double value, bool ratio) {
  if (!ratio) return fmt::format("{:+.3g}", value);
  const double percent = 100 * (value - 1);
  const bool small = std::abs(percent) < 0.95 && std::abs(percent) > 1e-9;  // less is rounding
  return small ? fmt::format("{:+.2g} %", percent) : fmt::format("{:+.1f} %", percent);
}

Cell changeCell(const std::optional<StudyInterval>& i, bool ratio) {
  return number(i ? changeText(i->estimate, ratio) : kDash);
}

Cell intervalCell(const std::optional<StudyInterval>& i, bool ratio) {
  // Unbounded at one end: nothing that a reader could take for an interval.
  if (!i || !i->low || !i->high) return number(kDash);
  return number(changeText(*i->low, ratio) + " to " + changeText(*i->high, ratio));
}

Cell pCell(const std::optional<double>& p) {
  if (!p) return number(kDash);
  return number(*p < 1e-3 ? "< 0.001" : fmt::format("{:.3f}", *p));
}

/// The endpoint with its unit, which a change in percent does not have.
std::string comparison(const StudyEffect& e) {
  return e.endpoint + (e.ratio || e.unit == "1" ? "" : " [" + e.unit + "]");
}

Table effectsTable(const StudyRecord& record) {
  Table table{{code("Endpoint"), words("Method"), number("Effect"), number("95 % interval"),
               number("p"), number("p (Holm)"), number("Participants"), words("Design")}};
  for (const StudyEffect& e : record.statistics.effects) {
    if (e.design == StudyDesign::kTooFew) continue;
    table.rows.push_back({code(comparison(e)), words(e.method), changeCell(e.effect, e.ratio),
                          intervalCell(e.effect, e.ratio), pCell(e.p), pCell(e.p_holm),
                          number(e.participants),
                          tight(toString(e.design) + (e.declared ? "" : ", exploratory"))});
  }
  return table;
}

/// The effects of effectsTable() once more, by other methods.
Table besideTable(const StudyRecord& record) {
  Table table{{code("Endpoint"), words("Method"), number("BCa interval"),
               number("Hodges\u2013Lehmann"), number("95 % interval"), number("Wilcoxon p")}};
  for (const StudyEffect& e : record.statistics.effects) {
    if (e.design == StudyDesign::kTooFew) continue;
    table.rows.push_back({code(comparison(e)), words(e.method), intervalCell(e.bca, e.ratio),
                          changeCell(e.hodges_lehmann, e.ratio),
                          intervalCell(e.hodges_lehmann, e.ratio), pCell(e.wilcoxon_p)});
  }
  return table;
}

Table methodsTable(const StudyRecord& record) {
  Table table{{words("Method"), number("Sessions"), number("Calibrated"), number("Gave up"),
               number("Good"), number("Caution"), number("Bad"), number("Median time [s]"),
               number("Median held-out RMSE [px]"), number("Suggestions reached")}};
  const auto& methods = record.statistics.methods;
  for (const StudyMethod& m : methods) {
    table.rows.push_back(
        {words(m.method), number(m.sessions), number(m.calibrated), number(m.gave_up),
         number(m.good), number(m.caution), number(m.bad), orDash(m.median_capture_s, 1, "{:.1f}"),
         orDash(m.median_held_out_px, 1, "{:.4f}"), orDash(m.compliance, 100, "{:.0f} %")});
  }
  const bool guided =
      std::ranges::any_of(methods, [](const StudyMethod& m) { return m.compliance.has_value(); });
  if (!guided) eraseColumns(table, 9);
  return table;
}

/// A deviation or an error [ms]; below a nanosecond its digits are those of the arithmetic.
std::string smallMilliseconds(double ms) {
  return std::abs(ms) < 1e-6 ? "< 1e-6" : fmt::format("{:.2g}", ms);
}

/// Offsets that calibrations found under one injected shift; those without one are counted.
struct Recovered {
  std::vector<double> ms;
  int failed = 0;
};

}  // namespace

Section resultsSection(const StudyRecord& record) {
  Section section{"results", "Results",
                  "The participant is the unit; the first method is the baseline."};
  section.remarks = record.statistics.sentences;
  // The sentences may hold it already.
  for (const StudyQuade& q : record.statistics.quade) {
    const auto& said = section.remarks;
    if (std::ranges::find(said, q.sentence) == said.end()) {
      section.remarks.push_back(q.sentence);
    }
  }
  section.blocks.push_back({"Methods", "", methodsTable(record)});
  section = withTable(
      std::move(section), effectsTable(record), "Effects",
      "Method against baseline: lengths, times and pixels as changes in percent (of logarithms), "
      "others as differences. In a crossover the effect of the period is removed, the p-value "
      "permutes the orders over the participants, and the interval contains the effects that this "
      "test does not reject. Holm's correction is over the declared endpoints.");
  return withTable(
      std::move(section), besideTable(record), "Further intervals and tests",
      "The same effects by the BCa bootstrap, and by signed ranks, which ignore the period.");
}

Section orderSection(const StudyRecord& record) {
  Table table{{code("Endpoint"), words("Method"), number("Baseline first"), number("Method first"),
               number("Second session"), number("95 % interval"), number("Carry-over"),
               number("95 % interval")}};
  for (const StudyEffect& e : record.statistics.effects) {
    if (!e.period) continue;
    table.rows.push_back({code(comparison(e)), words(e.method), number(e.first_baseline),
                          number(e.first_method), changeCell(e.period, e.ratio),
                          intervalCell(e.period, e.ratio), changeCell(e.carry_over, e.ratio),
                          intervalCell(e.carry_over, e.ratio)});
  }
  return withTable(
      {"order", "Order effects",
       "Difference of the second session with the effect of the method removed (practice, "
       "fatigue), and the difference between the two orders' sums, which shows a lasting effect of "
       "the first session. An estimate only: no decision depends on it."},
      std::move(table));
}

Section perturbationSection(const StudyRecord& record) {
  // By injected offset, then method.
  std::map<std::pair<double, std::string>, Recovered> groups;
  for (const StudyPerturbation& p : record.perturbations) {
    const StudySession* s = sessionOf(record, p.session);
    Recovered& group = groups[{p.offset_ms, s ? s->method : ""}];
    if (p.recovered_ms && std::isfinite(*p.recovered_ms)) {
      group.ms.push_back(*p.recovered_ms);
    } else {
      ++group.failed;
    }
  }
  Table table{{number("Injected [ms]"), words("Method"), number("Sessions"), number("Failed"),
               number("Recovered [ms]"), number("Std [ms]"), number("Largest error [ms]")}};
  for (const auto& [key, group] : groups) {
    const SampleStatistics all = sampleStatistics(group.ms, 1);
    double worst = 0;
    // `recovered_ms` is net of the offset found without a shift: it should equal what was injected.
    for (const double ms : group.ms) worst = std::max(worst, std::abs(ms - key.first));
    const bool any = !group.ms.empty();
    table.rows.push_back({number("{:g}", key.first), words(key.second),
                          number(group.ms.size() + static_cast<std::size_t>(group.failed)),
                          number(group.failed),
                          number(any ? fmt::format("{:.4f}", all.mean) : kDash),
                          number(group.ms.size() > 1 ? smallMilliseconds(all.std) : kDash),
                          number(any ? smallMilliseconds(worst) : kDash)});
  }
  return withTable(
      {"perturbations", "Perturbed time offsets",
       "Every IMU stamp is shifted by a known offset and the calibration runs again from its own "
       "initial guess; recovered: the offset found minus the one found without the shift."},
      std::move(table));
}

}  // namespace plumbline::html_internal

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "report/html/page.h"
#include "report/records/shown_findings.h"

namespace plumbline::html_internal {
namespace {

/// How value and threshold of a finding are shown: both in the unit that people read.
struct ShownUnit {
  double factor = 1;
  std::string name;
};

/// By the larger of value and bound, either of which may be 0.
ShownUnit shownUnit(const Finding& f) {
  const double larger = std::max(std::abs(f.threshold), std::abs(f.value));
  if (f.unit == "m" && larger < 1) return {1e3, " mm"};
  // Stops of the guide are judged in seconds, recovered offsets by microseconds.
  if (f.unit == "s" && larger > 0 && larger < 1e-3) return {1e6, " \u00b5s"};
  if (f.unit == "s" && larger > 0 && larger < 1) return {1e3, " ms"};
  // "1": a count; "x": a factor; "-" of an earlier store: any of the three.
  if (f.unit == "share") return {100, " %"};
  const bool plain = f.unit == "1" || f.unit == "x" || f.unit == "-";
  return {1, plain ? "" : " " + f.unit};
}

/// On which side of the threshold the rule is met, as the value stands: "\u2264 " or "\u2265 ".
const char* senseOf(const Finding& f) {
  if (f.unit.empty() || !std::isfinite(f.value) || !std::isfinite(f.threshold)) return "";
  const bool met = f.level == VerdictLevel::kGood;
  return met == (f.value > f.threshold) ? "\u2265\u00a0" : "\u2264\u00a0";
}

data findingRow(const Finding& f) {
  // A rule without a unit compares nothing with a threshold (convergence).
  const ShownUnit unit = shownUnit(f);
  const auto shown = [&](double value) -> std::string {
    if (f.unit.empty() || (isNotJudged(f) && std::isnan(value))) return "\u2013";
    const double number = unit.factor * value;
    // Three digits, but no count of views as "1.42e+03".
    const bool whole = std::abs(number) >= 999.5 && std::abs(number) < 1e7;
    return typeset(fmt::format(fmt::runtime(whole ? "{:.0f}{}" : "{:.3g}{}"), number, unit.name));
  };
  return object({{"rule", f.rule},
                 {"level", isNotJudged(f) ? "not judged" : toString(f.level)},
                 {"dot", isNotJudged(f) ? "neutral" : toString(f.level)},
                 {"evidence", typeset(shownEvidence(f))},
                 {"advice", typeset(f.advice)},
                 {"value", shown(f.value)},
                 {"threshold", senseOf(f) + shown(f.threshold)},
                 {"first", false},
                 {"reason", false},
                 {"again", ""}});
}

/// A row for each finding; level and cure stand once for all that share them, and why rules were
/// not judged for all of one reason.
data findingRows(const std::vector<Finding>& findings) {
  data rows{data::type::list};
  for (const std::vector<Finding>& same : shownFindings(findings)) {
    for (std::size_t i = 0; i < same.size(); ++i) {
      data row = findingRow(same[i]);
      const data span = object({{"span", std::to_string(same.size())}});
      if (i == 0) row.set("first", span);
      if (i == 0 && isNotJudged(same[i])) row.set("reason", span);
      if (i > 0 && isNotJudged(same[i])) row.set("again", " again");
      rows.push_back(row);
    }
  }
  return rows;
}

/// A chip for every subject, with the worst level of the findings about it; none where no finding
/// has a subject.
data subjectChips(const std::vector<Finding>& findings) {
  data chips{data::type::list};
  if (std::ranges::count(findings, FindingSubject::kResult, &Finding::subject) ==
      std::ssize(findings)) {
    return chips;
  }
  // What is about the result as a whole is the badge's: where that decides, the chips would
  // contradict it.
  const auto worstOf = [&](bool of_result) {
    VerdictLevel worst = VerdictLevel::kGood;
    for (const Finding& f : findings) {
      if (!of_result && f.subject == FindingSubject::kResult) continue;
      worst = std::max(worst, f.level);
    }
    return worst;
  };
  if (worstOf(true) > worstOf(false)) return chips;
  for (const FindingSubject subject : {FindingSubject::kCameras, FindingSubject::kExtrinsics,
                                       FindingSubject::kImuNoise, FindingSubject::kRecording}) {
    // A subject of which no rule could be judged is not good.
    std::optional<VerdictLevel> worst;
    for (const Finding& f : findings) {
      if (f.subject == subject && !isNotJudged(f))
        worst = std::max(worst.value_or(f.level), f.level);
    }
    chips.push_back(object({{"level", worst ? toString(*worst) : "not judged"},
                            {"dot", worst ? toString(*worst) : "neutral"},
                            {"subject", toString(subject)}}));
  }
  return chips;
}

// A record without a headline says how many rules hold.
std::string sentenceOf(const Verdict& verdict) {
  if (!verdict.headline.empty()) return verdict.headline;
  const auto beyond = std::ssize(verdict.findings) -
                      std::ranges::count(verdict.findings, VerdictLevel::kGood, &Finding::level);
  const auto open = std::ranges::count_if(verdict.findings, isNotJudged);
  if (beyond == 0 && open > 0) {
    return fmt::format("{} of {} rules are met; {} could not be judged.",
                       std::ssize(verdict.findings) - open, verdict.findings.size(), open);
  }
  if (beyond == 0) return fmt::format("All {} rules are met.", verdict.findings.size());
  return fmt::format(
      "{} of {} rules {}; the evidence is below.", beyond, verdict.findings.size(),
      verdict.level == VerdictLevel::kBad ? "are violated or need attention" : "need attention");
}

}  // namespace

std::string typeset(const std::string& text) {
  constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"+-", "\u00b1"},
      {"^2", "\u00b2"},
      {"^3", "\u00b3"},
      // A unit stays on its number's line.
      {" deg", "\u00a0\u00b0"},
      {" us", "\u00a0\u00b5s"},
      {" sigma", "\u00a0\u03c3"}};
  const auto is = [&](std::size_t at, int (*kind)(int)) {
    return at < text.size() && kind(static_cast<unsigned char>(text[at])) != 0;
  };
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto* sign = std::ranges::find_if(kSigns, [&](const auto& s) {
      if (text.compare(at, s.first.size(), s.first) != 0) return false;
      // Units stand behind a number and are whole words.
      return s.first[0] != ' ' ||
             (at > 0 && is(at - 1, std::isdigit) && !is(at + s.first.size(), std::isalpha));
    });
    const bool found = sign != std::end(kSigns);
    out += found ? sign->second : std::string_view(text).substr(at, 1);
    at += found ? sign->first.size() : 1;
  }
  return out;
}

void setVerdict(data& page, const Verdict& verdict, const std::string& good_word) {
  const bool good = verdict.level == VerdictLevel::kGood;
  const std::string word = good ? good_word : toString(verdict.level);
  // A word of its own ("complete") praises nothing, so it is not green.
  page.set("verdict", good && word != "good" ? "neutral" : toString(verdict.level));
  page.set("verdict_word", std::string(1, static_cast<char>(word[0] - 'a' + 'A')) + word.substr(1));
  page.set("verdict_sentence", typeset(sentenceOf(verdict)));
  std::vector<Finding> concerns, holds;
  for (const Finding& finding : verdict.findings) {
    const bool met = finding.level == VerdictLevel::kGood && !isNotJudged(finding);
    (met ? holds : concerns).push_back(finding);
  }
  setList(page, "concerns", findingRows(concerns));
  page.set("subjects", subjectChips(verdict.findings));
  page.set("holds_summary",
           verdict.findings.size() == 1
               ? fmt::format("{} of 1 rule is met", holds.size())
               : fmt::format("{} of {} rules are met", holds.size(), verdict.findings.size()));
  setList(page, "holds", findingRows(holds));
}

}  // namespace plumbline::html_internal

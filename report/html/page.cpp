// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "generated/report/embedded.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

/// The text, or false where it is empty, so that a section of the template is left out.
data textOrNothing(const std::string& text) { return text.empty() ? data{false} : data{text}; }

/// A list, and as "has_NAME" whether it has anything: the markup around it asks for that.
void setList(data& values, const std::string& name, const data& list) {
  values.set("has_" + name, list.is_non_empty_list());
  values.set(name, list);
}

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

/// Findings are written for terminals; a page has the signs: "0.2 deg (+- 0.1)" is "0.2 \u00b0
/// (\u00b1 0.1)".
std::string typeset(const std::string& text) {
  constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"+-", "\u00b1"},    {"^2", "\u00b2"},    {"^3", "\u00b3"},
      {" deg", " \u00b0"}, {" us", " \u00b5s"}, {" sigma", " \u03c3"}};
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

data findingRow(const Finding& f) {
  // A rule without a unit compares nothing with a threshold (convergence).
  const ShownUnit unit = shownUnit(f);
  const auto shown = [&](double value) -> std::string {
    if (f.unit.empty()) return "\u2013";
    const double number = unit.factor * value;
    // Three digits, but no count of views as "1.42e+03".
    const bool whole = std::abs(number) >= 999.5 && std::abs(number) < 1e7;
    return typeset(fmt::format(fmt::runtime(whole ? "{:.0f}{}" : "{:.3g}{}"), number, unit.name));
  };
  return object({{"rule", f.rule},
                 {"level", toString(f.level)},
                 {"evidence", typeset(f.evidence)},
                 {"advice", typeset(f.advice)},
                 {"value", shown(f.value)},
                 {"threshold", shown(f.threshold)},
                 {"first", false}});
}

/// A row for each finding; level and cure stand once for all that share them.
data findingRows(const std::vector<Finding>& findings) {
  data rows{data::type::list};
  for (const std::vector<Finding>& same : findingsByCure(findings)) {
    for (std::size_t i = 0; i < same.size(); ++i) {
      data row = findingRow(same[i]);
      if (i == 0) row.set("first", object({{"span", std::to_string(same.size())}}));
      rows.push_back(row);
    }
  }
  return rows;
}

/// A chip for every subject, with the worst level of the findings about it; none where no finding
/// has a subject.
data subjectChips(const std::vector<Finding>& findings) {
  data chips{data::type::list};
  if (std::ranges::all_of(findings,
                          [](const Finding& f) { return f.subject == FindingSubject::kResult; })) {
    return chips;
  }
  // What is about the result as a whole is the badge's.
  for (const FindingSubject subject : {FindingSubject::kCameras, FindingSubject::kExtrinsics,
                                       FindingSubject::kImuNoise, FindingSubject::kRecording}) {
    // A subject without a finding was not judged, which is not good.
    std::optional<VerdictLevel> worst;
    for (const Finding& f : findings) {
      if (f.subject == subject) worst = std::max(worst.value_or(f.level), f.level);
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
  const auto beyond = std::ranges::count_if(
      verdict.findings, [](const Finding& f) { return f.level != VerdictLevel::kGood; });
  if (beyond == 0) return fmt::format("All {} rules are met.", verdict.findings.size());
  return fmt::format(
      "{} of {} rules {}; the evidence is below.", beyond, verdict.findings.size(),
      verdict.level == VerdictLevel::kBad ? "are violated or need attention" : "need attention");
}

/// Badge (of a good verdict with the page's word), sentence, findings that are not good, and those
/// that are.
void setVerdict(data& page, const Verdict& verdict, const std::string& good_word) {
  const bool good = verdict.level == VerdictLevel::kGood;
  const std::string word = good ? good_word : toString(verdict.level);
  // A word of its own ("complete") praises nothing, so it is not green.
  page.set("verdict", good && word != "good" ? "neutral" : toString(verdict.level));
  page.set("verdict_word", std::string(1, static_cast<char>(word[0] - 'a' + 'A')) + word.substr(1));
  page.set("verdict_sentence", typeset(sentenceOf(verdict)));
  std::vector<Finding> concerns, holds;
  for (const Finding& finding : verdict.findings) {
    (finding.level == VerdictLevel::kGood ? holds : concerns).push_back(finding);
  }
  setList(page, "concerns", findingRows(concerns));
  page.set("subjects", subjectChips(verdict.findings));
  page.set("holds_summary",
           fmt::format("{} of {} rules are met", holds.size(), verdict.findings.size()));
  setList(page, "holds", findingRows(holds));
}

const char* classOf(Cell::Kind kind) {
  static constexpr const char* kClasses[] = {"", "number", "code", "tight"};
  return kClasses[static_cast<std::size_t>(kind)];
}

data cellData(const Cell& cell) {
  return object({{"class", classOf(cell.kind) + std::string(cell.best ? " best" : "")},
                 {"content", cell.text},
                 {"level", cell.level ? data{toString(*cell.level)} : data{false}},
                 {"link", textOrNothing(cell.link)}});
}

void setTable(data& block, const std::optional<Table>& table) {
  block.set("has_table", table.has_value());
  if (!table) return;
  block.set("columns", listOf(table->columns, [](const Cell& c) {
              return object({{"name", c.text}, {"class", classOf(c.kind)}});
            }));
  block.set("rows", listOf(table->rows, [](const std::vector<Cell>& cells) {
              return object({{"cells", listOf(cells, cellData)}});
            }));
}

/// Rows of `cells` with the 4 x 4 matrix, its heading and its note.
data matrixData(const NamedTransform& m) {
  const Eigen::Matrix4d M = m.T.matrix();
  data rows{data::type::list};
  for (int i = 0; i < 4; ++i) {
    data cells{data::type::list};
    for (int j = 0; j < 4; ++j) cells.push_back(fmt::format("{:.8f}", M(i, j)));
    rows.push_back(object({{"cells", cells}}));
  }
  return object({{"heading", m.name}, {"note", m.note}, {"rows", rows}});
}

data figureData(const Figure& figure) {
  return object({{"svg", figure.svg}, {"caption", figure.caption}, {"wide", figure.wide}});
}

data blockData(const Block& block) {
  data values = object({{"heading", textOrNothing(block.heading)},
                        {"text", textOrNothing(block.text)},
                        {"html", textOrNothing(block.html)}});
  setTable(values, block.table);
  setList(values, "matrices", listOf(block.matrices, matrixData));
  setList(values, "figures", listOf(block.figures, figureData));
  return values;
}

data sectionData(const Section& section) {
  data values = object({{"id", section.id},
                        {"title", section.title},
                        {"lead", textOrNothing(section.lead)},
                        {"blocks", listOf(section.blocks, blockData)}});
  setList(values, "remarks",
          listOf(section.remarks, [](const std::string& r) { return data{typeset(r)}; }));
  return values;
}

data cardData(const Card& c) {
  return object({{"label", c.label},
                 {"value", c.value},
                 {"unit", c.unit},
                 {"note", c.note},
                 {"wide", c.wide}});
}

// Without rules and without a headline nothing was judged, and nothing is good.
bool isJudged(const Page& study) {
  return study.verdict && !(study.verdict->findings.empty() && study.verdict->headline.empty());
}

/// Where they stand: a page's figures take megabytes.
using SectionList = std::vector<std::reference_wrapper<const Section>>;

/// Entries of the table of contents.
data contentsOf(const Page& study, const SectionList& sections) {
  data entries{data::type::list};
  const auto add = [&](const std::string& id, const std::string& title) {
    entries.push_back(object({{"id", id}, {"title", title}}));
  };
  if (study.player) add(study.player->id, study.player->title);
  add("verdict", isJudged(study) ? "Verdict" : "Summary");
  if (!study.cards.empty()) add("key-figures", "Key figures");
  for (const Section& section : sections) add(section.id, section.title);
  add("provenance", "Provenance");
  return entries;
}

/// Provenance, assumptions, and what the page has besides.
data provenanceData(const Page& study) {
  std::vector<Pair> rows = provenanceRows(study.provenance);
  const auto append = [&](const std::vector<Pair>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  if (study.assumptions) append(assumptionRows(*study.assumptions));
  append(study.more_rows);
  return listOf(rows, [](const Pair& p) {
    return object({{"label", p.label}, {"value", p.value}});
  });
}

/// What rounds to zero from below prints as "-0.00", which reads as if the sign meant something.
/// Programs and data in script elements stay as they are.
std::string withoutNegativeZerosInText(const std::string& page) {
  std::string out;
  std::size_t from = 0;
  while (from < page.size()) {
    const std::size_t script = std::min(page.find("<script", from), page.size());
    out += withoutNegativeZeros(std::string_view(page).substr(from, script - from));
    from = std::min(page.find("</script>", script), page.size());
    out += page.substr(script, from - script);
  }
  return out;
}

}  // namespace

data object(std::initializer_list<std::pair<std::string, data>> fields) {
  data result{data::type::object};
  for (const auto& [name, value] : fields) result.set(name, value);
  return result;
}

std::string renderTemplate(const std::string& text, data& page) {
  using kainjow::mustache::partial;
  const std::pair<const char*, const std::string& (*)()> parts[] = {
      {"page_head", &embedded::page_head},         {"page_verdict", &embedded::page_verdict},
      {"page_block", &embedded::page_block},       {"page_cards", &embedded::page_cards},
      {"page_figures", &embedded::page_figures},   {"page_matrices", &embedded::page_matrices},
      {"page_sections", &embedded::page_sections}, {"page_provenance", &embedded::page_provenance},
      {"page_foot", &embedded::page_foot}};
  // The library looks for partials among the values of the page.
  for (const auto& [name, part] : parts) {
    page.set(name, data{partial{[text_of = part] { return text_of(); }}});
  }
  kainjow::mustache::mustache pattern{text};
  return pattern.render(page);
}

std::string renderPage(const Page& study) {
  // Those that have something, before the table of contents is made of them.
  SectionList sections;
  std::ranges::copy_if(study.sections, std::back_inserter(sections),
                       [](const Section& s) { return !s.blocks.empty(); });
  const Provenance& p = study.provenance;
  const std::string& viewer = study.player ? study.player->script : study.script;
  data page = object(
      {{"kicker", study.kicker},
       {"name", study.name},
       {"input", p.input},
       {"date", p.date},
       {"version", p.version},
       {"css", embedded::page_css() + (study.player ? study.player->css : "")},
       {"hover", plotScripts()},
       {"script", embedded::page_js()},
       {"player", study.player ? data{study.player->html} : data{false}},
       {"viewer", textOrNothing(viewer)},
       {"toc", contentsOf(study, sections)},
       {"sections", listOf(sections, sectionData)},
       {"provenance", provenanceData(study)},
       {"appendix", listOf(study.appendix, blockData)},
       {"footer", "Made by Plumbline " + p.version + " from its records alone." + study.notice}});
  setList(page, "cards", listOf(study.cards, cardData));
  if (isJudged(study)) {
    setVerdict(page, *study.verdict, study.good_word);
  } else {
    // A page that judges nothing says neither that something holds nor that something does not.
    for (const char* part : {"verdict", "has_concerns", "has_holds"}) page.set(part, false);
  }
  return withoutNegativeZerosInText(renderTemplate(embedded::page(), page));
}

}  // namespace plumbline::html_internal

// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>
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

void setList(data& values, const std::string& name, const data& list) {
  values.set("has_" + name, list.is_non_empty_list());
  values.set(name, list);
}

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
       {"input", textOrNothing(p.input)},
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

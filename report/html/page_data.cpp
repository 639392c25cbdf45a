// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "generated/report/embedded.h"
#include "report/html/page.h"
#include "report/plots/svg.h"

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

data findingRow(const Finding& f) {
  // A rule without a unit compares nothing with a threshold (convergence).
  const ShownUnit unit = shownUnit(f);
  const auto shown = [&](double value) {
    return f.unit.empty() ? "\u2013" : fmt::format("{:.3g}{}", unit.factor * value, unit.name);
  };
  const std::string threshold = shown(f.threshold);
  data row = object({{"rule", f.rule},
                     {"level", toString(f.level)},
                     {"evidence", f.evidence},
                     {"advice", f.advice},
                     {"value", shown(f.value)},
                     {"threshold", threshold}});
  row.set("first", flag(false));
  return row;
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
  if (std::all_of(findings.begin(), findings.end(),
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

const char* classOf(Cell::Kind kind) {
  switch (kind) {
    case Cell::Kind::kNumber:
      return "number";
    case Cell::Kind::kCode:
      return "code";
    case Cell::Kind::kTight:
      return "tight";
    case Cell::Kind::kText:
      break;
  }
  return "";
}

data cellData(const Cell& cell) {
  data d = object({{"class", classOf(cell.kind) + std::string(cell.best ? " best" : "")},
                   {"content", cell.text}});
  d.set("level", cell.level ? data{toString(*cell.level)} : flag(false));
  d.set("link", textOrNothing(cell.link));
  return d;
}

void setTable(data& block, const std::optional<Table>& table) {
  block.set("has_table", flag(table.has_value()));
  if (!table) return;
  block.set("columns", listOf(table->columns, [](const Cell& c) {
              return object({{"name", c.text}, {"class", classOf(c.kind)}});
            }));
  block.set("rows", listOf(table->rows, [](const std::vector<Cell>& cells) {
              data row{data::type::object};
              row.set("cells", listOf(cells, cellData));
              return row;
            }));
}

data blockData(const Block& block) {
  data b{data::type::object};
  b.set("heading", textOrNothing(block.heading));
  b.set("text", textOrNothing(block.text));
  setTable(b, block.table);
  b.set("has_matrices", flag(!block.matrices.empty()));
  b.set("matrices", listOf(block.matrices, [](const NamedTransform& m) {
          return matrixData(m.name, m.T, m.note);
        }));
  b.set("html", textOrNothing(block.html));
  b.set("has_figures", flag(!block.figures.empty()));
  b.set("figures", figuresData(block.figures));
  return b;
}

}  // namespace

data object(std::initializer_list<std::pair<std::string, std::string>> fields) {
  data result{data::type::object};
  for (const auto& [name, value] : fields) result.set(name, value);
  return result;
}

data flag(bool value) { return data{value ? data::type::bool_true : data::type::bool_false}; }

data textOrNothing(const std::string& text) { return text.empty() ? flag(false) : data{text}; }

data figuresData(const std::vector<Figure>& figures) {
  return listOf(figures, [](const Figure& figure) {
    data f = object({{"svg", figure.svg}, {"caption", figure.caption}});
    f.set("wide", flag(figure.wide));
    return f;
  });
}

data blocksData(const std::vector<Block>& blocks) { return listOf(blocks, blockData); }

data sectionsData(const std::vector<Section>& sections) {
  return listOf(sections, [](const Section& section) {
    data s = object({{"id", section.id}, {"title", section.title}});
    s.set("lead", textOrNothing(section.lead));
    s.set("has_remarks", flag(!section.remarks.empty()));
    s.set("remarks", listOf(section.remarks, [](const std::string& r) { return data{r}; }));
    s.set("blocks", blocksData(section.blocks));
    return s;
  });
}

data cardsData(const std::vector<Card>& cards) {
  return listOf(cards, [](const Card& c) {
    data d = object({{"label", c.label}, {"value", c.value}, {"unit", c.unit}, {"note", c.note}});
    d.set("wide", flag(c.wide));
    return d;
  });
}

data pairsData(const std::vector<Pair>& pairs) {
  return listOf(pairs, [](const Pair& p) {
    return object({{"label", p.label}, {"value", p.value}});
  });
}

data matrixData(const std::string& heading, const Transform& T, const std::string& note) {
  data result = object({{"heading", heading}, {"note", note}});
  const Eigen::Matrix4d M = T.matrix();
  data rows{data::type::list};
  for (int i = 0; i < 4; ++i) {
    data cells{data::type::list};
    for (int j = 0; j < 4; ++j) cells.push_back(data{fmt::format("{:.8f}", M(i, j))});
    data row{data::type::object};
    row.set("cells", cells);
    rows.push_back(row);
  }
  result.set("rows", rows);
  return result;
}

data startPage(const PageHead& head) {
  const Provenance& p = head.provenance;
  data page = object({{"kicker", head.kicker},
                      {"name", head.name},
                      {"input", p.input},
                      {"date", p.date},
                      {"version", p.version},
                      {"css", embedded::page_css()},
                      {"hover", plotScripts()},
                      {"script", embedded::page_js()}});
  page.set("viewer", flag(false));
  return page;
}

void setVerdict(data& page, const Verdict& verdict, const std::string& sentence,
                const std::string& good_word) {
  const bool good = verdict.level == VerdictLevel::kGood;
  const std::string word = good ? good_word : toString(verdict.level);
  // A word of its own ("complete") praises nothing, so it is not green.
  page.set("verdict", good && word != "good" ? "neutral" : toString(verdict.level));
  page.set("verdict_word", std::string(1, static_cast<char>(word[0] - 'a' + 'A')) + word.substr(1));
  page.set("verdict_sentence", sentence);
  std::vector<Finding> concerns;
  std::vector<Finding> holds;
  for (const Finding& finding : verdict.findings) {
    (finding.level == VerdictLevel::kGood ? holds : concerns).push_back(finding);
  }
  page.set("has_concerns", flag(!concerns.empty()));
  page.set("concerns", findingRows(concerns));
  page.set("subjects", subjectChips(verdict.findings));
  page.set("has_holds", flag(!holds.empty()));
  page.set("holds_summary",
           fmt::format("{} of {} rules are met", holds.size(), verdict.findings.size()));
  page.set("holds", findingRows(holds));
}

void setContents(data& page, const std::vector<Pair>& entries) {
  page.set("toc", listOf(entries, [](const Pair& p) {
             return object({{"id", p.label}, {"title", p.value}});
           }));
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

}  // namespace plumbline::html_internal

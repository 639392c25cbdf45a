// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/study_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "generated/report/embedded.h"
#include "report/html/page_data.h"

namespace plumbline::html_internal {
namespace {

std::string sentenceOf(const Verdict& verdict) {
  const auto beyond =
      std::count_if(verdict.findings.begin(), verdict.findings.end(),
                    [](const Finding& f) { return f.level != VerdictLevel::kGood; });
  if (beyond == 0) return fmt::format("All {} rules hold.", verdict.findings.size());
  return fmt::format("{} of {} rules {}; the evidence stands below.", beyond,
                     verdict.findings.size(),
                     verdict.level == VerdictLevel::kBad ? "are violated or deserve attention"
                                                         : "deserve attention");
}

std::vector<Pair> contentsOf(const StudyPage& study, const std::vector<Section>& sections) {
  std::vector<Pair> entries;
  if (study.player) entries.push_back({study.player->id, study.player->title});
  entries.push_back({"verdict", study.verdict ? "Verdict" : "Summary"});
  if (!study.cards.empty()) entries.push_back({"key-figures", "Key figures"});
  for (const Section& section : sections) entries.push_back({section.id, section.title});
  entries.push_back({"provenance", "Provenance"});
  return entries;
}

void setPlayer(data& page, const std::optional<PagePlayer>& player) {
  page.set("player", player ? data{player->html} : flag(false));
  if (!player) return;
  page.set("css", embedded::page_css() + player->css);
  page.set("viewer", player->script);
}

}  // namespace

std::string renderStudyPage(const StudyPage& study) {
  std::vector<Section> sections = study.sections;
  std::erase_if(sections, [](const Section& s) { return s.blocks.empty(); });
  data page = startPage({study.kicker, study.name, study.provenance});
  setPlayer(page, study.player);
  if (study.verdict) {
    setVerdict(page, *study.verdict, sentenceOf(*study.verdict));
  } else {
    for (const char* part : {"verdict", "has_concerns", "has_holds"}) page.set(part, flag(false));
  }
  setContents(page, contentsOf(study, sections));
  page.set("has_cards", flag(!study.cards.empty()));
  page.set("cards", cardsData(study.cards));
  page.set("sections", sectionsData(sections));
  std::vector<Pair> rows = provenanceRows(study.provenance);
  if (study.assumptions) {
    const auto more = assumptionRows(*study.assumptions);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  page.set("provenance", pairsData(rows));
  page.set("footer", "Made by Plumbline " + study.provenance.version + " from its records alone.");
  return renderTemplate(embedded::study_page(), page);
}

}  // namespace plumbline::html_internal

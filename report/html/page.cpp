// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "generated/report/embedded.h"

namespace plumbline::html_internal {
namespace {

// A record without a headline says how many rules hold.
std::string sentenceOf(const Verdict& verdict) {
  if (!verdict.headline.empty()) return verdict.headline;
  const auto beyond =
      std::count_if(verdict.findings.begin(), verdict.findings.end(),
                    [](const Finding& f) { return f.level != VerdictLevel::kGood; });
  if (beyond == 0) return fmt::format("All {} rules are met.", verdict.findings.size());
  return fmt::format(
      "{} of {} rules {}; the evidence is below.", beyond, verdict.findings.size(),
      verdict.level == VerdictLevel::kBad ? "are violated or need attention" : "need attention");
}

// Without rules and without a sentence nothing was judged, and nothing is good.
bool isJudged(const Page& study) {
  return study.verdict && !(study.verdict->findings.empty() && study.verdict->headline.empty() &&
                            study.sentence.empty());
}

std::vector<Pair> contentsOf(const Page& study, const std::vector<Section>& sections) {
  std::vector<Pair> entries;
  if (study.player) entries.push_back({study.player->id, study.player->title});
  entries.push_back({"verdict", isJudged(study) ? "Verdict" : "Summary"});
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

namespace {

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

std::string renderPage(const Page& study) {
  std::vector<Section> sections = study.sections;
  // Before the table of contents is made of them.
  std::erase_if(sections, [](const Section& s) { return s.blocks.empty(); });
  data page = startPage({study.kicker, study.name, study.provenance});
  if (!study.script.empty()) page.set("viewer", study.script);
  setPlayer(page, study.player);
  if (isJudged(study)) {
    setVerdict(page, *study.verdict,
               study.sentence.empty() ? sentenceOf(*study.verdict) : study.sentence,
               study.good_word);
  } else {
    // A page that judges nothing says neither that something holds nor that something does not.
    for (const char* part : {"verdict", "has_concerns", "has_holds"}) page.set(part, flag(false));
  }
  setContents(page, contentsOf(study, sections));
  page.set("has_cards", flag(!study.cards.empty()));
  page.set("cards", cardsData(study.cards));
  page.set("sections", sectionsData(sections));
  std::vector<Pair> rows = provenanceRows(study.provenance);
  const auto append = [&](const std::vector<Pair>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  if (study.assumptions) append(assumptionRows(*study.assumptions));
  append(study.more_rows);
  page.set("provenance", pairsData(rows));
  page.set("appendix", blocksData(study.appendix));
  page.set("footer", "Made by Plumbline " + study.provenance.version + " from its records alone." +
                         study.notice);
  return withoutNegativeZerosInText(renderTemplate(embedded::page(), page));
}

}  // namespace plumbline::html_internal

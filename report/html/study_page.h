// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/html/page_parts.h"
#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// What a page may have above its verdict: a part that its own script brings to life.
struct PagePlayer {
  std::string id, title;  ///< entry of the table of contents
  std::string html, css, script;
};

/// What the pages of studies are made of, from the verdict down to the provenance.
struct StudyPage {
  std::string kicker;  ///< kind of the page, "Perturbation study"
  std::string name;
  const Provenance& provenance;
  std::optional<Verdict> verdict;          ///< empty: the page judges nothing
  std::vector<Card> cards;                 ///< "Key figures"
  std::vector<Section> sections;           ///< those without blocks are left out
  std::optional<Assumptions> assumptions;  ///< stand with the provenance
  std::optional<PagePlayer> player = {};
};

/// The page as one self-contained HTML file.
std::string renderStudyPage(const StudyPage& study);

}  // namespace plumbline::html_internal

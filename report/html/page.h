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

/// What every page is made of, from the verdict down to the provenance.
struct Page {
  std::string kicker;  ///< kind of the page, "Perturbation study"
  std::string name;
  const Provenance& provenance;
  std::optional<Verdict> verdict;          ///< empty: the page judges nothing
  std::vector<Card> cards;                 ///< "Key figures"
  std::vector<Section> sections;           ///< those without blocks are left out
  std::optional<Assumptions> assumptions;  ///< stand with the provenance
  std::optional<PagePlayer> player = {};
  std::string sentence = {};         ///< under the verdict; empty: how many rules hold
  std::string good_word = "good";    ///< what the badge says where all rules hold
  std::vector<Pair> more_rows = {};  ///< of the provenance, after the assumptions
  std::vector<Block> appendix = {};  ///< after the provenance
  std::string script = {};           ///< of a part of a section, e.g. the 3D viewer
  std::string notice = {};           ///< what the footer says of that script
};

/// The page as one self-contained HTML file.
std::string renderPage(const Page& page);

}  // namespace plumbline::html_internal

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <kainjow/mustache.hpp>

#include "report/html/page_parts.h"
#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

// Values for the templates; what all pages have in common.

using kainjow::mustache::data;

/// A list, one element per item.
template <class Items, class Make>
data listOf(const Items& items, const Make& make) {
  data list{data::type::list};
  for (const auto& item : items) list.push_back(make(item));
  return list;
}

data object(std::initializer_list<std::pair<std::string, std::string>> fields);
data flag(bool value);
/// The text, or false where it is empty, so that a section of the template is left out.
data textOrNothing(const std::string& text);

data figuresData(const std::vector<Figure>& figures);
data cardsData(const std::vector<Card>& cards);
data pairsData(const std::vector<Pair>& pairs);
data blocksData(const std::vector<Block>& blocks);
data sectionsData(const std::vector<Section>& sections);
/// Rows of `cells` with the 4 x 4 matrix, its heading and its note.
data matrixData(const std::string& heading, const Transform& T, const std::string& note);

/// What stands above the verdict.
struct PageHead {
  std::string kicker;  ///< kind of the page, "Calibration report"
  std::string name;
  const Provenance& provenance;
};

/// Head, style and scripts; an empty table of contents.
data startPage(const PageHead& head);
/// Badge (of a good verdict with this word), sentence, findings that are not good, and those that
/// are.
void setVerdict(data& page, const Verdict& verdict, const std::string& sentence,
                const std::string& good_word);
/// Entries of the table of contents: id and title.
void setContents(data& page, const std::vector<Pair>& entries);

/// The page of a template, which may name the partials of report/html/templates/page_*.mustache.
std::string renderTemplate(const std::string& text, data& page);

}  // namespace plumbline::html_internal

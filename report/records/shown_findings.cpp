// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/shown_findings.h"

#include <algorithm>

namespace plumbline {

std::string shownEvidence(const Finding& f) {
  const bool said = isNotJudged(f) && f.evidence.starts_with(kNotJudgedWords);
  return said ? f.evidence.substr(kNotJudgedWords.size()) : f.evidence;
}

std::vector<std::vector<Finding>> shownFindings(const std::vector<Finding>& findings) {
  std::vector<std::vector<Finding>> rows;
  for (const std::vector<Finding>& row : findingsByCure(findings)) {
    const Finding& f = row.front();
    const auto same = std::ranges::find_if(rows, [&](const std::vector<Finding>& other) {
      return isNotJudged(f) && isNotJudged(other.front()) && other.front().evidence == f.evidence;
    });
    if (same == rows.end()) {
      rows.push_back(row);
    } else {
      same->insert(same->end(), row.begin(), row.end());
    }
  }
  return rows;
}

}  // namespace plumbline

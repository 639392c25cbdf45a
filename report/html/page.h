// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kainjow/mustache.hpp>

#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// A number at the top of the page; a wide one has room for a long note.
struct Card {
  std::string label, value, unit, note;
  bool wide = false;
};
std::vector<Card> keyFigures(const CalibrationRecord& record);

/// "cam0: fu, fv [px], k1 [-]; T_C0C1: tx [m]": the parameters of a covariance by owner, a unit
/// after the last of its run.
std::string parameterList(const ParameterCovariance& covariance);
/// Heading of a parameter by its prefix; what is no camera's is the IMU's.
std::string groupOf(const std::string& parameter);

/// The time offset as each tool writes it: `number` is what stands in its field, `value` the same
/// in a unit that people read.
struct OffsetRow {
  std::string tool, field, number, value, note;
};
std::vector<OffsetRow> offsetRows(double time_offset_s, std::optional<double> std_s);

/// Where cameras have time offsets of their own: that camera 0's is shown, and by how much the
/// stamps of the others must be moved for a tool that has one for all. "" where there is one.
std::string unlikeOffsetsText(const std::vector<CameraCalibration>& cameras,
                              const ImuCalibration& imu);

/// T_SC0 where there is an IMU, and every T_C0Ci.
std::vector<NamedTransform> transformsOf(const std::vector<CameraCalibration>& cameras,
                                         const ImuCalibration* imu);

struct Pair {
  std::string label, value;
};
/// Target, what was detected, and the file that was scored.
std::vector<Pair> calibrationRows(const CalibrationRecord& record);
/// Version, command, input, date, options; rows without a value are left out.
std::vector<Pair> provenanceRows(const Provenance& provenance);
/// Corner noise, loss, and with an IMU gravity and noise densities.
std::vector<Pair> assumptionRows(const Assumptions& assumptions);

// Values for the templates.

using kainjow::mustache::data;

/// A list, one element per item.
data listOf(const auto& items, const auto& make) {
  data list{data::type::list};
  for (const auto& item : items) list.push_back(make(item));
  return list;
}

/// An object of texts, true or false, and lists.
data object(std::initializer_list<std::pair<std::string, data>> fields);

/// A list, and as "has_NAME" whether it has anything: the markup around it asks for that.
void setList(data& values, const std::string& name, const data& list);

/// Findings are written for terminals; a page has the signs: "0.2 deg (+- 0.1)" is "0.2 \u00b0
/// (\u00b1 0.1)".
std::string typeset(const std::string& text);

/// Badge (of a good verdict with the page's word), sentence, findings that are not good, and those
/// that are.
void setVerdict(data& page, const Verdict& verdict, const std::string& good_word);

/// The page of a template, which may name the partials of report/html/templates/page_*.mustache.
std::string renderTemplate(const std::string& text, data& page);

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
  std::string good_word = "good";    ///< what the badge says where all rules hold
  std::vector<Pair> more_rows = {};  ///< of the provenance, after the assumptions
  std::vector<Block> appendix = {};  ///< after the provenance
  std::string script = {};           ///< of a part of a section, e.g. the 3D viewer
  std::string notice = {};           ///< what the footer says of that script
};

/// The page as one self-contained HTML file.
std::string renderPage(const Page& page);

}  // namespace plumbline::html_internal

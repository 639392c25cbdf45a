// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/compare/findings.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/results/text.h"
#include "report/plots/characters.h"

namespace plumbline {
namespace {

constexpr int kName = 18;
constexpr int kColumn = 26;

/// A label that fits a column; its end says most.
std::string fitted(const std::string& label) {
  constexpr std::size_t most = kColumn - 2;
  if (internal::characterCount(label) <= most) return label;
  return "..." + std::string(internal::lastCharacters(label, most - 3));
}

std::string valueText(const ComparedParameter& p, std::size_t i) {
  if (!p.values[i]) return "-";
  const double scale = shownUnit(p.unit).factor;
  std::string text = fmt::format("{:.6g}", scale * *p.values[i]);
  if (p.std[i]) text += fmt::format(" +- {:.2g}", scale * *p.std[i]);
  return text;
}

std::string differenceText(const ComparedParameter& p, std::size_t i) {
  if (!p.difference[i]) return "-";
  const double difference = shownUnit(p.unit).factor * *p.difference[i];
  std::string text = fmt::format(fmt::runtime(p.hasSign() ? "{:+.4g}" : "{:.4g}"), difference);
  if (p.significance[i]) text += fmt::format(" ({:.1f} sigma)", *p.significance[i]);
  return text;
}

void addParameters(Text& text, const ComparisonRecord& record) {
  add(text, "{:<{}}", "", kName);
  for (const ComparedCalibration& c : record.calibrations) {
    add(text, "{:>{}}", fitted(c.label), kColumn);
  }
  for (std::size_t i = 1; i < record.calibrations.size(); ++i) {
    add(text, "{:>{}}",
        fitted("difference " +
               (record.calibrations.size() > 2 ? std::to_string(i) : std::string())),
        kColumn);
  }
  add(text, "\n");
  for (const ComparedParameter& p : record.parameters) {
    const std::string unit = shownUnit(p.unit).unit;
    add(text, "{:<{}}", p.name + (unit.empty() ? "" : " [" + unit + "]"), kName);
    for (std::size_t i = 0; i < p.values.size(); ++i) add(text, "{:>{}}", valueText(p, i), kColumn);
    for (std::size_t i = 1; i < p.values.size(); ++i) {
      add(text, "{:>{}}", differenceText(p, i), kColumn);
    }
    add(text, "\n");
  }
}

/// Which cameras are compared with which, where that is not plain and no fault: a verdict's text
/// has no good findings.
void addCameras(Text& text, const ComparisonRecord& record) {
  for (const Finding& f : record.verdict.findings) {
    if (f.level != VerdictLevel::kGood || !f.rule.starts_with("Cameras of ")) continue;
    add(text, "{}: {}\n", f.rule, f.evidence);
  }
}

void addScores(Text& text, const ComparisonRecord& record) {
  if (record.scores.empty()) return;
  add(text, "\nOn {} (only poses are estimated):\n", record.name);
  for (const CalibrationScore& s : record.scores) {
    add(text, "  {:<24} ", fitted(s.label));
    if (s.per_camera.empty()) {
      add(text, "{}\n", s.problem);
      continue;
    }
    add(text, "{}RMSE {:.4f} px", s.held_out ? "held out, " : "", s.reprojection.rmse_px);
    for (std::size_t c = 0; c < s.per_camera.size(); ++c) {
      add(text, ", {} {:.4f}", c < s.cameras.size() ? s.cameras[c] : fmt::format("cam{}", c),
          s.per_camera[c].rmse_px);
    }
    if (s.camera_imu) add(text, "; with IMU {:.4f} px", s.camera_imu->rmse_px);
    if (s.entropy_nats) add(text, "; entropy {:.3f} nats", *s.entropy_nats);
    if (s.camera_imu_entropy_nats) {
      add(text, ", of camera-IMU {:.3f} nats", *s.camera_imu_entropy_nats);
    }
    // Corners were scored, and a part was not.
    if (!s.problem.empty()) add(text, "; {}", s.problem);
    add(text, "\n");
  }
  // Once for all files, whose entropies are of one list of parameters and one noise; otherwise they
  // would not compare.
  const auto scored = std::ranges::find_if(
      record.scores, [](const CalibrationScore& s) { return s.entropy_nats.has_value(); });
  if (scored == record.scores.end()) return;
  add(text, "  Entropy of {} parameters ({} ... {}), corner noise {:g} px\n",
      scored->entropy_parameters.size(), scored->entropy_parameters.front(),
      scored->entropy_parameters.back(), record.assumptions.pixel_sigma_px);
  const bool imu = std::ranges::any_of(
      record.scores, [](const auto& s) { return s.camera_imu_entropy_nats.has_value(); });
  if (!imu) return;
  add(text,
      "  Entropy of camera-IMU: T_SC0 and time_offset, the session's IMU noise, cameras fixed\n");
}

/// Centre and worst value of a map.
void addMap(Text& text, const ImageMap& map) {
  const MapExtremes extremes = extremesOf(map);
  const std::string range =
      std::isfinite(map.range_m) ? fmt::format("{:g} m", map.range_m) : "infinity";
  add(text, "  {:<24} {:<6} {:>9} {:>10.4f} {:>10.4f}  {}\n", fitted(map.label), map.camera, range,
      extremes.centre, extremes.worst, map.method);
}

void addMaps(Text& text, const char* title, const std::vector<ImageMap>& maps) {
  if (maps.empty()) return;
  add(text, "\n{:<42} {:>10} {:>10}\n", title, "centre", "most");
  for (const ImageMap& map : maps) addMap(text, map);
}

using Cells = std::vector<std::optional<double>>;

void addRow(Text& text, const std::string& name, const std::string& unit,
            const std::array<Cells, 4>& cells) {
  add(text, "{},{}", name, unit);
  for (const Cells& values : cells) {
    for (const auto& value : values) add(text, ",{}", value ? fmt::format("{}", *value) : "");
  }
  add(text, "\n");
}

/// Mean paired difference of the ATE to the first calibration, whichever way round it was taken.
std::optional<double> ateDifference(const TrajectoryStudy& study, const std::string& label,
                                    const std::string& first) {
  for (const PairedDifference& d : study.paired) {
    if (d.pairs == 0) continue;
    if (d.b == label && d.a == first) return d.mean_m;
    if (d.a == label && d.b == first) return -d.mean_m;
  }
  return {};
}

void addTrajectories(Text& text, const ComparisonRecord& record) {
  std::map<std::string, Cells> medians;  // by sequence, "" for all
  Cells difference(record.calibrations.size()), none(record.calibrations.size());
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    const std::string& label = record.calibrations[i].label;
    for (const RunsSummary& s : record.trajectories->summary) {
      if (s.calibration != label) continue;
      medians.try_emplace(s.sequence, none).first->second[i] = s.ate_median_m;
    }
    if (i > 0) {
      difference[i] = ateDifference(*record.trajectories, label, record.calibrations[0].label);
    }
  }
  for (const auto& [sequence, values] : medians) {
    // Paired differences are over all sequences: in the row of all, or the only one.
    const bool all = sequence.empty() || medians.size() == 1;
    addRow(text, csvCell("ate." + (sequence.empty() ? "all" : sequence)), "m",
           {values, none, all ? difference : none, none});
  }
}

}  // namespace

std::string comparisonSummary(const ComparisonRecord& record) {
  Text text;
  addCameras(text, record);
  addParameters(text, record);
  addScores(text, record);
  addMaps(text, "Standard deviation of a projection [px]", record.uncertainties);
  addMaps(text, "Projection difference [px]", record.differences);
  add(text, "\n{}", verdictText(record.verdict));
  return fmt::to_string(text);
}

std::string comparisonTable(const ComparisonRecord& record) {
  Text text;
  add(text, "#name,unit");
  for (const char* what : {"value", "std", "difference", "significance"}) {
    for (const ComparedCalibration& c : record.calibrations)
      add(text, ",{} {}", what, csvCell(c.label));
  }
  add(text, "\n");
  for (const ComparedParameter& p : record.parameters) {
    addRow(text, p.name, p.unit, {p.values, p.std, p.difference, p.significance});
  }
  if (record.trajectories) addTrajectories(text, record);
  return fmt::to_string(text);
}

}  // namespace plumbline

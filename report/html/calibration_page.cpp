// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/calibration_page.h"

#include <fmt/format.h>
#include <kainjow/mustache.hpp>

#include "report/html/assets.h"
#include "report/html/imu_figures.h"
#include "report/html/page_parts.h"
#include "report/html/reprojection_figures.h"
#include "report/html/scene.h"
#include "report/html/text.h"
#include "report/plots/svg.h"

namespace plumbline {
namespace {

using namespace html_internal;
using kainjow::mustache::data;

struct Section {
  std::string id, title, lead;
  std::vector<std::string> remarks;
  std::vector<FigureGroup> groups;
};

/// A list for a template, one element per item.
template <class Items, class Make>
data listOf(const Items& items, const Make& make) {
  data list{data::type::list};
  for (const auto& item : items) list.push_back(make(item));
  return list;
}

data object(std::initializer_list<std::pair<std::string, std::string>> fields) {
  data result{data::type::object};
  for (const auto& [name, value] : fields) result.set(name, value);
  return result;
}

data flag(bool value) { return data{value ? data::type::bool_true : data::type::bool_false}; }

data sectionData(const Section& section) {
  data result = object({{"id", section.id}, {"title", section.title}, {"lead", section.lead}});
  result.set("has_remarks", flag(!section.remarks.empty()));
  result.set("remarks", listOf(section.remarks, [](const std::string& s) { return data{s}; }));
  result.set("groups", listOf(section.groups, [](const FigureGroup& group) {
               data g{data::type::object};
               if (group.heading.empty()) {
                 g.set("heading", flag(false));
               } else {
                 g.set("heading", group.heading);
               }
               g.set("figures", listOf(group.figures, [](const Figure& figure) {
                       data f = object({{"svg", figure.svg}, {"caption", figure.caption}});
                       f.set("wide", flag(figure.wide));
                       return f;
                     }));
               return g;
             }));
  return result;
}

Section reprojectionSection(const StageView& stage, const std::string& id) {
  return {id,
          "Reprojection, " + (id == "reprojection-camera" ? std::string("cameras") : "camera-IMU"),
          fmt::format("Errors of the {} corners that the {} used: measured minus projected.",
                      grouped(stage.summary.corners_used),
                      id == "reprojection-camera" ? "camera stage" : "camera-IMU stage"),
          {},
          reprojectionFigures(stage)};
}

Section correlationSection(const CalibrationRecord& record) {
  Section section{"correlations",
                  "Correlations",
                  fmt::format("How the estimates depend on each other, for a corner noise of {:g} "
                              "px per coordinate and with all poses and states marginalised. The "
                              "entropy sums it up: 0.5 log((2\u03c0e)\u207f |\u03a3|); it compares "
                              "only under the same parameters, units and noise.",
                              record.assumptions.pixel_sigma_px),
                  {},
                  {}};
  if (record.camera) section.groups.push_back(correlationFigures(viewOf(*record.camera)));
  if (record.camera_imu) section.groups.push_back(correlationFigures(viewOf(*record.camera_imu)));
  std::erase_if(section.groups, [](const FigureGroup& g) { return g.figures.empty(); });
  return section;
}

Section imuSection(const CameraImuStageResult& stage) {
  const ImuNoiseChecks& noise = stage.imu_summary.noise;
  return {"imu-residuals",
          "Inertial residuals",
          "What is left between the inertial samples and the motion that explains them together "
          "with the corners, and what it says of the densities that were assumed.",
          {judgeDensity("Gyroscope noise", noise.gyro),
           judgeDensity("Accelerometer noise", noise.accel),
           judgeDensity("Gyroscope bias walk", noise.gyro_bias),
           judgeDensity("Accelerometer bias walk", noise.accel_bias),
           fmt::format("The noise of the poses is that of corners of {:.2f} px.",
                       noise.pose_pixel_sigma)},
          imuResidualFigures(stage)};
}

std::vector<Section> figureSections(const CalibrationRecord& record) {
  std::vector<Section> sections;
  Section correlations = correlationSection(record);
  if (!correlations.groups.empty()) sections.push_back(std::move(correlations));
  if (record.camera) {
    sections.push_back(reprojectionSection(viewOf(*record.camera), "reprojection-camera"));
  }
  if (record.camera_imu) {
    sections.push_back(reprojectionSection(viewOf(*record.camera_imu), "reprojection-camera-imu"));
  }
  if (record.camera || record.camera_imu) {
    const StageView stage = record.camera ? viewOf(*record.camera) : viewOf(*record.camera_imu);
    sections.push_back({"coverage",
                        "Image coverage",
                        "Where in the image the target was seen. Corners at the edges decide the "
                        "distortion.",
                        {},
                        {coverageFigures(stage)}});
  }
  if (record.camera_imu) {
    sections.push_back(imuSection(*record.camera_imu));
    sections.push_back({"biases",
                        "Biases",
                        "Estimated offsets of the inertial sensors at every frame.",
                        {},
                        {biasFigures(*record.camera_imu)}});
  }
  return sections;
}

data findingRow(const Finding& f) {
  const std::string unit = f.unit == "-" ? "" : " " + f.unit;
  // A rule without a unit compares nothing with a threshold (convergence).
  const std::string threshold =
      f.unit.empty() ? "\u2013" : fmt::format("{:g}{}", f.threshold, unit);
  return object({{"rule", f.rule},
                 {"level", toString(f.level)},
                 {"evidence", f.evidence},
                 {"advice", f.advice},
                 {"threshold", threshold}});
}

void setVerdict(data& page, const Verdict& verdict) {
  const std::string word = toString(verdict.level);
  page.set("verdict", word);
  page.set("verdict_word", std::string(1, static_cast<char>(word[0] - 'a' + 'A')) + word.substr(1));
  page.set("verdict_sentence", verdictSentence(verdict));
  std::vector<Finding> concerns;
  std::vector<Finding> holds;
  for (const Finding& finding : verdict.findings) {
    (finding.level == VerdictLevel::kGood ? holds : concerns).push_back(finding);
  }
  page.set("has_concerns", flag(!concerns.empty()));
  page.set("concerns", listOf(concerns, findingRow));
  page.set("has_holds", flag(!holds.empty()));
  page.set("holds_summary",
           fmt::format("{} of {} rules hold", holds.size(), verdict.findings.size()));
  page.set("holds", listOf(holds, findingRow));
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

void setParameters(data& page, const CalibrationRecord& record) {
  const bool spread = record.camera_resample || record.camera_imu_resample;
  page.set(
      "parameters_lead",
      std::string("Std is the formal standard deviation: it follows from the assumed noise and "
                  "holds only if model and noise are right. ") +
          (spread ? "Spread is what resampled time segments of the recording gave; where it is "
                    "several times the std, trust the spread."
                  : "A resampled calibration (--resample) would show the real spread beside "
                    "it."));
  page.set("parameter_groups", listOf(parameterGroups(record), [](const ParameterGroup& group) {
             data g{data::type::object};
             g.set("heading", group.heading);
             g.set("has_spread", flag(group.has_spread));
             g.set("rows", listOf(group.rows, [](const ParameterRow& r) {
                     return object({{"name", r.name},
                                    {"value", r.value},
                                    {"std", r.std},
                                    {"unit", r.unit},
                                    {"spread", r.spread},
                                    {"ratio", r.ratio}});
                   }));
             return g;
           }));
  data matrices{data::type::list};
  if (record.camera_imu) {
    matrices.push_back(
        matrixData("T_SC0", record.camera_imu->imu.T_SC0, "Camera 0 to IMU: p_S = T_SC0 p_C0 [m]"));
  }
  for (std::size_t i = 1; i < record.cameras().size(); ++i) {
    const std::string name = "T_C0C" + std::to_string(i);
    matrices.push_back(
        matrixData(name, record.cameras()[i].T_C0Ci,
                   fmt::format("Camera {0} to camera 0: p_C0 = {1} p_C{0} [m]", i, name)));
  }
  page.set("matrices", matrices);
}

void setOffset(data& page, const CalibrationRecord& record) {
  page.set("has_offset", flag(record.camera_imu.has_value()));
  page.set("has_imu", flag(record.camera_imu.has_value()));
  if (!record.camera_imu) return;
  const ImuCalibration& imu = record.camera_imu->imu;
  page.set(
      "offsets",
      listOf(offsetRows(imu.time_offset_s, imu.time_offset_std_s), [](const OffsetRow& r) {
        return object({{"tool", r.tool}, {"field", r.field}, {"value", r.value}, {"note", r.note}});
      }));
}

void setScene(data& page, const CalibrationRecord& record) {
  const Scene scene = buildScene(record);
  page.set("scene_json", toJson(scene));
  page.set("scene_still", toStillSvg(scene, "scene-still"));
  page.set("scene_rmse_min", fmt::format("{:.2f}", scene.rmse.min));
  page.set("scene_rmse_max", fmt::format("{:.2f}", scene.rmse.max));
  page.set("scene_seconds", fmt::format("{:.1f}", scene.seconds));
  std::vector<Pair> layers = {{"target", "target"}, {"path", "path"}};
  for (std::size_t i = 0; i < record.cameras().size(); ++i) {
    layers.push_back({"cam" + std::to_string(i), record.cameras()[i].name});
  }
  if (record.camera_imu) layers.insert(layers.end(), {{"rig", "IMU"}, {"gravity", "gravity"}});
  page.set("scene_layers", listOf(layers, [](const Pair& p) {
             return object({{"layer", p.label}, {"label", p.value}});
           }));
}

data timingRow(const std::string& stage, const StageSeconds& s) {
  data row = object({{"stage", stage}});
  const double all[] = {s.load, s.detect, s.initialise, s.solve, s.covariance, s.total};
  row.set("cells", listOf(all, [](double v) { return data{fmt::format("{:.3f}", v)}; }));
  return row;
}

void setProvenance(data& page, const CalibrationRecord& record) {
  page.set("provenance", listOf(provenanceRows(record), [](const Pair& p) {
             return object({{"label", p.label}, {"value", p.value}});
           }));
  data timings{data::type::list};
  if (record.camera) timings.push_back(timingRow("cameras", record.camera->summary.seconds));
  if (record.camera_imu) {
    timings.push_back(timingRow("camera-IMU", record.camera_imu->summary.seconds));
  }
  page.set("has_timings", flag(record.camera || record.camera_imu));
  page.set("timings", timings);
}

data contents(const CalibrationRecord& record, const std::vector<Section>& sections) {
  std::vector<Pair> entries = {{"verdict", "Verdict"},
                               {"key-figures", "Key figures"},
                               {"scene", "Scene"},
                               {"parameters", "Parameters"}};
  if (record.camera_imu) entries.push_back({"time-offset", "Time offset"});
  for (const Section& section : sections) entries.push_back({section.id, section.title});
  entries.push_back({"provenance", "Provenance"});
  return listOf(entries, [](const Pair& p) {
    return object({{"id", p.label}, {"title", p.value}});
  });
}

}  // namespace

std::string renderCalibrationPage(const CalibrationRecord& record) {
  const std::vector<Section> sections = figureSections(record);
  data page{data::type::object};
  page.set("name", record.name);
  page.set("input", record.provenance.input);
  page.set("date", record.provenance.date);
  page.set("version", record.provenance.version);
  page.set("css", embedded::page_style());
  page.set("viewer", embedded::scene_viewer());
  page.set("hover", hoverScript());
  page.set("script", embedded::page_script());
  page.set("toc", contents(record, sections));
  setVerdict(page, record.verdict);
  page.set("cards", listOf(keyFigures(record), [](const Card& c) {
             data d = object(
                 {{"label", c.label}, {"value", c.value}, {"unit", c.unit}, {"note", c.note}});
             d.set("wide", flag(c.wide));
             return d;
           }));
  setScene(page, record);
  setParameters(page, record);
  setOffset(page, record);
  page.set("sections", listOf(sections, sectionData));
  setProvenance(page, record);
  kainjow::mustache::mustache pattern{embedded::calibration_page()};
  return pattern.render(page);
}

}  // namespace plumbline

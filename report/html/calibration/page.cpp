// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/calibration/page.h"

#include <fmt/format.h>

#include "generated/report/embedded.h"
#include "report/html/calibration/held_scores.h"
#include "report/html/calibration/imu_figures.h"
#include "report/html/calibration/reprojection_figures.h"
#include "report/html/page_data.h"
#include "report/html/page_parts.h"
#include "report/html/scene.h"
#include "report/html/text.h"

namespace plumbline {
namespace {

using namespace html_internal;

std::vector<Block> blocksOf(std::vector<FigureGroup> groups) {
  std::vector<Block> blocks;
  for (FigureGroup& group : groups) {
    blocks.push_back({std::move(group.heading), "", {}, {}, std::move(group.figures)});
  }
  return blocks;
}

Section reprojectionSection(const StageView& stage, const std::string& id) {
  return {id,
          "Reprojection, " + (id == "reprojection-camera" ? std::string("cameras") : "camera-IMU"),
          fmt::format("Errors of the {} corners that the {} used: measured minus projected.",
                      grouped(stage.summary.corners_used),
                      id == "reprojection-camera" ? "camera stage" : "camera-IMU stage"),
          {},
          blocksOf(reprojectionFigures(stage))};
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
  std::vector<FigureGroup> groups;
  if (record.camera) groups.push_back(correlationFigures(viewOf(*record.camera)));
  if (record.camera_imu) groups.push_back(correlationFigures(viewOf(*record.camera_imu)));
  std::erase_if(groups, [](const FigureGroup& g) { return g.figures.empty(); });
  section.blocks = blocksOf(std::move(groups));
  return section;
}

std::vector<std::string> noiseRemarks(const ImuNoiseChecks& noise) {
  if (noise.gyro.redundancy <= 0) return {};  // nobody asked
  return {judgeDensity("Gyroscope noise", noise.gyro),
          judgeDensity("Accelerometer noise", noise.accel),
          judgeDensity("Gyroscope bias walk", noise.gyro_bias),
          judgeDensity("Accelerometer bias walk", noise.accel_bias),
          fmt::format("The noise of the poses is that of corners of {:.2f} px.",
                      noise.pose_pixel_sigma)};
}

Section imuSection(const CameraImuStageResult& stage) {
  return {"imu-residuals", "Inertial residuals",
          "What is left between the inertial samples and the motion that explains them together "
          "with the corners, and what it says of the densities that were assumed.",
          noiseRemarks(stage.imu_summary.noise), blocksOf(imuResidualFigures(stage))};
}

std::vector<Section> figureSections(const CalibrationRecord& record) {
  std::vector<Section> sections;
  if (record.held) sections.push_back(heldScoresSection(*record.held));
  Section correlations = correlationSection(record);
  if (!correlations.blocks.empty()) sections.push_back(std::move(correlations));
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
                        blocksOf({coverageFigures(stage)})});
  }
  if (record.camera_imu) {
    sections.push_back(imuSection(*record.camera_imu));
    sections.push_back({"biases",
                        "Biases",
                        "Estimated offsets of the inertial sensors at every frame.",
                        {},
                        blocksOf({biasFigures(*record.camera_imu)})});
  }
  return sections;
}

std::string heldLead(const HeldCalibration& held) {
  return "Estimates are those of " + held.file +
         ", as they stand there. Std is not theirs: it is what this recording could tell of them, "
         "under the assumed noise, with all poses and states marginalised; of the camera-IMU "
         "parameters with the cameras held.";
}

void setParameters(data& page, const CalibrationRecord& record) {
  const bool spread = record.camera_resample || record.camera_imu_resample;
  page.set(
      "parameters_lead",
      record.held
          ? heldLead(*record.held)
          : std::string(
                "Std is the formal standard deviation: it follows from the assumed noise and "
                "holds only if model and noise are right. ") +
                (spread
                     ? "Spread is what resampled time segments of the recording gave; where it is "
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
  page.set("provenance", pairsData(provenanceRows(record)));
  data timings{data::type::list};
  if (record.camera) timings.push_back(timingRow("cameras", record.camera->summary.seconds));
  if (record.camera_imu) {
    timings.push_back(timingRow("camera-IMU", record.camera_imu->summary.seconds));
  }
  page.set("has_timings", flag(record.camera || record.camera_imu));
  page.set("timings", timings);
}

std::vector<Pair> contents(const CalibrationRecord& record, const std::vector<Section>& sections) {
  std::vector<Pair> entries = {{"verdict", record.held ? "Summary" : "Verdict"},
                               {"key-figures", "Key figures"},
                               {"scene", "Scene"},
                               {"parameters", "Parameters"}};
  if (record.camera_imu) entries.push_back({"time-offset", "Time offset"});
  for (const Section& section : sections) entries.push_back({section.id, section.title});
  entries.push_back({"provenance", "Provenance"});
  return entries;
}

}  // namespace

std::string renderCalibrationPage(const CalibrationRecord& record) {
  const std::vector<Section> sections = figureSections(record);
  data page = startPage({record.held ? "Calibration scored, not estimated" : "Calibration report",
                         record.name, record.provenance});
  page.set("viewer", embedded::scene_viewer_bundle_js());
  page.set("footer", "Made by Plumbline " + record.provenance.version +
                         " from its records alone. The 3D viewer contains vtk.js (BSD-3-Clause, "
                         "Kitware); notices stand in the page's source.");
  setContents(page, contents(record, sections));
  if (record.held) {
    for (const char* part : {"verdict", "has_concerns", "has_holds"}) page.set(part, flag(false));
  } else {
    setVerdict(page, record.verdict, verdictSentence(record.verdict));
  }
  page.set("cards", cardsData(keyFigures(record)));
  setScene(page, record);
  setParameters(page, record);
  setOffset(page, record);
  page.set("sections", sectionsData(sections));
  setProvenance(page, record);
  return renderTemplate(embedded::calibration_page(), page);
}

}  // namespace plumbline

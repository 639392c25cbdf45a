// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <fmt/format.h>

#include "generated/report/embedded.h"
#include "report/html/calibration/sections.h"
#include "report/html/figure.h"
#include "report/html/pages.h"
#include "report/html/scene.h"
#include "report/html/section.h"

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

/// What lens and board leave beside the detector's noise, a sentence a camera.
std::vector<std::string> biasRemarks(const CameraStageResult& stage) {
  std::vector<std::string> remarks;
  for (const BiasRatio& b : stage.bias) {
    // Without patches there is no noise of the detector to tell the rest from.
    if (b.patches == 0) continue;
    remarks.push_back(fmt::format(
        "{}: bias ratio {:.2f}. Of the squared error {:.0f} % is systematic, shared by "
        "neighbouring corners; the detector's noise is {:.3f} px per axis, the whole error {:.3f} "
        "px ({} patches of 2 x 2 tags).",
        b.camera, b.ratio, 100 * b.ratio, b.noise_px, b.error_px, b.patches));
  }
  return remarks;
}

Section reprojectionSection(const StageView& stage, const std::string& id) {
  return {id,
          "Reprojection, " + (id == "reprojection-camera" ? std::string("cameras") : "camera-IMU"),
          fmt::format("Errors of the {} corners that the {} used: measured minus projected.",
                      grouped(stage.summary.corners_used),
                      id == "reprojection-camera" ? "camera stage" : "camera-IMU stage"),
          blocksOf(reprojectionFigures(stage))};
}

Section correlationSection(const CalibrationRecord& record) {
  Section section{
      "correlations", "Correlations",
      fmt::format(
          "Correlations of the estimates, for a corner noise of {:g} px per coordinate and with "
          "all poses and states marginalised. Their entropy is 0.5 log((2\u03c0e)\u207f |\u03a3|); "
          "compare it only under the same parameters, units and noise.",
          record.assumptions.pixel_sigma_px)};
  std::vector<FigureGroup> groups;
  if (record.camera) groups.push_back(correlationFigures(cameraView(record)));
  if (record.camera_imu) groups.push_back(correlationFigures(cameraImuView(record)));
  std::erase_if(groups, [](const FigureGroup& g) { return g.figures.empty(); });
  section.blocks = blocksOf(std::move(groups));
  return section;
}

/// Rules go by their names, which documents have too (evaluate/metrics/rules).
const Finding* findingOf(const Verdict& verdict, const std::string& rule) {
  for (const Finding& finding : verdict.findings) {
    if (finding.rule == rule) return &finding;
  }
  return nullptr;
}

/// What the residuals say of the densities assumed, with what the verdict made of it.
std::vector<std::string> noiseRemarks(const ImuNoiseChecks& noise, const Verdict& verdict) {
  if (noise.gyro.redundancy <= 0) return {};  // nobody asked
  return {densityRemark("Gyroscope noise", noise.gyro,
                        findingOf(verdict, "Noise density of the gyroscope")),
          densityRemark("Accelerometer noise", noise.accel,
                        findingOf(verdict, "Noise density of the accelerometer")),
          // No rule judges the walks.
          densityRemark("Gyroscope bias walk", noise.gyro_bias, nullptr),
          densityRemark("Accelerometer bias walk", noise.accel_bias, nullptr),
          fmt::format("The noise of the poses corresponds to a corner noise of {:.2f} px.",
                      noise.pose_pixel_sigma)};
}

Section readingsSection(const CameraImuStageResult& stage, TimeNs origin) {
  FigureGroup figures = readingFigures(stage, origin);
  // Without blocks: renderPage() leaves such sections out.
  if (figures.figures.empty()) return {};
  return {"imu-readings", "Measured and predicted readings",
          "Readings of gyroscope and accelerometer, and the readings that the solution predicts, "
          "in the IMU's axes.",
          blocksOf({std::move(figures)})};
}

Section uncertaintySection(const CalibrationRecord& record) {
  // The maps are then made of the cluster-robust covariance.
  const bool robust = record.camera && record.camera->summary.robust_std;
  Section section{
      "projection-uncertainty", "Projection uncertainty",
      "One standard deviation, in the worst direction, of the projection of a far point if the "
      "recording were repeated; a rotation of the camera frame is removed. Large values mark "
      "regions where the recording does not determine the lens. " +
          std::string(robust ? "Errors of a model that does not fit are included only as far as "
                               "they vary over the recording."
                             : "Errors of a model that does not fit are not included.")};
  std::vector<HeatMap> maps;
  std::vector<std::string> methods;
  for (const ImageMap& map : record.projection_uncertainty) {
    if (!sound(map)) continue;
    maps.push_back(heatMap(map, map.camera + ": " + rangeText(map.range_m), "std [px]"));
    methods.push_back(map.method);
  }
  // One scale of colours, by which cameras compare.
  scaleAlike(addressesOf(maps));
  Block block;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    Figure figure = heatFigure(maps[i], fmt::format("projection-uncertainty-{}", i));
    figure.caption = "By " + methods[i] + ". " + figure.caption;
    block.figures.push_back(std::move(figure));
  }
  section.blocks.push_back(std::move(block));
  return section;
}

Section imuSection(const CameraImuStageResult& stage, TimeNs origin, const Verdict& verdict) {
  return {"imu-residuals", "Inertial residuals",
          "Residuals between the inertial samples and the estimated motion, and the noise "
          "densities that they indicate.",
          blocksOf(imuResidualFigures(stage, origin)),
          noiseRemarks(stage.imu_summary.noise, verdict)};
}

/// Those without blocks are left out by renderPage().
std::vector<Section> figureSections(const CalibrationRecord& record) {
  std::vector<Section> sections;
  if (record.held) sections.push_back(heldScoresSection(*record.held));
  sections.push_back(correlationSection(record));
  sections.push_back(halvesSection(record));
  if (record.camera) {
    sections.push_back(modelSection(*record.camera));
    if (record.camera->target_fit) {
      sections.push_back(targetSection(record.target, *record.camera));
    }
    sections.push_back(reprojectionSection(cameraView(record), "reprojection-camera"));
    sections.back().remarks = biasRemarks(*record.camera);
  }
  if (record.camera_imu) {
    sections.push_back(reprojectionSection(cameraImuView(record), "reprojection-camera-imu"));
  }
  // Images are kept of the views of the camera stage where it ran.
  if (record.camera) {
    sections.push_back(viewsSection(cameraView(record), record.camera->T_FC0, record.view_images));
  } else if (record.camera_imu) {
    sections.push_back(
        viewsSection(cameraImuView(record), cameraPoses(*record.camera_imu), record.view_images));
  }
  if (record.camera || record.camera_imu) {
    const StageView stage = record.camera ? cameraView(record) : cameraImuView(record);
    sections.push_back(
        {"coverage", "Image coverage",
         "Where in the image the target was seen. Corners near the edges determine the distortion.",
         blocksOf({coverageFigures(stage)})});
  }
  if (!record.projection_uncertainty.empty()) sections.push_back(uncertaintySection(record));
  if (record.camera_imu) {
    sections.push_back(readingsSection(*record.camera_imu, timeOrigin(record)));
    sections.push_back(imuSection(*record.camera_imu, timeOrigin(record), record.verdict));
    sections.push_back({"biases", "Biases",
                        "Estimated offsets of the inertial sensors at every frame.",
                        blocksOf({biasFigures(*record.camera_imu, timeOrigin(record))})});
  }
  if (!record.sample_intervals.empty()) sections.push_back(intervalsSection(record));
  return sections;
}

std::string heldLead(const HeldCalibration& held) {
  return "Estimates are those of " + held.file +
         ", unchanged. Std is not from that file: it is the standard deviation with which this "
         "recording would determine them, under the assumed noise, with all poses and states "
         "marginalised; for the camera-IMU parameters with the cameras fixed.";
}

std::string parametersLead(const CalibrationRecord& record) {
  if (record.held) return heldLead(*record.held);
  const bool bootstrap = record.camera_resample || record.camera_imu_resample;
  return std::string(
             "Std is cluster-robust where a formal one is listed too: it is computed from the "
             "scores of blocks of the recording, and remains valid where the errors of "
             "neighbouring frames are correlated. The 90 % interval is the estimate plus or minus "
             "the given half width: the std times a quantile of Student's t, which is larger the "
             "fewer blocks determine the std. The formal standard deviation follows from the "
             "assumed noise and is valid only if model and noise are right. ") +
         (bootstrap ? "The bootstrap std comes from resampled time segments of the recording; "
                      "where it is several times the std, use it instead."
                    : "With --resample, a bootstrap std is listed too.");
}

Block parameterBlock(const ParameterGroup& group) {
  Table table{{code("Parameter"), number("Estimate"), number("Std")}};
  // A column that some parameter of the group needs, all of them have.
  if (group.has_interval) table.columns.push_back(number("90 % interval, \u00b1"));
  if (group.has_formal) table.columns.push_back(number("Formal std"));
  table.columns.push_back(words("Unit"));
  if (group.has_spread) {
    table.columns.push_back(number("Bootstrap std"));
    table.columns.push_back(number("Bootstrap / std"));
  }
  for (const ParameterRow& r : group.rows) {
    std::vector<Cell> row = {code(r.name), number(r.value), number(r.std)};
    if (group.has_interval) row.push_back(number(r.interval));
    if (group.has_formal) row.push_back(number(r.formal));
    row.push_back({r.unit});
    if (group.has_spread) row.insert(row.end(), {number(r.spread), number(r.ratio)});
    table.rows.push_back(std::move(row));
  }
  return {group.heading, "", std::move(table)};
}

Section parametersSection(const CalibrationRecord& record) {
  Section section{"parameters", "Parameters", parametersLead(record)};
  for (const ParameterGroup& group : parameterGroups(record)) {
    section.blocks.push_back(parameterBlock(group));
  }
  // As matrices too: in the tables a rotation is a rotation vector, which nobody pastes into a
  // file.
  Block matrices;
  if (record.camera_imu) {
    matrices.matrices.push_back(
        {"T_SC0", record.camera_imu->imu.T_SC0, "Camera 0 to IMU: p_S = T_SC0 p_C0 [m]"});
  }
  for (std::size_t i = 1; i < record.cameras().size(); ++i) {
    const std::string name = "T_C0C" + std::to_string(i);
    matrices.matrices.push_back(
        {name, record.cameras()[i].T_C0Ci,
         fmt::format("Camera {0} to camera 0: p_C0 = {1} p_C{0} [m]", i, name)});
  }
  section.blocks.push_back(std::move(matrices));
  return section;
}

Section offsetSection(const CalibrationRecord& record) {
  Table table{{words("Tool"), code("Field"), number("As written"), number("Value"), words("Note")}};
  // Camera 0's; where the others have their own, the block's text says by how much they differ.
  for (const OffsetRow& r :
       offsetRows(record.camera_imu->imu.timeOffset(), shownOffsetStd(record))) {
    table.rows.push_back({{r.tool}, code(r.field), number(r.number), number(r.value), {r.note}});
  }
  Section section = withTable(
      {"time-offset", "Time offset in every tool's sign",
       "The convention here is t_imu = t_cam + t_d: a camera stamp plus the offset is the same "
       "instant on the IMU's clock."},
      std::move(table));
  section.blocks.front().text =
      unlikeOffsetsText(record.camera_imu->cameras, record.camera_imu->imu);
  return section;
}

Section sceneSection(const CalibrationRecord& record) {
  const Scene scene = buildScene(record);
  data values{data::type::object};
  values.set("scene_json", scriptJson(toJson(scene)));
  values.set("scene_still", toStillSvg(scene, "scene-still"));
  values.set("scene_rmse_gradient", rmseGradient());
  values.set("scene_time_gradient", timeGradient());
  values.set("scene_rmse_min", fmt::format("{:.2f}", scene.rmse.min));
  values.set("scene_rmse_max", fmt::format("{:.2f}", scene.rmse.max));
  values.set("scene_seconds", fmt::format("{:.1f}", scene.seconds));
  values.set("has_imu", flag(record.camera_imu.has_value()));
  // By the names that buildScene() gives its layers: by them the boxes of the page show and hide.
  std::vector<Pair> layers = {{"target", "target"}, {"path", "path"}};
  for (std::size_t i = 0; i < record.cameras().size(); ++i) {
    layers.push_back({"cam" + std::to_string(i), record.cameras()[i].name});
  }
  if (record.camera_imu) layers.insert(layers.end(), {{"rig", "IMU"}, {"gravity", "gravity"}});
  values.set("scene_layers", listOf(layers, [](const Pair& p) {
               return object({{"layer", p.label}, {"label", p.value}});
             }));
  Block block;
  block.html = renderTemplate(embedded::scene(), values);
  return {"scene",
          "Scene",
          "The target and where the cameras were, in the target's frame. Drag to turn, scroll to "
          "zoom, shift-drag to move; click a camera to see its view. Keys: arrows turn, + and - "
          "zoom, page up and down select the view before and after, 0 resets. Good data cover all "
          "directions from the target: near and far, tilted about both axes, and rolled.",
          {std::move(block)}};
}

/// In the order of the columns of timings().
std::vector<Cell> timingRow(const std::string& stage, const StageSeconds& s) {
  std::vector<Cell> row = {{stage}};
  for (const double v :
       {s.load, s.detect, s.initialise, s.solve, s.checks, s.covariance, s.total}) {
    row.push_back(number(fmt::format("{:.3f}", v)));
  }
  return row;
}

std::vector<Block> timings(const CalibrationRecord& record) {
  Table table{{words("Stage")}};
  for (const char* part :
       {"load", "detect", "initialise", "solve", "checks", "covariance", "total"}) {
    table.columns.push_back(number(part));
  }
  if (record.camera) table.rows.push_back(timingRow("cameras", record.camera->summary.seconds));
  if (record.camera_imu) {
    table.rows.push_back(timingRow("camera-IMU", record.camera_imu->summary.seconds));
  }
  if (table.rows.empty()) return {};
  return {{"Seconds", "", std::move(table)}};
}

std::vector<Section> sectionsOf(const CalibrationRecord& record) {
  std::vector<Section> sections = {sceneSection(record), parametersSection(record)};
  if (record.camera_imu) sections.push_back(offsetSection(record));
  for (Section& section : figureSections(record)) sections.push_back(std::move(section));
  return sections;
}

}  // namespace

std::string renderCalibrationPage(const CalibrationRecord& record) {
  Page page{record.held ? "Calibration scored, not estimated" : "Calibration report",
            record.name,
            record.provenance,
            record.verdict,
            keyFigures(record),
            sectionsOf(record),
            record.assumptions};
  // A file on which no rule was tried is not called good.
  if (record.held && record.verdict.findings.empty()) page.verdict.reset();
  page.more_rows = calibrationRows(record);
  page.appendix = timings(record);
  page.script = embedded::scene_viewer_bundle_js() + embedded::views_js();
  page.notice =
      " The 3D viewer contains vtk.js (BSD-3-Clause, Kitware); notices are in the page's source.";
  return renderPage(page);
}

}  // namespace plumbline

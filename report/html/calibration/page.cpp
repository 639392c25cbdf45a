// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <fmt/format.h>

#include "calibrator/fields/json_fields.h"
#include "generated/report/embedded.h"
#include "report/html/calibration/sections.h"
#include "report/html/figure.h"
#include "report/html/pages.h"

namespace plumbline {
namespace {

using namespace html_internal;

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

Section reprojectionSection(const StageView& stage, std::vector<std::string> remarks) {
  const bool cameras = stage.id == "camera";
  return {"reprojection-" + stage.id,
          cameras ? "Reprojection, cameras" : "Reprojection, camera-IMU",
          fmt::format("Errors of the {} corners that the {} used: measured minus projected.",
                      grouped(stage.summary.corners_used),
                      cameras ? "camera stage" : "camera-IMU stage"),
          reprojectionFigures(stage), std::move(remarks)};
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

/// Those without blocks are left out by renderPage().
std::vector<Section> figureSections(const CalibrationRecord& record) {
  std::vector<Section> sections;
  const auto add = [&](Section section) { sections.push_back(std::move(section)); };
  if (record.held) add(heldScoresSection(*record.held));
  add(correlationSection(record));
  add(halvesSection(record));
  if (record.camera) {
    add(modelSection(*record.camera));
    if (record.camera->target_fit) add(targetSection(record.target, *record.camera));
    add(reprojectionSection(cameraView(record), biasRemarks(*record.camera)));
  }
  if (record.camera_imu) add(reprojectionSection(cameraImuView(record), {}));
  if (record.camera || record.camera_imu) {
    // Images are kept of the views of the camera stage where it ran.
    const StageView stage = record.camera ? cameraView(record) : cameraImuView(record);
    add(viewsSection(stage, record.camera ? record.camera->T_FC0 : cameraPoses(*record.camera_imu),
                     record.view_images));
    add(coverageSection(stage));
  }
  if (!record.projection_uncertainty.empty()) add(uncertaintySection(record));
  if (record.camera_imu) {
    add(readingsSection(*record.camera_imu, timeOrigin(record)));
    add(inertialSection(*record.camera_imu, timeOrigin(record), record.verdict));
    add(biasSection(*record.camera_imu, timeOrigin(record)));
  }
  if (!record.sample_intervals.empty()) add(intervalsSection(record));
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
  const auto hasSpread = [](const auto& spread) { return spread && !spread->names.empty(); };
  const bool bootstrap = hasSpread(record.camera_resample) || hasSpread(record.camera_imu_resample);
  const bool shared = record.camera && record.camera->summary.robust_std &&
                      record.assumptions.common_error_share > 0;
  return std::string(
             "Std is cluster-robust where a formal one is listed too: it is computed from the "
             "scores of blocks of the recording, and remains valid where the errors of "
             "neighbouring frames are correlated. ") +
         (shared
              ? fmt::format(
                    "That of the camera stage's parameters includes what the detector does alike "
                    "in all images: smooth shifts of the corners, each of {:g} % of the "
                    "reprojection error, as measured on rendered images. ",
                    100 * record.assumptions.common_error_share)
              : "It does not include what the detector does alike in all images. ") +
         std::string(
             "The 90 % interval is the estimate plus or minus "
             "the given half width: the std times a quantile of Student's t, which is larger the "
             "fewer blocks determine the std. The formal standard deviation follows from the "
             "assumed noise and is valid only if model and noise are right. ") +
         (bootstrap ? "The bootstrap std comes from resampled time segments of the recording; "
                      "where it is several times the std, use it instead."
                    : "With --resample, a bootstrap std is listed too.");
}

/// A column that some parameter of the group needs, all of them have.
Block parameterBlock(const std::string& heading, const std::vector<ParameterEstimate>& group,
                     bool held) {
  Table table{{code("Parameter"), number("Estimate"), number("Std"),
               number("90 % interval, \u00b1"), number("Formal std"), words("Unit"),
               number("Bootstrap std"), number("Bootstrap / std")}};
  bool interval = false, formal = false, spread = false;
  for (const ParameterEstimate& p : group) {
    const ReadableUnit unit = readable(p.unit);
    const double std = p.shownStd();
    const auto deviation = [&](const std::optional<double>& value) {
      return number(value ? twoDigits(unit.factor * *value) : "");
    };
    // Values that were held have no interval: their deviations are not theirs.
    const auto half = held ? std::nullopt : p.halfWidth90();
    interval = interval || half;
    formal = formal || p.robust_std;
    spread = spread || p.resample_std;
    table.rows.push_back(
        {code(p.name), number(withPrecisionOf(unit.factor * p.value, unit.factor * std)),
         deviation(std), deviation(half),
         // Where there is a robust one, that has taken the formal one's place before.
         deviation(p.robust_std ? std::optional(p.std) : std::nullopt), words(unit.unit),
         deviation(p.resample_std),
         number(p.resample_std && std > 0 ? twoDigits(*p.resample_std / std) : "")});
  }
  // From the last: what is taken out moves those after it.
  if (!spread) eraseColumns(table, 6, 2);
  if (!formal) eraseColumns(table, 4);
  if (!interval) eraseColumns(table, 3);
  return {heading, "", std::move(table)};
}

Section parametersSection(const CalibrationRecord& record) {
  Section section{"parameters", "Parameters", parametersLead(record), parameterBlocks(record)};
  // As matrices too: in the tables a rotation is a rotation vector, which nobody pastes into a
  // file.
  section.blocks.push_back(
      {.matrices =
           transformsOf(record.cameras(), record.camera_imu ? &record.camera_imu->imu : nullptr)});
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
  // By the names that buildScene() gives its layers: by them the boxes of the page show and hide.
  std::vector<Pair> layers = {{"target", "target"}, {"path", "path"}};
  for (std::size_t i = 0; i < record.cameras().size(); ++i) {
    layers.push_back({"cam" + std::to_string(i), record.cameras()[i].name});
  }
  if (record.camera_imu) layers.insert(layers.end(), {{"rig", "IMU"}, {"gravity", "gravity"}});
  data values = object({{"scene_json", scriptJson(toJson(scene))},
                        {"scene_still", toStillSvg(scene, "scene-still")},
                        {"scene_rmse_gradient", rmseGradient()},
                        {"scene_time_gradient", timeGradient()},
                        {"scene_rmse_min", fmt::format("{:.2f}", scene.rmse.min)},
                        {"scene_rmse_max", fmt::format("{:.2f}", scene.rmse.max)},
                        {"scene_seconds", fmt::format("{:.1f}", scene.seconds)},
                        {"has_imu", record.camera_imu.has_value()},
                        {"scene_layers", listOf(layers, [](const Pair& p) {
                           return object({{"layer", p.label}, {"label", p.value}});
                         })}});
  return {"scene",
          "Scene",
          "The target and where the cameras were, in the target's frame. Drag to turn, scroll to "
          "zoom, shift-drag to move; click a camera to see its view. Keys: arrows turn, + and - "
          "zoom, page up and down select the view before and after, 0 resets. Good data cover all "
          "directions from the target: near and far, tilted about both axes, and rolled.",
          {{.html = renderTemplate(embedded::scene(), values)}}};
}

std::vector<Block> timings(const CalibrationRecord& record) {
  Table table{{words("Stage")}};
  const plumbline::Json names = plumbline::toJson(StageSeconds());
  for (const auto& [name, seconds] : names.items()) table.columns.push_back(number(name));
  const auto add = [&](const char* stage, const StageSeconds& all) {
    std::vector<Cell> row = {words(stage)};
    for (const plumbline::Json& seconds : plumbline::toJson(all)) {
      row.push_back(number("{:.3f}", json_fields::numberFrom(seconds)));
    }
    table.rows.push_back(std::move(row));
  };
  if (record.camera) add("cameras", record.camera->summary.seconds);
  if (record.camera_imu) add("camera-IMU", record.camera_imu->summary.seconds);
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

std::vector<Block> html_internal::parameterBlocks(const CalibrationRecord& record) {
  std::vector<std::pair<std::string, std::vector<ParameterEstimate>>> groups;
  for (const Stage stage : {Stage::kCamera, Stage::kCameraImu}) {
    for (const ParameterEstimate& p : parameterEstimates(record, stage)) {
      // A covariance lists its parameters owner by owner: a look at the last group is enough.
      const std::string heading = groupOf(p.name);
      if (groups.empty() || groups.back().first != heading) groups.push_back({heading, {}});
      groups.back().second.push_back(p);
    }
  }
  std::vector<Block> blocks;
  for (const auto& [heading, group] : groups) {
    blocks.push_back(parameterBlock(heading, group, record.held.has_value()));
  }
  return blocks;
}

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

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/comparison_document.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/results/json_values.h"
#include "evaluate/results/record_json.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json rangeJson(double range_m) { return std::isfinite(range_m) ? Json(range_m) : Json("infinity"); }

Json calibrationsJson(const ComparisonRecord& record) {
  Json list = Json::array();
  for (const ComparedCalibration& c : record.calibrations) {
    Json cameras = Json::array();
    for (const CameraCalibration& camera : c.calibration.cameras) {
      cameras.push_back({{"name", camera.name},
                         {"model", toString(camera.intrinsics.projection_model)},
                         {"distortion", toString(camera.intrinsics.distortion_model)}});
    }
    list.push_back({{"label", c.label}, {"file", c.file}, {"tool", c.tool}, {"cameras", cameras}});
  }
  return list;
}

Json parametersJson(const ComparisonRecord& record) {
  Json list = Json::array();
  for (const ComparedParameter& p : record.parameters) {
    list.push_back({{"name", p.name},
                    {"unit", p.unit},
                    {"values", optionalsJson(p.values)},
                    {"std", optionalsJson(p.std)},
                    {"difference", optionalsJson(p.difference)},
                    {"significance", optionalsJson(p.significance)}});
  }
  return list;
}

Json scoreJson(const CalibrationScore& score) {
  Json json{{"label", score.label},
            {"session", score.session},
            {"part", score.part},
            {"held_out", score.held_out}};
  if (!score.problem.empty()) json["problem"] = score.problem;
  json["rmse_px"] = score.reprojection.rmse_px;
  Json cameras = Json::array();
  for (std::size_t c = 0; c < score.per_camera.size(); ++c) {
    cameras.push_back({{"name", c < score.cameras.size() ? score.cameras[c] : ""},
                       {"rmse_px", score.per_camera[c].rmse_px},
                       {"median_px", score.per_camera[c].median_px},
                       {"corners", score.per_camera[c].count}});
  }
  json["cameras"] = cameras;
  if (score.camera_imu) json["camera_imu_rmse_px"] = score.camera_imu->rmse_px;
  if (score.gyro_rms_rad_s) json["gyro_rms_rad_s"] = *score.gyro_rms_rad_s;
  if (score.accel_rms_m_s2) json["accel_rms_m_s2"] = *score.accel_rms_m_s2;
  if (score.entropy_nats) {
    json["entropy_nats"] = *score.entropy_nats;
    json["entropy_parameters"] = score.entropy_parameters;
  }
  if (score.camera_imu_entropy_nats) {
    json["camera_imu_entropy_nats"] = *score.camera_imu_entropy_nats;
    json["camera_imu_entropy_parameters"] = score.camera_imu_entropy_parameters;
  }
  return json;
}

Json mapJson(const ImageMap& map) {
  Json json{{"camera", map.camera},
            {"label", map.label},
            {"method", map.method},
            {"range_m", rangeJson(map.range_m)},
            {"columns", map.columns},
            {"rows", map.rows},
            {"image", {map.width, map.height}},
            {"values_px", map.values}};
  if (!map.vectors.empty()) {
    Json vectors = Json::array();
    for (const Eigen::Vector2d& v : map.vectors) vectors.push_back({v.x(), v.y()});
    json["vectors_px"] = vectors;
  }
  if (map.implied) json["implied_T_BA"] = rowsJson(map.implied->matrix());
  return json;
}

template <class T, class ToJson>
Json listJson(const std::vector<T>& values, ToJson to_json) {
  Json list = Json::array();
  for (const T& value : values) list.push_back(to_json(value));
  return list;
}

Json offsetJson(const OffsetSummary& offset) {
  Json json{{"label", offset.label}, {"time_offset_s", optionalJson(offset.time_offset_s)}};
  if (offset.std_s) json["std_s"] = *offset.std_s;
  if (!offset.per_camera_s.empty()) json["per_camera_s"] = offset.per_camera_s;
  return json;
}

Json pairedJson(const PairedPrediction& p) {
  return {{"label", p.label},
          {"camera", p.camera},
          {"views", p.views},
          {"difference_px2", p.difference_px2},
          {"std_px2", p.std_px2}};
}

void addCells(Text& text, const std::vector<std::optional<double>>& values) {
  for (const auto& value : values) add(text, ",{}", value ? fmt::format("{}", *value) : "");
}

}  // namespace

std::string comparisonDocument(const ComparisonRecord& record) {
  const Json document{{"schema", kSchema},
                      {"name", record.name},
                      {"calibrations", calibrationsJson(record)},
                      {"parameters", parametersJson(record)},
                      {"offsets", listJson(record.offsets, offsetJson)},
                      {"scores", listJson(record.scores, scoreJson)},
                      {"paired", listJson(record.paired, pairedJson)},
                      {"differences", listJson(record.differences, mapJson)},
                      {"uncertainties", listJson(record.uncertainties, mapJson)},
                      {"assumptions", assumptionsJson(record.assumptions)},
                      {"verdict", verdictJson(record.verdict)},
                      {"provenance", provenanceJson(record.provenance)}};
  return document.dump(2) + "\n";
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
    add(text, "{},{}", p.name, p.unit);
    addCells(text, p.values);
    addCells(text, p.std);
    addCells(text, p.difference);
    addCells(text, p.significance);
    add(text, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace plumbline

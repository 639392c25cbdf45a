// SPDX-License-Identifier: BSD-3-Clause
// JSON is a subset of YAML (1.2), so one reader serves both and names lines in both.
#include "datasets/calibration/calibration_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/fields/calibration_fields.h"
#include "datasets/calibration/calibration_fields.h"
#include "datasets/calibration/kalibr/camchain.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

using Part = Implausible::Part;

/// Reads a field list (calibrator/fields/fields.h) from a mapping, so that each fault names its
/// line.
class YamlReader {
 public:
  static constexpr bool kReads = true;
  explicit YamlReader(const YamlMap& map) : map_(map) {}

  /// `expected` is the field's unit, or its text where it has none.
  template <class T>
  void operator()(const char* name, T& value, const char* expected, const char* /*text*/ = "") {
    read(name, value, expected);
  }
  template <class T>
  void operator()(const char* name, std::optional<T>& value, const char* expected,
                  const char* /*text*/ = "") {
    value.reset();
    // null means not known, and counts as missing.
    if (map_.has(name)) read(name, value.emplace(), expected);
  }
  template <class T>
  void ifSet(const char* name, T& value, const char* text) {
    if (map_.has(name)) read(name, value, text);
  }

 private:
  void read(const char* name, std::string& value, const char* text) {
    value = map_.text(name, text);
  }
  void read(const char* name, double& value, const char* text) { value = map_.number(name, text); }
  void read(const char* name, std::vector<std::optional<double>>& value, const char* text) {
    value = map_.numbersOrNull(name, text);
  }
  void read(const char* name, Transform& value, const char* /*text*/) {
    value = transformField(map_, name);
  }
  void read(const char* name, Vector6d& value, const char* /*text*/) {
    value = parametersField(map_, name, 6);
  }
  void read(const char* name, Eigen::VectorXd& value, const char* text) {
    const std::vector<double> numbers = map_.numbers(name, text);
    value = Eigen::VectorXd::Map(numbers.data(), std::ssize(numbers));
  }
  void read(const char* name, Resolution& value, const char* /*text*/) {
    value = resolutionField(map_, name);
  }
  template <WordedEnum E>
  void read(const char* name, E& value, const char* text) {
    const std::string word = map_.text(name, text);
    const auto known = enumFrom<E>(word);
    if (!known)
      throw map_.fault(name, {InputFault::kUnknownWord,
                              "unknown " + std::string(name) + " '" + word + "'", text});
    value = *known;
  }
  void read(const char* name, ImuNoise& value, const char* text) {
    YamlReader inner(map_.map(name, text));
    fields(inner, value);
  }

  YamlMap map_;
};

/// What contradicts the cameras before it.
void refuseUnlike(const YamlMap& map, const std::vector<CameraCalibration>& before,
                  const CameraCalibration& camera) {
  if (before.empty() && !boxminus(camera.T_C0Ci, Transform()).isZero(1e-9)) {
    throw map.fault("T_C0Ci",
                    {InputFault::kContradiction, "T_C0Ci of the first camera is not the identity",
                     "the place of each camera in the first one, camera 0", "correct the file"});
  }
  if (std::ranges::find(before, camera.name, &CameraCalibration::name) != before.end()) {
    throw map.fault("name", {InputFault::kDuplicate, "two cameras are named '" + camera.name + "'",
                             "a name for each camera", "rename one of them"});
  }
}

CameraCalibration ourCamera(const YamlMap& map) {
  CameraCalibration camera;
  YamlReader reader(map);
  fields(reader, camera);
  checkParameterCounts(map, camera.intrinsics);
  refuseImplausible(map, implausible(camera),
                    {{Part::kName, "name"},
                     {Part::kPlace, "T_C0Ci"},
                     {Part::kProjection, "intrinsics"},
                     {Part::kDistortion, "distortion_coeffs"}});
  return camera;
}

Calibration readOurs(const YamlMap& file) {
  if (file.integer("schema", "1") != 1) {
    throw file.fault("schema", {InputFault::kUnknownFile, "unknown schema", "1",
                                "use the version that wrote the file"});
  }
  Calibration calibration;
  for (const YamlMap& camera : file.maps("cameras", "a list of cameras")) {
    CameraCalibration read = ourCamera(camera);
    refuseUnlike(camera, calibration.cameras, read);
    calibration.cameras.push_back(std::move(read));
  }
  if (file.has("imu")) {
    const YamlMap map = file.map("imu", "the IMU");
    YamlReader reader(map);
    fields(reader, calibration.imu.emplace());
    refuseImplausible(map, implausible(*calibration.imu),
                      {{Part::kPlace, "T_SC0"},
                       {Part::kOffset, "time_offset_s"},
                       {Part::kGravity, "gravity_m_s2"},
                       {Part::kNoise, "noise"}});
  }
  return calibration;
}

/// Cameras as in Kalibr's file, under other keys than its own.
void refuseOtherKeys(const YamlMap& file) {
  for (const std::string& key : file.keys()) {
    const YAML::Node node = file.node(key);
    if (!node.IsMap() || !node["intrinsics"] || !node["distortion_model"]) continue;
    throw file.fault(
        key, {InputFault::kUnknownFile, "a camera's key is '" + key + "', and there is no 'cam0'",
              "the keys of Kalibr's camchain*.yaml, cam0, cam1, ... in the chain's order",
              "number the cameras from cam0 on; rostopic says which camera each is"});
  }
}

constexpr const char* kKnownCalibrations =
    "a calibration: Kalibr's camchain*.yaml (cam0: ...), Plumbline's calibration.json, a result of "
    "yac, or Basalt's calibration.json";

/// Throws a better error than one of YAML's syntax for the text that Kalibr writes beside its YAML.
YamlMap loadCalibration(const std::string& path) {
  try {
    return YamlMap::load(path, kKnownCalibrations);
  } catch (const InputError&) {
    const auto kind = kalibrFileKind(path);
    const bool results =
        kind == KalibrFileKind::kResultsCameras || kind == KalibrFileKind::kResultsImu;
    if (!results) throw;
    throw badInput(path, 1,
                   {InputFault::kUnknownFile, "this is Kalibr's text of results, which is rounded",
                    "the camchain*.yaml of the same run", "give that file"});
  }
}

/// Who wrote a file, by keys that the tool's files alone have.
enum class Tool { kPlumbline, kKalibr, kYac, kBasalt };

Tool toolOf(const YamlMap& file) {
  // Before Kalibr: a result of yac has a cam0 as well.
  if (isYacResult(file)) return Tool::kYac;
  if (isBasaltCalibration(file)) return Tool::kBasalt;
  return file.has("cam0") ? Tool::kKalibr : Tool::kPlumbline;
}

/// Names and units with a square matrix of as many rows, in one order.
ParameterCovariance covarianceOf(const YamlMap& map) {
  ParameterCovariance out;
  for (const YamlMap& parameter : map.maps("parameters", "a list of names and units")) {
    out.names.push_back(parameter.text("name", "a parameter's name"));
    out.units.push_back(parameter.text("unit", "its unit"));
  }
  const auto n = static_cast<Eigen::Index>(out.names.size());
  const auto matrix = map.matrix("matrix", "rows of numbers", n, n);
  if (!matrix) {
    throw map.fault("matrix",
                    {InputFault::kContradiction, "the covariance does not fit its parameters",
                     fmt::format("{} rows of {} numbers", n, n), "copy the file again"});
  }
  out.matrix = *matrix;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (out.matrix(i, i) >= 0) continue;
    throw map.fault("matrix",
                    {InputFault::kOutOfRange,
                     fmt::format("the variance of '{}' is {:g}",
                                 out.names[static_cast<std::size_t>(i)], out.matrix(i, i)),
                     "0 or more", "copy the file again"});
  }
  return out;
}

// The camera-IMU stage's where it estimated the cameras too, otherwise the camera stage's.
std::optional<ParameterCovariance> camerasCovariance(const YamlMap& file) {
  if (!file.has("covariance")) return std::nullopt;
  const YamlMap stages = file.map("covariance", "the stages' covariances");
  for (const char* stage : {"camera_imu", "camera"}) {
    if (!stages.has(stage)) continue;
    ParameterCovariance covariance = covarianceOf(stages.map(stage, "a covariance"));
    // A focal length among a stage's parameters says that the stage did not hold the cameras.
    const auto is_focal = [](const std::string& name) { return name.ends_with(".fu"); };
    if (std::any_of(covariance.names.begin(), covariance.names.end(), is_focal)) return covariance;
  }
  return std::nullopt;
}

constexpr std::size_t kImuParameters = 7;  // T_SC0 and the time offset, in front

/// Of the first parameters of a stage, `counts` of which there may be; null (not finite) is
/// infinite.
std::vector<double> robustNumbers(const YamlMap& record, const char* key,
                                  const std::set<std::size_t>& counts) {
  std::vector<double> values;
  for (const auto& value : record.numbersOrNull(key, "deviations")) {
    values.push_back(value.value_or(std::numeric_limits<double>::infinity()));
  }
  if (!counts.contains(values.size())) {
    throw record.fault(
        key, {InputFault::kContradiction, "does not fit the stage's parameters",
              fmt::format("{} numbers", fmt::join(counts, " or ")), "copy the file again"});
  }
  if (std::any_of(values.begin(), values.end(), [](double x) { return x < 0; })) {
    throw record.fault(
        key, {InputFault::kOutOfRange, "a number is negative", "0 or more", "copy the file again"});
  }
  return values;
}

/// Over the formal ones of the first parameters. Those of no degree of freedom say nothing.
void addRobust(const YamlMap& record, const std::set<std::size_t>& counts,
               std::vector<StatedDeviation>& stated) {
  const std::vector<double> std = robustNumbers(record, "robust_std", counts);
  std::vector<double> dof(std.size(), std::numeric_limits<double>::infinity());
  if (record.has("robust_dof")) dof = robustNumbers(record, "robust_dof", {std.size()});
  for (std::size_t i = 0; i < std.size(); ++i) {
    if (std::isfinite(std[i]) && std[i] > 0 && dof[i] > 0) stated[i] = {std[i], dof[i]};
  }
}

/// Of one stage: formal ones from its covariance, and robust ones over them.
void addDeviations(const YamlMap& file, const char* stage, StatedDeviations& out) {
  const YamlMap covariances = file.map("covariance", "the stages' covariances");
  if (!covariances.has(stage)) return;
  const ParameterCovariance covariance = covarianceOf(covariances.map(stage, "a covariance"));
  const std::size_t count = covariance.names.size();
  std::vector<StatedDeviation> stated;
  for (const double std : covariance.standardDeviations()) stated.push_back({std});
  const YamlMap stages = file.map("stages", "the calibration's stages");
  if (stages.has(stage)) {
    const YamlMap record = stages.map(stage, "a stage");
    if (record.has("robust_std")) {
      // Through both stages they are not of cameras' own time offsets, which stand behind.
      const bool through_both = std::string_view(stage) == "camera_imu";
      addRobust(record, {through_both ? std::min(count, kImuParameters) : count, count}, stated);
    } else if (record.has("faults") && count >= kImuParameters) {
      // Given cameras: no deviations through both stages, but those of the tests for faults.
      const YamlMap faults = record.map("faults", "tests for faults");
      if (faults.has("robust_std")) addRobust(faults, {kImuParameters}, stated);
    }
  }
  for (std::size_t i = 0; i < count; ++i) out[covariance.names[i]] = stated[i];
}

}  // namespace

CalibrationFile::CalibrationFile(const std::string& path) : map_(loadCalibration(path)) {}

Calibration CalibrationFile::calibration() const {
  const Tool tool = toolOf(map_);
  if (tool == Tool::kYac) return readYacResult(map_);
  if (tool == Tool::kBasalt) return readBasaltCalibration(map_);
  if (tool == Tool::kKalibr) return calibrationOf(kalibrCamchainOf(map_));
  if (map_.has("schema") && map_.has("cameras")) return readOurs(map_);
  refuseOtherKeys(map_);
  throw badInput(
      map_.path(), 1,
      {InputFault::kUnknownFile, "this is not a known calibration format", kKnownCalibrations});
}

bool CalibrationFile::statesImuNoise() const {
  // Kalibr's camchain has none: they are in a file of their own.
  return isYacResult(map_) || isBasaltCalibration(map_) || map_.has("schema");
}

// Of the formats Kalibr's alone may leave the offset out, which is then read as zero.
bool CalibrationFile::statesTimeOffset() const {
  return toolOf(map_) != Tool::kKalibr || kalibrCamchainOf(map_).statesTimeOffset();
}

bool CalibrationFile::statesImuPlacesTwice() const {
  return toolOf(map_) == Tool::kKalibr && kalibrCamchainOf(map_).statesImuPlacesTwice();
}

CalibrationExtras CalibrationFile::extras() const {
  const Tool tool = toolOf(map_);
  if (tool == Tool::kYac) return {"yac"};
  if (tool == Tool::kBasalt) return {.tool = "basalt", .remarks = basaltRemarks(map_)};
  if (tool == Tool::kKalibr) {
    return {map_.map("cam0", "a camera").has("T_imu_cam") ? "openvins" : "kalibr"};
  }
  CalibrationExtras extras{"plumbline", camerasCovariance(map_)};
  if (map_.has("provenance")) {
    const YamlMap provenance = map_.map("provenance", "where the result comes from");
    extras.input = provenance.textOr("input", "");
    extras.input_hash = provenance.textOr("input_hash", "");
    const YAML::Node hashes = provenance.node("camera_hashes");
    for (std::size_t i = 0; hashes && hashes.IsSequence() && i < hashes.size(); ++i) {
      if (hashes[i].IsScalar()) extras.camera_hashes.push_back(hashes[i].Scalar());
    }
  }
  return extras;
}

StatedDeviations CalibrationFile::deviations() const {
  StatedDeviations out;
  const bool ours = toolOf(map_) == Tool::kPlumbline;
  if (!ours || !map_.has("covariance") || !map_.has("stages")) return out;
  // In this order: what both stages estimate the second one has said last.
  addDeviations(map_, "camera", out);
  addDeviations(map_, "camera_imu", out);
  return out;
}

Calibration readCalibration(const std::string& path) { return CalibrationFile(path).calibration(); }

}  // namespace plumbline

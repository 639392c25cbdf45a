// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/camera_models.h"

#include <cassert>
#include <utility>

namespace plumbline {
namespace {

/// A row of the table: the first word is the one we write (Kalibr's), the others are EuRoC's, ROS'
/// and yac's.
template <class Model>
struct ModelRow {
  Model model;
  std::vector<std::string> words;
  std::vector<std::string> parameters;  ///< of a projection: those before fu fv pu pv
};

const std::vector<ModelRow<ProjectionModel>>& rowsOf(ProjectionModel) {
  static const std::vector<ModelRow<ProjectionModel>> rows = {
      {ProjectionModel::kPinhole, {"pinhole"}, {}},
      {ProjectionModel::kOmni, {"omni"}, {"xi"}},
      {ProjectionModel::kEucm, {"eucm"}, {"alpha", "beta"}},
      {ProjectionModel::kDs, {"ds"}, {"xi", "alpha"}}};
  return rows;
}

const std::vector<ModelRow<DistortionModel>>& rowsOf(DistortionModel) {
  static const std::vector<ModelRow<DistortionModel>> rows = {
      {DistortionModel::kRadtan,
       {"radtan", "radial-tangential", "radtan4", "plumb_bob"},
       {"k1", "k2", "p1", "p2"}},
      {DistortionModel::kEquidistant,
       {"equidistant", "equi", "equi4", "kannala_brandt", "kb4"},
       {"k1", "k2", "k3", "k4"}},
      {DistortionModel::kFov, {"fov"}, {"w"}},
      {DistortionModel::kNone, {"none"}, {}}};
  return rows;
}

template <class Model>
const ModelRow<Model>& rowOf(Model model) {
  for (const ModelRow<Model>& row : rowsOf(model)) {
    if (row.model == model) return row;
  }
  assert(false);
  return rowsOf(model).front();
}

template <class Model>
std::optional<Model> modelFrom(const std::string& word) {
  for (const ModelRow<Model>& row : rowsOf(Model())) {
    for (const std::string& known : row.words) {
      if (known == word) return row.model;
    }
  }
  return std::nullopt;
}

template <class Model>
std::string wordsOf() {
  std::string words;
  for (const ModelRow<Model>& row : rowsOf(Model())) {
    words += (words.empty() ? "" : ", ") + row.words.front();
  }
  return words;
}

}  // namespace

std::string toString(ProjectionModel model) { return rowOf(model).words.front(); }
std::string toString(DistortionModel model) { return rowOf(model).words.front(); }
std::optional<ProjectionModel> projectionModelFrom(const std::string& word) {
  return modelFrom<ProjectionModel>(word);
}
std::optional<DistortionModel> distortionModelFrom(const std::string& word) {
  return modelFrom<DistortionModel>(word);
}
std::string projectionModelWords() { return wordsOf<ProjectionModel>(); }
std::string distortionModelWords() { return wordsOf<DistortionModel>(); }

std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion) {
  std::vector<ParameterName> names;
  for (const std::string& name : rowOf(projection).parameters) names.push_back({name, "-"});
  for (const char* name : {"fu", "fv", "pu", "pv"}) names.push_back({name, "px"});
  for (const std::string& name : rowOf(distortion).parameters) names.push_back({name, "-"});
  return names;
}

std::size_t parameterCount(ProjectionModel model) { return 4 + rowOf(model).parameters.size(); }
std::size_t parameterCount(DistortionModel model) { return rowOf(model).parameters.size(); }

std::string calibratedModelWords() {
  std::string words;
  for (const auto& projection : rowsOf(ProjectionModel())) {
    for (const auto& distortion : rowsOf(DistortionModel())) {
      if (!canBeCalibrated(projection.model, distortion.model)) continue;
      words +=
          (words.empty() ? "" : " or ") + projection.words.front() + "-" + distortion.words.front();
    }
  }
  return words;
}

std::string unsupportedModelText(const std::string& projection, const std::string& distortion) {
  return "calibrating the camera model " + projection + "-" + distortion +
         " is not supported yet; expected " + calibratedModelWords() +
         "; choose one of them, pinhole-equidistant for wide-angle lenses";
}

std::vector<ParameterName> transformParameters(const std::string& name) {
  std::vector<ParameterName> names;
  for (const char* part : {".tx", ".ty", ".tz"}) names.push_back({name + part, "m"});
  for (const char* part : {".rx", ".ry", ".rz"}) names.push_back({name + part, "rad"});
  return names;
}

std::vector<ParameterName> cameraParameters(const std::vector<CameraCalibration>& cameras) {
  std::vector<ParameterName> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const CameraCalibration& camera = cameras[c];
    const std::string name = camera.name.empty() ? "cam" + std::to_string(c) : camera.name;
    const Intrinsics& k = camera.intrinsics;
    for (ParameterName& p : intrinsicParameters(k.projection_model, k.distortion_model)) {
      all.push_back({name + "." + p.name, std::move(p.unit)});
    }
  }
  for (std::size_t c = 1; c < cameras.size(); ++c) {
    for (ParameterName& p : transformParameters("T_C0C" + std::to_string(c))) {
      all.push_back(std::move(p));
    }
  }
  return all;
}

ParameterCovariance parameterCovariance(const std::vector<ParameterName>& parameters,
                                        const Eigen::MatrixXd& matrix) {
  ParameterCovariance out;
  for (const ParameterName& p : parameters) {
    out.names.push_back(p.name);
    out.units.push_back(p.unit);
  }
  out.matrix = matrix;
  return out;
}

}  // namespace plumbline

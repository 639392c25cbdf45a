// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/camera_models.h"

#include <algorithm>

namespace plumbline {
namespace {

/// What the table has of a model beside its word.
struct ModelRow {
  std::vector<std::string> others_words;  ///< EuRoC's, ROS' and yac's
  std::vector<std::string> parameters;    ///< of a projection: those before fu fv pu pv
};

// The rows in the order of the enumerations.
const ModelRow& rowOf(ProjectionModel model) {
  static const std::array<ModelRow, 4> rows = {
      {{{}, {}}, {{}, {"xi"}}, {{}, {"alpha", "beta"}}, {{}, {"xi", "alpha"}}}};
  return rows[static_cast<std::size_t>(model)];
}
const ModelRow& rowOf(DistortionModel model) {
  static const std::array<ModelRow, 5> rows = {
      {{{}, {}},
       {{"radial-tangential", "radtan4", "plumb_bob"}, {"k1", "k2", "p1", "p2"}},
       {{"equi", "equi4", "kannala_brandt", "kb4"}, {"k1", "k2", "k3", "k4"}},
       {{}, {"w"}},
       {{"rational_polynomial", "radtan8", "radialtangential8"},
        {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}}}};
  return rows[static_cast<std::size_t>(model)];
}

template <class Model>
std::optional<Model> modelFrom(const std::string& word) {
  for (std::size_t i = 0; i < enumWords(Model()).size(); ++i) {
    const auto model = static_cast<Model>(i);
    // Others' words first: enumFrom() knows the model's own word alone.
    const auto& others = rowOf(model).others_words;
    if (std::find(others.begin(), others.end(), word) != others.end()) return model;
  }
  return enumFrom<Model>(word);
}

}  // namespace

std::optional<ProjectionModel> projectionModelFrom(const std::string& word) {
  return modelFrom<ProjectionModel>(word);
}
std::optional<DistortionModel> distortionModelFrom(const std::string& word) {
  return modelFrom<DistortionModel>(word);
}

std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion) {
  std::vector<ParameterName> names;
  for (const std::string& name : rowOf(projection).parameters) names.push_back({name, "-"});
  for (const char* name : {"fu", "fv", "pu", "pv"}) names.push_back({name, "px"});
  for (const std::string& name : rowOf(distortion).parameters) names.push_back({name, "-"});
  return names;
}

// 4: fu, fv, pu, pv, which every projection has.
std::size_t parameterCount(ProjectionModel model) { return 4 + rowOf(model).parameters.size(); }
std::size_t parameterCount(DistortionModel model) { return rowOf(model).parameters.size(); }

std::string calibratedModelWords() {
  std::vector<std::string> words;
  for (std::size_t p = 0; p < enumWords(ProjectionModel()).size(); ++p) {
    for (std::size_t d = 0; d < enumWords(DistortionModel()).size(); ++d) {
      const auto projection = static_cast<ProjectionModel>(p);
      const auto distortion = static_cast<DistortionModel>(d);
      if (!canBeCalibrated(projection, distortion)) continue;
      words.push_back(toString(projection) + "-" + toString(distortion));
    }
  }
  std::string text = words.front();
  for (std::size_t i = 1; i < words.size(); ++i) {
    text += (i + 1 < words.size() ? ", " : " or ") + words[i];
  }
  return text;
}

std::string unsupportedModelText(const std::string& projection, const std::string& distortion) {
  return "calibrating the camera model " + projection + "-" + distortion +
         " is not supported yet; expected " + calibratedModelWords() +
         "; choose one of them, pinhole-equidistant for wide-angle lenses";
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/calibration.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace plumbline {
Eigen::VectorXd Intrinsics::stacked() const {
  Eigen::VectorXd all(projection.size() + distortion.size());
  all << projection, distortion;
  return all;
}

void Intrinsics::setStacked(const Eigen::VectorXd& parameters) {
  assert(parameters.size() == projection.size() + distortion.size());
  projection = parameters.head(projection.size()).eval();
  distortion = parameters.tail(distortion.size()).eval();
}

bool haveOwnOffsets(const TimeOffsets& offsets) {
  // Camera 0 has an offset in any case, so that its flag says nothing.
  for (std::size_t c = 1; c < offsets.size(); ++c) {
    if (offsets[c].estimated) return true;
  }
  return false;
}

TimeOffsets selected(const TimeOffsets& offsets, const std::vector<std::size_t>& cameras) {
  TimeOffsets out;
  for (const std::size_t c : cameras) {
    // Beside a camera 0 with an offset of its own nobody is synchronised.
    const bool own = hasOwnOffset(offsets, c) || hasOwnOffset(offsets, cameras.front());
    out.push_back({offsetOf(offsets, c), own});
  }
  return out;
}

// With this the one offset of a tool that knows no other is compared.
double meanTimeOffset(const ImuCalibration& imu) {
  if (!haveOwnOffsets(imu.time_offsets)) return imu.timeOffset();
  double sum = 0;
  for (std::size_t c = 0; c < imu.time_offsets.size(); ++c) sum += imu.timeOffset(c);
  return sum / static_cast<double>(imu.time_offsets.size());
}

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

std::vector<ParameterName> transformParameters(const std::string& name) {
  std::vector<ParameterName> names;
  for (const char* part : {".tx", ".ty", ".tz"}) names.push_back({name + part, "m"});
  for (const char* part : {".rx", ".ry", ".rz"}) names.push_back({name + part, "rad"});
  return names;
}

std::string parameterOwner(const std::vector<CameraCalibration>& cameras, std::size_t c) {
  return cameras[c].name.empty() ? "cam" + std::to_string(c) : cameras[c].name;
}

std::vector<ParameterName> cameraParameters(const std::vector<CameraCalibration>& cameras) {
  // In the order of CameraLayout: what covariances name, they have in its columns.
  std::vector<ParameterName> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const CameraCalibration& camera = cameras[c];
    const std::string name = parameterOwner(cameras, c);
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

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/parameter_names.h"

#include <utility>

namespace plumbline {
namespace {

std::vector<std::string> shapeNames(ProjectionModel model) {
  switch (model) {
    case ProjectionModel::kPinhole:
      return {};
    case ProjectionModel::kOmni:
      return {"xi"};
    case ProjectionModel::kEucm:
      return {"alpha", "beta"};
    case ProjectionModel::kDs:
      return {"xi", "alpha"};
  }
  return {};
}

std::vector<std::string> distortionNames(DistortionModel model) {
  switch (model) {
    case DistortionModel::kNone:
      return {};
    case DistortionModel::kRadtan:
      return {"k1", "k2", "p1", "p2"};
    case DistortionModel::kEquidistant:
      return {"k1", "k2", "k3", "k4"};
    case DistortionModel::kFov:
      return {"w"};
  }
  return {};
}

}  // namespace

std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion) {
  std::vector<ParameterName> names;
  for (const std::string& name : shapeNames(projection)) names.push_back({name, "-"});
  for (const char* name : {"fu", "fv", "pu", "pv"}) names.push_back({name, "px"});
  for (const std::string& name : distortionNames(distortion)) names.push_back({name, "-"});
  return names;
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

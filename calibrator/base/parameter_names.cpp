// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/parameter_names.h"

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

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/parameter_names.h"

#include <utility>

namespace plumbline {

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

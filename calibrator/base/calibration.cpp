// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/calibration.h"

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

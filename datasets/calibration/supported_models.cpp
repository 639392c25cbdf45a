// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/supported_models.h"

namespace plumbline {

bool isSupportedModel(ProjectionModel projection, DistortionModel distortion) {
  return projection == ProjectionModel::kPinhole &&
         (distortion == DistortionModel::kRadtan || distortion == DistortionModel::kEquidistant);
}

std::string unsupportedModelText(const std::string& projection, const std::string& distortion) {
  return "calibrating the camera model " + projection + "-" + distortion +
         " is not supported yet; expected pinhole-radtan or pinhole-equidistant; choose one of "
         "them (--models), pinhole-equidistant for wide-angle lenses";
}

}  // namespace plumbline

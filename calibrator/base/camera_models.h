// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/enum_words.h"

namespace plumbline {

// What is known of the camera models by name: other tools' words, the names and numbers of their
// parameters, and which can be calibrated. All of it stands in one table (camera_models.cpp); the
// mathematics are in calibrator/camera.

/// Projection of a point in the camera frame to normalised coordinates, in Kalibr's words.
enum class ProjectionModel { kPinhole, kOmni, kEucm, kDs };
constexpr std::array<const char*, 4> enumWords(ProjectionModel /*of*/) {
  return {"pinhole", "omni", "eucm", "ds"};
}
/// Distortion of normalised coordinates, in Kalibr's words; kRational is OpenCV's of eight
/// coefficients, which Kalibr does not have.
enum class DistortionModel { kNone, kRadtan, kEquidistant, kFov, kRational };
constexpr std::array<const char*, 5> enumWords(DistortionModel /*of*/) {
  return {"none", "radtan", "equidistant", "fov", "rational"};
}

/// The inverse of toString(); also accepts the words other tools use (EuRoC's "radial-tangential",
/// ROS' "plumb_bob", yac's "radtan4", "equi", "kannala_brandt"). Empty for an unknown word.
std::optional<ProjectionModel> projectionModelFrom(const std::string& word);
std::optional<DistortionModel> distortionModelFrom(const std::string& word);

struct ParameterName {
  std::string name;
  std::string unit;  ///< "px", "-", "m" or "rad"
};

/// Names of Intrinsics::stacked(), in its order, as Kalibr's documents call them: xi, alpha, beta
/// before fu fv pu pv, then k1 ... p2, k1 ... k4, w, or k1 k2 p1 p2 k3 ... k6.
std::vector<ParameterName> intrinsicParameters(ProjectionModel projection,
                                               DistortionModel distortion);

/// Length of Intrinsics::projection and of Intrinsics::distortion.
std::size_t parameterCount(ProjectionModel model);
std::size_t parameterCount(DistortionModel model);

/// Whether cameras of this kind can be calibrated; the others project, and are scored and compared.
constexpr bool canBeCalibrated(ProjectionModel projection, DistortionModel distortion) {
  switch (projection) {
    case ProjectionModel::kPinhole:
      return true;
    case ProjectionModel::kOmni:
      return distortion == DistortionModel::kNone || distortion == DistortionModel::kRadtan;
    case ProjectionModel::kEucm:
    case ProjectionModel::kDs:
      return distortion == DistortionModel::kNone;
  }
  return false;
}
/// Whether a model has p1 and p2, for a lens that is decentred.
constexpr bool hasTangentialTerms(DistortionModel distortion) {
  return distortion == DistortionModel::kRadtan || distortion == DistortionModel::kRational;
}
/// "pinhole-none, pinhole-radtan, ... or ds-none".
std::string calibratedModelWords();

/// "calibrating the camera model omni-fov is not supported yet; expected ...": the text with
/// which every reader refuses another model.
std::string unsupportedModelText(const std::string& projection, const std::string& distortion);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/camera/camera_dispatch.h"

#include <optional>
#include <string>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

template <class Visit, CameraModel... Models>
void visitMembers(const std::variant<Models...>*, const Visit& visit) {
  (visit(Models{}), ...);
}

// Calls visit(Model{}) for every model, so that AnyCameraModel is the one list of them.
template <class Visit>
void forEachModel(const Visit& visit) {
  visitMembers(static_cast<const AnyCameraModel*>(nullptr), visit);
}

std::optional<AnyCameraModel> find(ProjectionModel projection, DistortionModel distortion) {
  std::optional<AnyCameraModel> found;
  forEachModel([&]<class Model>(Model model) {
    if (Model::kProjection == projection && Model::kDistortion == distortion) found = model;
  });
  return found;
}

std::string nameOf(ProjectionModel projection, DistortionModel distortion) {
  return toString(projection) + "-" + toString(distortion);
}

std::string supportedNames() {
  std::string names;
  forEachModel([&]<class Model>(Model) {
    names += (names.empty() ? "" : ", ") + nameOf(Model::kProjection, Model::kDistortion);
  });
  return names;
}

/// How many parameters stand in Intrinsics::projection and distortion.
struct Sizes {
  int projection, distortion;
};
Sizes sizesOf(const AnyCameraModel& model) {
  return std::visit(
      []<class Model>(Model) {
        return Sizes{4 + Model::kLeading, Model::kShape - Model::kLeading};
      },
      model);
}

}  // namespace

AnyCameraModel cameraModelOf(const Intrinsics& camera) {
  const auto model = find(camera.projection_model, camera.distortion_model);
  if (!model) {
    throw InputError("camera model '" + nameOf(camera.projection_model, camera.distortion_model) +
                     "' is not supported; supported are: " + supportedNames() +
                     "; recalibrate the camera with one of them");
  }
  const Sizes sizes = sizesOf(*model);
  if (camera.projection.size() != sizes.projection ||
      camera.distortion.size() != sizes.distortion) {
    throw InputError("camera model '" + nameOf(camera.projection_model, camera.distortion_model) +
                     "' needs " + std::to_string(sizes.projection) + " projection and " +
                     std::to_string(sizes.distortion) + " distortion parameters, but " +
                     std::to_string(camera.projection.size()) + " and " +
                     std::to_string(camera.distortion.size()) +
                     " were given; give the projection's own, then fu fv pu pv, and the "
                     "distortion's coefficients");
  }
  return *model;
}

}  // namespace plumbline

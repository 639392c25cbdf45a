// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/files/bad_input.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

// A file keyed by position (Kalibr's) may hold another camera under this name: their topics tell.
void checkTopic(const CameraCalibration& given, const CameraStream& stream,
                const std::string& path) {
  const std::string& said = given.rostopic;
  const std::string expected =
      stream.rostopic.empty() ? "/" + stream.name + "/image_raw" : stream.rostopic;
  // "/camN/image_raw" is a place in a list, as kalibrCamchainText() writes it: it is compared even
  // where the session states no topic. Others name devices, which such a session cannot contradict.
  const bool generic = said.rfind("/cam", 0) == 0 && said.ends_with("/image_raw");
  if (said.empty() || said == expected || (stream.rostopic.empty() && !generic)) return;
  throw InputError(path, 0,
                   fmt::format("{} is the calibration of topic {}, but the session's {} is {}; "
                               "give the cameras in the file the names of the session",
                               stream.name, said, stream.name, expected));
}

void checkCamera(const Calibration& given, const std::string& path, const CameraStream& stream) {
  const auto found =
      std::find_if(given.cameras.begin(), given.cameras.end(),
                   [&](const CameraCalibration& camera) { return camera.name == stream.name; });
  if (found == given.cameras.end()) {
    throw InputError(path, 0, fmt::format("has no {}, which the session has", stream.name));
  }
  const Resolution& size = found->intrinsics.resolution;
  if (!(size == stream.resolution)) {
    throw InputError(
        path, 0,
        fmt::format("{} is for {}x{} pixels, the session's images have {}x{}", stream.name,
                    size.width, size.height, stream.resolution.width, stream.resolution.height));
  }
  checkTopic(*found, stream, path);
}

}  // namespace

std::vector<CameraCalibration> matchCameras(const Calibration& given, const std::string& path,
                                            const Session& session) {
  return matchCalibration(given, path, session).cameras;
}

Calibration matchCalibration(const Calibration& given, const std::string& path,
                             const Session& session) {
  std::vector<std::string> names;
  for (const CameraStream& stream : session.cameras) {
    checkCamera(given, path, stream);
    names.push_back(stream.name);
  }
  // Camera 0 of the session is the reference, also where --only left the file's first camera out.
  return names.empty() ? Calibration{{}, given.imu} : selectCameras(given, names, path);
}

void refuseUnsupportedModels(const std::vector<CameraCalibration>& cameras,
                             const std::string& path) {
  for (const CameraCalibration& camera : cameras) {
    const Intrinsics& k = camera.intrinsics;
    if (canBeCalibrated(k.projection_model, k.distortion_model)) continue;
    throw BadInput(InputFault::kUnsupportedModel, path, 0,
                   fmt::format("{}: {}", camera.name,
                               unsupportedModelText(toString(k.projection_model),
                                                    toString(k.distortion_model))));
  }
}

}  // namespace plumbline

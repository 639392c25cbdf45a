// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
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

const CameraCalibration& cameraOf(const Calibration& given, const std::string& path,
                                  const CameraStream& stream) {
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
  return *found;
}

}  // namespace

std::vector<CameraCalibration> matchCameras(const Calibration& given, const std::string& path,
                                            const Session& session) {
  std::vector<CameraCalibration> cameras;
  for (const CameraStream& stream : session.cameras) {
    cameras.push_back(cameraOf(given, path, stream));
  }
  if (cameras.empty()) return cameras;
  // Camera 0 of the session is the reference, also where --only left the file's first camera out.
  const Transform T_0 = cameras.front().T_C0Ci.inverse();
  for (CameraCalibration& camera : cameras) camera.T_C0Ci = T_0 * camera.T_C0Ci;
  return cameras;
}

Calibration matchCalibration(const Calibration& given, const std::string& path,
                             const Session& session) {
  Calibration matched{matchCameras(given, path, session), given.imu};
  if (!matched.imu || matched.cameras.empty()) return matched;
  ImuCalibration& imu = *matched.imu;
  std::vector<std::size_t> cameras;
  for (const CameraStream& stream : session.cameras) {
    const auto index =
        static_cast<std::size_t>(&cameraOf(given, path, stream) - given.cameras.data());
    cameras.push_back(index);
    // Only the session's first camera moves the reference, and only where it is not the file's
    // first.
    if (cameras.size() > 1 || index == 0) continue;
    // T_SC0' = T_SC0 T_C0Ci, with the session's first camera Ci as the new camera 0.
    imu.T_SC0 = given.imu->T_SC0 * given.cameras[index].T_C0Ci;
    imu.T_SC0_std.reset();  // was of another camera
  }
  imu.time_offsets = selected(given.imu->time_offsets, cameras);
  return matched;
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

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/supported_models.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/camera_stream_reader.h"

namespace plumbline {
namespace {

constexpr const char* kSensorKeys = "resolution: [width, height], camera_model, distortion_model";

Resolution resolutionOf(const YamlMap& file) {
  const std::string expected = "resolution: [width, height] in pixels, e.g. [752, 480]";
  const std::vector<double> size = file.numbers("resolution", expected);
  const auto pixels = [](double v) { return v >= 1 && v <= 100000 && v == std::floor(v); };
  if (size.size() != 2 || !pixels(size[0]) || !pixels(size[1])) {
    throw file.fault("resolution", {"the resolution is not two positive integers", expected,
                                    "correct the value"});
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

std::string cameraModel(const YamlMap& file) {
  const std::string word = file.textOr("camera_model", "");
  if (word.empty()) return "";
  const auto model = projectionModelFrom(word);
  if (model) return toString(*model);
  throw file.fault("camera_model", {"the camera model '" + word + "' is not known",
                                    "camera_model: pinhole", "correct the value or delete it"});
}

std::string distortionModel(const YamlMap& file) {
  const std::string word = file.textOr("distortion_model", "");
  if (word.empty()) return "";
  const auto model = distortionModelFrom(word);
  if (model) return toString(*model);
  throw file.fault("distortion_model",
                   {"the distortion model '" + word + "' is not known",
                    "distortion_model: radtan (radial-tangential) or equidistant",
                    "correct the value or delete it"});
}

void refuseUnsupported(const YamlMap& file, const CameraDescription& camera) {
  if (camera.camera_model.empty() || camera.distortion_model.empty()) return;
  const auto projection = *projectionModelFrom(camera.camera_model);
  const auto distortion = *distortionModelFrom(camera.distortion_model);
  if (isSupportedModel(projection, distortion)) return;
  throw InputError(file.path(), file.lineOf("camera_model"),
                   unsupportedModelText(camera.camera_model, camera.distortion_model));
}

}  // namespace

CameraDescription readCameraDescription(const std::string& path, bool supported_models_only) {
  const YamlMap file = YamlMap::load(path, kSensorKeys);
  if (file.numberOr("line_delay", 0) != 0) {
    throw file.fault("line_delay",
                     {"rolling shutter (line_delay other than 0) is not supported yet",
                      "a global shutter, line_delay: 0", "record with a global-shutter camera"});
  }
  CameraDescription camera;
  if (file.has("resolution")) camera.resolution = resolutionOf(file);
  camera.camera_model = cameraModel(file);
  camera.distortion_model = distortionModel(file);
  camera.rostopic = file.textOr("rostopic", "");
  if (supported_models_only) refuseUnsupported(file, camera);
  return camera;
}

}  // namespace plumbline

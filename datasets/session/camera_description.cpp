// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/camera_description.h"

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_fields.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

constexpr const char* kSensorKeys = "resolution: [width, height], camera_model, distortion_model";

/// The model of `key` in Kalibr's word, whichever tool's it is; `noun` is what messages call it.
template <class Model>
std::string modelWord(const YamlMap& file, const std::string& key, const std::string& noun,
                      std::optional<Model> (*modelFrom)(const std::string&),
                      const std::string& expected) {
  const std::string word = file.textOr(key, "");
  if (word.empty()) return "";
  if (const auto model = modelFrom(word)) return toString(*model);
  throw file.fault(key,
                   {InputFault::kUnknownWord, "the " + noun + " model '" + word + "' is not known",
                    key + ": " + expected, "correct the value or delete it"});
}

void refuseUnsupported(const YamlMap& file, const CameraDescription& camera) {
  if (camera.camera_model.empty() || camera.distortion_model.empty()) return;
  // Our own words by now: others were refused or translated.
  const auto projection = *projectionModelFrom(camera.camera_model);
  const auto distortion = *distortionModelFrom(camera.distortion_model);
  if (canBeCalibrated(projection, distortion)) return;
  throw BadInput(InputFault::kUnsupportedModel, file.path(), file.lineOf("camera_model"),
                 unsupportedModelText(camera.camera_model, camera.distortion_model));
}

}  // namespace

CameraDescription readCameraDescription(const std::string& path, bool supported_models_only) {
  const YamlMap file = YamlMap::load(path, kSensorKeys);
  // A rolling shutter stamps one row of an image; every other row would be taken for as old.
  if (file.numberOr("line_delay", 0) != 0) {
    throw file.fault(
        "line_delay",
        {InputFault::kUnsupported, "rolling shutter (line_delay other than 0) is not supported yet",
         "a global shutter, line_delay: 0", "record with a global-shutter camera"});
  }
  if (file.isTrue("rolling_shutter")) {
    throw file.fault(
        "rolling_shutter",
        {InputFault::kUnsupported, "rolling shutter is not supported yet",
         "a global shutter, rolling_shutter: false", "record with a global-shutter camera"});
  }
  CameraDescription camera;
  if (file.has("resolution")) camera.resolution = resolutionField(file, "resolution");
  camera.camera_model = modelWord(file, "camera_model", "camera", projectionModelFrom, "pinhole");
  camera.distortion_model = modelWord(file, "distortion_model", "distortion", distortionModelFrom,
                                      "radtan (radial-tangential) or equidistant");
  camera.rostopic = file.textOr("rostopic", "");
  if (supported_models_only) refuseUnsupported(file, camera);
  return camera;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibrator/base/session.h"

namespace plumbline {

/// What a camera's sensor.yaml says; in Kalibr's words, empty where it does not.
struct CameraDescription {
  std::optional<Resolution> resolution;
  std::string camera_model;
  std::string distortion_model;
  std::string rostopic;
};

/// Reads camN/sensor.yaml (EuRoC's, or a minimal one). Throws InputError for a rolling shutter
/// (line_delay other than 0), an unknown model word, and sizes that are not positive.
/// `supported_models_only`: also throws for models that cannot be calibrated yet.
CameraDescription readCameraDescription(const std::string& path, bool supported_models_only);

}  // namespace plumbline

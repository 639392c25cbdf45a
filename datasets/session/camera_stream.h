// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"

namespace plumbline {

/// An image of a recording and its stamp.
struct ImageFile {
  TimeNs t = 0;
  std::string path;
};

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

/// What a row of corners.csv must respect.
struct CornerLimits {
  int corner_count = 0;  ///< of the target: ids are below it
  Resolution resolution;
  bool may_be_empty = false;  ///< no rows are no fault: the camera saw no target
  bool of_tracks = false;     ///< of tracks.csv: ids are those of tracks, and of no target
};

/// Reads corners.csv: `#timestamp [ns],corner_id,u [px],v [px]`, the rows of a frame together and
/// frames ascending in time. Throws InputError for a row that is cut or not numbers, an id twice in
/// a view or outside the target, a corner outside the image, stamps out of order or in another
/// unit. tracks.csv has the same columns, with a track_id.
std::vector<ImageView> readCorners(const std::string& path, const CornerLimits& limits);

/// Reads the stamps (and file names, where there are any) of camN/data.csv:
/// `#timestamp [ns],filename`. The paths are those of `folder`/data/<filename>; empty without one.
std::vector<ImageFile> readFrameList(const std::string& folder);

/// The images of camN: as data.csv lists them (each must exist), or without it all of camN/data
/// named <ns>.png, .jpg or .jpeg. Ascending in time.
std::vector<ImageFile> listImages(const std::string& folder);

}  // namespace plumbline

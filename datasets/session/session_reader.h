// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/session.h"
#include "datasets/session/image_list.h"

namespace plumbline {

struct SessionReadOptions {
  std::optional<std::string> target_path;  ///< in place of target.yaml in the session's folder
  std::optional<std::string> imu_path;     ///< in place of imu.yaml in the session's folder
  std::optional<Resolution> resolution;    ///< of every camera whose sensor.yaml does not say
  bool read_imu = true;                    ///< false: as if there were no imu0
  /// Whether the models that sensor.yaml states must be ones that can be calibrated; false where
  /// the models come from elsewhere (an option, a camchain).
  bool supported_models_only = true;
  double from_s = 0;  ///< leave out frames earlier than this after the session's first frame [s]
  double to_s = std::numeric_limits<double>::infinity();  ///< and those later than this [s]
  int stride = 1;           ///< keep every n-th frame; a frame's cameras stay together
  double imu_margin_s = 2;  ///< IMU samples kept before from_s and after to_s [s]
  /// Views of different cameras at most this far apart [ns] are one frame to from_s, to_s, stride.
  TimeNs sync_tolerance = FrameOptions().tolerance;

  /// Throws InputError for a value out of its range.
  void check() const;
};

/// A recording as its folder holds it.
struct Recording {
  Session session;
  /// Of each camera that comes as images, parallel to its views, which have no corners yet; empty
  /// for a camera that comes as corners. Its resolution is 0x0 where neither sensor.yaml nor the
  /// options say: the images do.
  std::vector<std::vector<ImageFile>> images;
  std::string target_path;       ///< target.yaml as it was found
  std::string imu_samples_path;  ///< empty where there is no IMU

  bool needsDetection() const;
};

/// Reads a EuRoC ASL folder, with or without the mav0/ level:
///   camN/corners.csv [camN/data.csv] or camN/{data.csv,data/<ns>.png}, camN/sensor.yaml;
///   imu0/data.csv with imu.yaml (Kalibr's) or imu0/sensor.yaml; target.yaml.
/// target.yaml and imu.yaml are looked for in `path`, in its mav0/, and beside it if `path` itself
/// is mav0. Cameras are in numeric order. Frames that data.csv lists and corners.csv does not are
/// views without corners. Throws InputError for whatever is missing or malformed.
Recording readRecording(const std::string& path, const SessionReadOptions& options = {});

/// The session of a recording that comes as corners; InputError where it comes as images.
Session readSession(const std::string& path, const SessionReadOptions& options = {});

/// Keeps the frames that the options ask for (from_s, to_s, stride) and the IMU samples around
/// them. Throws InputError for options out of range or where nothing would be left.
void selectFrames(Recording& recording, const SessionReadOptions& options);

/// "xxh64:<16 digits>" over the files that readRecording() reads: name (below the session) and
/// bytes of every CSV and YAML file; of images the name and the size, because reading them all
/// would cost more than the calibration. Does not depend on where the session lies, nor on the
/// order in which files are listed. `options` say which target and IMU files are read; `others` are
/// files beside the session (a calibration that is given), in their order and without their names.
std::string inputHash(const std::string& session, const SessionReadOptions& options = {},
                      const std::vector<std::string>& others = {});

/// The same over what each camera recorded alone, without names of folders, target, lens, IMU and
/// options: sessions that have one in common are of one recording. A camera without corners and
/// images has none.
std::vector<std::string> cameraHashes(const std::string& session);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/odometry/rig_model.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/streams.h"

namespace plumbline {

/// Largest difference of the stamps of one frame's images [ns].
inline constexpr TimeNs kSameFrame = 2'000'000;

/// What stands in place of images.
enum class PointSource {
  kImages,   ///< nothing: there are images
  kCorners,  ///< camN/corners.csv: corners of a calibration board
  kTracks,   ///< camN/tracks.csv: points of a scene, followed through the frames
};

/// A sequence folder as an odometry uses it.
struct OdometrySequence {
  std::string name;
  std::filesystem::path root;                  ///< holds camN and imu0
  std::vector<std::vector<ImageFile>> images;  ///< of each camera, ascending; files may be missing
  PointSource points = PointSource::kImages;   ///< what it comes with in place of images
  /// Of those all that the cameras saw; the images then are stamps without a file.
  std::vector<FrameTracks> tracks;
  std::vector<ImuSample> samples;
  std::optional<ImuNoise> noise;               ///< as its IMU's YAML states it
  std::optional<std::filesystem::path> truth;  ///< found beside the sensors

  /// Of camera 0, first to last [s].
  double duration_s() const;
};

/// Reads the lists and the IMU of a EuRoC ASL folder (TUM-VI's has the same layout), not the
/// images; or points in their place. Its truth is the first of
/// state_groundtruth_estimate0, vicon0, mocap0 and leica0, or truth/trajectory.csv of a simulated
/// one. Throws InputError where a part is missing or malformed, where there are no images, and
/// where fewer than half of camera 0's frames have a partner within 2 ms in another camera: cameras
/// out of step.
OdometrySequence readOdometrySequence(const std::string& path);

/// The image of a camera at a stamp, within 2 ms; null where it has none.
const ImageFile* imageAt(const std::vector<ImageFile>& images, TimeNs t);

}  // namespace plumbline

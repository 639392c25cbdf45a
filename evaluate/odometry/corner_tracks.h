// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/odometry/tracks.h"
#include "datasets/session/session_folder.h"

namespace plumbline {

/// Largest difference of the stamps of one frame's images [ns].
inline constexpr TimeNs kSameFrame = 2'000'000;

/// What stands in place of images.
enum class PointSource {
  kImages,   ///< nothing: there are images
  kCorners,  ///< camN/corners.csv: corners of a calibration board
  kTracks,   ///< camN/tracks.csv: points of a scene, followed through the frames
};

/// By what every camera's folder holds; tracks and corners count where no folder data/ is beside
/// them.
PointSource pointSourceOf(const SessionFolder& folder);

/// The points as tracks: those of every camera [px] merged at the stamps of camera 0, views of
/// other cameras within 2 ms. Of a board, a track is a corner under its number, and the numbers
/// that it may have are those of the target.yaml beside the sequence; the image's size is that of
/// each sensor.yaml. Throws InputError where one of them is missing or malformed.
std::vector<FrameTracks> readPointTracks(const SessionFolder& folder, PointSource source);

}  // namespace plumbline

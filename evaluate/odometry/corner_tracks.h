// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/odometry/tracks.h"
#include "datasets/session/session_folder.h"

namespace plumbline {

/// Whether a sequence comes with corners of a calibration board in place of images: corners.csv and
/// no folder data/ in every camera's folder.
bool hasCornersAlone(const SessionFolder& folder);

/// The board as a scene: corners.csv of every camera [px] merged at the stamps of camera 0, views
/// of other cameras within 2 ms; a track is a corner, under its number on the board. The numbers
/// that it may have are those of the target.yaml beside the sequence, the image's size that of each
/// sensor.yaml. Throws InputError where one of them is missing or malformed.
std::vector<FrameTracks> readCornerTracks(const SessionFolder& folder);

}  // namespace plumbline

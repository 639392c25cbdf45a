// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "report/records/replay_record.h"

namespace plumbline::html_internal {

/// What the player's scripts read (report/html/player/replay_data.js is the other side).
struct ReplayData {
  std::string json;    ///< decisions, corners, rounds, suggestions, events; '<' escaped
  std::string images;  ///< base64 JPEGs, a line per image, cameras innermost
  int frames_with_images = 0;
  int image_step = 1;  ///< every so many-th of them is in the page
};

/// Corners in quarter pixels (int16), decisions as doubles, poses as floats, all in base64. Poses
/// of candidates are rounded to a millimetre and 1/32767, equal ones stand once. Images take up to
/// `image_bytes`, less where the rest leaves no more of `bytes` for both.
ReplayData replayData(const ReplayRecord& record, std::size_t image_bytes, std::size_t bytes);

/// Frames of the replay: those recorded, and any that a decision names beyond them.
std::size_t frameCount(const ReplayRecord& record);

}  // namespace plumbline::html_internal

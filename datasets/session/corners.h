// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/session.h"

namespace plumbline {

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

}  // namespace plumbline

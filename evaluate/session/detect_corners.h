// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calibrator/base/session.h"
#include "calibrator/target/detector.h"
#include "datasets/session/session_reader.h"
#include "evaluate/results/progress.h"

namespace plumbline {

struct DetectRequest {
  DetectorOptions detector;
  std::optional<std::string> cache;  ///< folder of found corners; empty: none is kept
  int threads = 0;                   ///< 0: all cores
};

/// Finds the corners of every image of the recording and fills them into its views; a camera
/// without stated resolution takes that of its first image. The result does not depend on the
/// threads. Throws InputError for an unreadable image or one of another size than the camera's.
///
/// Returns the target's spacing (gap over tag size) as the images show it: the median over those
/// that were searched now, not taken from the cache; empty where fewer than 3 tell. Images that
/// contradict the stated spacing, and then have few corners or none, never enter the cache.
std::optional<double> detectCorners(Recording& recording, const DetectRequest& request,
                                    const ProgressSink& progress);

/// Writes a session with its corners as a EuRoC folder that `plumbline calibrate` reads. Throws
/// InputError where it cannot be written.
void writeCornerSession(const Session& session, const std::filesystem::path& folder);

}  // namespace plumbline

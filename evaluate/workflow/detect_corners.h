// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibrator/target/detector.h"
#include "datasets/session_reader.h"
#include "evaluate/workflow/progress.h"

namespace plumbline {

struct DetectRequest {
  DetectorOptions detector;
  std::optional<std::string> cache;  ///< folder of found corners; empty: none is kept
  int threads = 0;                   ///< 0: all cores
};

/// Finds the corners of every image of the recording and fills them into its views; a camera
/// without stated resolution takes that of its first image. The result does not depend on the
/// threads. Throws InputError for an unreadable image or one of another size than the camera's.
void detectCorners(Recording& recording, const DetectRequest& request,
                   const ProgressSink& progress);

}  // namespace plumbline

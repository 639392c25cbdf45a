// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// Fills ReplayFrame::jpeg where the recording has images: grey, made smaller by a whole factor to
/// at most 400 pixels of width (mean over blocks), of JPEG quality 60. A frame's images are those
/// of the views that `paired`, one for each of `frames`, puts together.
void addImages(const LoadedSession& loaded, const std::vector<Frame>& paired,
               std::vector<ReplayFrame>& frames, const ProgressSink& progress);

}  // namespace plumbline

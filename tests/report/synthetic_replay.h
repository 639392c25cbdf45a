// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/records/replay_record.h"

namespace plumbline::test {

struct SyntheticReplayOptions {
  int frames = 300;
  bool images = false;  ///< small JPEGs of what the corners show
  /// Columns of tags, of six rows: 6 give 144 corners.
  int columns = 6;
  bool by_error = false;  ///< predicted errors decide, and not gains
};

/// A replay of both stages as a guide could have played it, made up frame by frame: a stereo camera
/// that wanders before a grid (projections are exact, the scores are not computed from them), views
/// kept, not kept and withdrawn, an unbounded and an unscored gain, frames dropped, the target
/// lost, stamps that jump, a gap of the IMU samples, suggestions reached, expired and withdrawn,
/// rounds with candidates that could not be scored, trajectories, both finishes, audits,
/// compliance, counterfactuals. Texts hold characters that HTML and JSON escape. No two numbers of
/// a column are the same unless they have to be.
ReplayRecord syntheticReplay(const SyntheticReplayOptions& options = {});

}  // namespace plumbline::test

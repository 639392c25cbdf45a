// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "evaluate/replay/counterfactuals.h"
#include "evaluate/replay/frame_split.h"

namespace plumbline::test {

/// A recording of a simulated rig, whose frames are the pool, followed by frames of the same rig on
/// another motion, held out.
struct SimulatedPool {
  std::string rig;
  double distance_ratio = 1;  ///< TrajectoryOptions::distance_ratio of the recording
  Session session;
  FrameSplit split;
};

struct SimulatedPoolOptions {
  int frames = 400;
  double duration_s = 100;    ///< of the recording; so frames are offered at 4 Hz
  int held_out_frames = 60;   ///< spread over a minute
  double sigma_px = 0.3;      ///< noise of the pool's corners, per axis
  double held_out_sigma = 0;  ///< of the held-out corners [px]; 0: exact
};

/// Number `index`: the rigs in turn, each with a trajectory and a distance (0.8 to 1.6 times the
/// usual) of its own; held-out frames at the usual distance.
SimulatedPool simulatedPool(int index, const SimulatedPoolOptions& options = {});

/// When a curve comes to a held-out error.
struct ViewsTo {
  std::optional<int> first;     ///< first number of views that reaches it
  std::optional<int> for_good;  ///< first from which on none misses it
};
ViewsTo viewsTo(const CounterfactualCurve& curve, double target_px);

}  // namespace plumbline::test

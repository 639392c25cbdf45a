// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "evaluate/replay/frame_split.h"
#include "evaluate/replay/view_pool.h"
#include "report/records/replay_record.h"

namespace plumbline {

struct CounterfactualOptions {
  /// Noise, loss, filter and models of every calibration, and a start for that of all frames;
  /// `frames` also says how the recording is paired; `select_views` and `threads` do not matter.
  CameraStageOptions camera;
  FrameSplitOptions split;
  int random_seeds = 5;    ///< random orders
  std::uint64_t seed = 1;  ///< of the first random order; the others follow it
  /// Numbers of views at which curves are evaluated, ascending; those beyond an order's length are
  /// left out and the length itself is added. Empty: 5, 8, 10, 15, 20, 30, 40, 60, 80, 120, 160,
  /// 240, ... up to the pool.
  std::vector<int> views;
  int online_views = 40;   ///< how far "predicted-error" goes
  int max_held_out = 200;  ///< held-out frames that are scored, evenly spread over all of them
  /// Fit the other of pinhole-radtan and pinhole-equidistant as well and say how the strategies
  /// compare there: what is the model's fault goes away with another model.
  bool other_model = true;
  int threads = 1;  ///< results do not depend on it

  /// Throws InputError for values out of range.
  void check() const;
};

/// How good would other choices from the same recording have been? Its frames are parted into a
/// pool and held-out blocks (splitFrames(), unless `split` is given); the pool's are used in the
/// order of each strategy:
/// - "recorded": as they came;
/// - "random": shuffled, one curve per seed;
/// - "greedy-mi": each next frame has the highest mutual information with the cameras' parameters
///   given those before it, 0.5 (log |I + I_f| - log |I|), all at the calibration from the whole
///   pool: hindsight that no operator has;
/// - "predicted-error": each next frame lowers the predicted error most where the pool's corners
///   are, at the estimate of the views before it (onlineOrder()), after the first three of the
///   first random order: what an operator could have; up to `online_views`;
/// - "coverage": each next frame covers the most cells of the images that are not yet covered;
/// - "guide": `guide_frames` that are in the pool, in their order; no curve where none is.
/// At every number of views the batch is solved over the frames used so far (as calibrateCameras(),
/// but started at the whole pool's calibration, so that no curve depends on how a first guess
/// went), and scored on the held-out frames, where only poses move (as scoreCameras()): RMSE [px].
///
/// A frame is its position in pairFrames(session.cameras, options.camera.frames), here, in
/// `guide_frames` and in the curves' orders. Frames without a plausible pose, and corners that the
/// options' filter rejects at the calibration from all frames, take no part anywhere.
/// Where nothing can be calibrated, Counterfactuals::problem says why. Throws InputError for models
/// that cannot be calibrated, or options out of range.
Counterfactuals counterfactuals(const Session& session, const std::vector<int>& guide_frames,
                                const CounterfactualOptions& options = {},
                                const std::optional<FrameSplit>& split = {});

/// The orders of the strategies (names and seeds as CounterfactualOptions says), not yet evaluated.
std::vector<CounterfactualCurve> strategyOrders(const ViewPool& pool,
                                                const std::vector<int>& guide_frames,
                                                const CounterfactualOptions& options);

/// Sentences, with figures, on how greedy MI compares with random orders and, where it does no
/// better, what its views have in common: where their corners lie, how well the model fits them, in
/// which part of the image the held-out error is, and whether another model changes it. Only what
/// the numbers hold is said.
std::vector<std::string> counterfactualRemarks(const ViewPool& pool, const Counterfactuals& found,
                                               int guide_frames);

}  // namespace plumbline

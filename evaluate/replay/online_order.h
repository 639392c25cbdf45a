// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/information/predicted_error.h"
#include "evaluate/replay/view_pool.h"

namespace plumbline {

/// With fewer views the next is chosen by information, whatever the criterion: E is of first order
/// about an estimate, and three random views leave one that is too far off
/// (docs/counterfactuals.md). A guide starts with more.
inline constexpr int kLeastViewsForError = 4;

struct OnlineOrderOptions {
  ViewCriterion criterion = ViewCriterion::kPredictedError;
  int most_views = 40;

  /// Throws InputError for values out of range.
  void check() const;
};

/// What was known when the order had so many views.
struct OnlineStep {
  int views = 0;
  ErrorComponents components;  ///< as they entered the score
  double predicted_px2 = 0;    ///< E of the views so far
  double excess = 0;           ///< relativeExcess()
};

struct OnlineOrder {
  std::vector<int> order;         ///< frames of the recording
  std::vector<OnlineStep> steps;  ///< one per estimate
};

/// Frames of a pool in the order in which a criterion takes them, each decision at the estimate of
/// its time: the batch over the views so far, made anew with every view up to 8, then with every
/// 2nd, 4th, 6th, 10th (from 12, 20, 32 on). `first`, of `candidates`, are its beginning. A view
/// whose RMSE at that estimate exceeds three times the candidates' median is not taken: one
/// photograph of several px error would inflate all components. While the views so far do not
/// determine the cameras the next ones come as `candidates` lists them.
OnlineOrder onlineOrder(const ViewPool& pool, const std::vector<int>& candidates,
                        const std::vector<int>& first, const OnlineOrderOptions& options = {});

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/image.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/view_terms.h"
#include "calibrator/information/predicted_error.h"
#include "evaluate/replay/view_pool.h"

namespace plumbline {

// Orders in which the views of a pool could be used: each a permutation of 0 .. count - 1.

/// Each next view maximises the mutual information with the parameters given those before it,
///   0.5 (log |Lambda + I_v| - log |Lambda|),  Lambda = Lambda_0 + sum of those before.
/// `shares` holds what each view tells (its own pose eliminated, all at one estimate); Lambda_0 is
/// so weak (every parameter 1000 times less certain than all views together leave it) that it
/// matters only until the views determine the parameters. Ties go to the earlier view.
/// The gain is submodular: a gain once computed bounds every later one of that view, so that only
/// views whose bound leads are scored again. One n^3 / 3 Cholesky each.
/// Empty where all views together do not determine the parameters.
std::vector<int> greedyInformationOrder(const std::vector<Eigen::MatrixXd>& shares);

/// Cells of each camera's image, per frame: those in which it has a corner. Cells are counted over
/// all cameras.
std::vector<std::vector<int>> cellsSeen(const Session& session, const std::vector<Frame>& frames,
                                        const ImageCells& grid = {});

/// Each next view holds the most cells that are not yet covered, the earlier one in a tie. Once
/// none adds a cell, covering begins again with the views that are left.
std::vector<int> coverageOrder(const std::vector<std::vector<int>>& cells);

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

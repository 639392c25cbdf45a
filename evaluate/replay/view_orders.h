// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/image.h"
#include "calibrator/base/session.h"

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

}  // namespace plumbline

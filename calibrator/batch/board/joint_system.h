// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrator/batch/board/remainder_space.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// Normal equations of all parameters together about an estimate, the poses eliminated, in units of
/// pixel_sigma: g the cameras and the twelve terms in the layout's order with what is known of them
/// beforehand, h the higher terms without their prior. S is the information, s the gradient.
struct JointSystem {
  Eigen::MatrixXd S_gg, S_gh, S_hh;
  Eigen::VectorXd s_g;
  Eigen::MatrixXd scores;  ///< s_h of every frame
};
/// Of a problem whose estimate has the board's terms.
JointSystem jointSystem(const CameraProblem& problem, const CameraEstimate& estimate,
                        BoardDetail detail);

/// Of a board under estimation to that detail; none where it has no remainders.
std::optional<RemainderSpace> remainderSpaceOf(const AprilGrid& board, BoardDetail detail);

}  // namespace plumbline

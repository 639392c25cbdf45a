// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// How an error of the corners that all views share moves the cameras' parameters and the board's
/// terms (in the layout's order): in every camera's image a smooth displacement
///   (du, dv) = sum_k (a_k, b_k) f_k(u, v),   a_k, b_k ~ N(0, px^2),   px >= 0,
/// f_k the polynomials of fieldFunctions() over the whole image, of mean square 1 there. A column
/// for every a_k and b_k at one standard deviation, M = -px S^-1 C, C what 1 px of each adds to the
/// gradient, poses eliminated: M M^T is the estimate's covariance from it, and with M_1, M_2 of two
/// recordings (M_1 - M_2) (M_1 - M_2)^T that of their difference. No residual shows such an error
/// as far as the parameters take it, and no block of time or draw of a bootstrap varies it.
///
/// Without loss, a board's higher terms held. Of 30 frames, evenly over the recording and over the
/// sets of cameras that see one, for S and C grow alike with frames that are alike; of all frames
/// where these do not determine the cameras. Without columns where px is 0, or those do not either.
Eigen::MatrixXd commonErrorMoves(const CameraProblem& problem, const CameraEstimate& estimate,
                                 double px);

/// px by problem.common_error_share: times the RMS of the corners' errors per axis, after the loss,
/// of all cameras together (what the lens and the board misfit is in it).
double commonErrorPx(const CameraProblem& problem, const CameraEstimate& estimate);

}  // namespace plumbline

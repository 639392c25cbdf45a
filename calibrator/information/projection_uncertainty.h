// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"

namespace plumbline {

// Where would the image of a fixed point have been, had the corners been measured again?
//
// A calibration knows no fixed frame: a change of its intrinsics goes with a shift of all poses,
// and that part of it is no error. So the points are fixed to the boards: with g the change of the
// cameras' parameters and d_f the left twist (rho [m], phi [rad]) of T_C0F in frame f, the boards
// together shift the reference frame by a twist tau, and a point at p in it is seen at
//   q+ = project(k + dk, p + tau_rho + tau_phi x p)        (for camera 0; others by their T_C0Ci).
// The pixel's covariance follows from that of (tau, g). After mrcal's "projection uncertainty"
// (mrcal.secretsauce.net/uncertainty.html), which defines tau in two ways.

/// How the frames' twists are combined to the reference's.
enum class FrameAlignment {
  /// tau = mean_f d_f: mrcal's "mean-frames", the method of its releases before 3. A frame whose
  /// pose is weakly known, such as one far away, counts as much as any.
  kMeanFrames,
  /// tau = (sum_f H_f)^-1 sum_f H_f d_f, H_f the information of frame f's pose: the shift that best
  /// explains, in pixels, where the moved boards are seen. mrcal's "cross-reprojection".
  kCrossReprojection,
};

/// tau = A g + n,  n ~ N(0, noise) independent of g.
struct ImpliedShift {
  Eigen::Matrix<double, 6, Eigen::Dynamic> A;
  Matrix6d noise = Matrix6d::Zero();
};

/// From the blocks of the normal equations [H_f P_f; P_f^T G] [d_f; g] = -[...], where d_f given g
/// is N(-H_f^-1 P_f g, H_f^-1): mean-frames (N frames) has A = -1/N sum H_f^-1 P_f and noise
/// 1/N^2 sum H_f^-1, cross-reprojection A = -(sum H_f)^-1 sum P_f and noise (sum H_f)^-1.
/// `P` holds 6 rows per frame. Mean-frames leaves out frames whose H_f has no inverse, and is empty
/// without any; cross-reprojection is empty where the sum of H_f has none.
std::optional<ImpliedShift> impliedShift(const std::vector<Matrix6d>& H, const Eigen::MatrixXd& P,
                                         FrameAlignment alignment);

/// Pixels of a grid over an image, row by row, from the first pixel's centre to the last one's.
std::vector<Eigen::Vector2d> pixelGrid(const Resolution& image, int columns, int rows);

/// d uv / d (rho, phi, dk), 2 x (6 + K), for the point at `ray` (unit length) times `range_m`; at
/// infinity the ray itself is projected, which gives the same pixel. Empty where the point has no
/// image.
std::optional<Eigen::MatrixXd> pixelJacobian(const Intrinsics& camera, const Eigen::Vector3d& ray,
                                             double range_m);

/// Covariance of x = (rho [m], phi [rad], dk): twist of the points in a camera's own frame, and
/// change of its stacked intrinsics. (6 + K) squared.
using ProjectionCovariance = Eigen::MatrixXd;

/// For a calibration of which only the intrinsics' covariance is known: tau is the shift that makes
/// up best for dk over the image itself, minimising sum |J_point (tau_rho + tau_phi x p) + J_k
/// dk|^2 over a grid of columns x rows pixels at `range_m`. The same fit as that of a projection
/// difference (mrcal's "implied by the intrinsics"), so that this is the standard deviation of such
/// a difference to the truth. On average over the grid it bounds the uncertainties above from
/// below, whose shift is fitted to where the boards were. At infinity only phi is fitted.
struct ImageFitOptions {
  double range_m = std::numeric_limits<double>::infinity();
  int columns = 31, rows = 21;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};
ProjectionCovariance imageFitCovariance(const Intrinsics& camera,
                                        const Eigen::MatrixXd& intrinsics_covariance,
                                        const ImageFitOptions& options = {});

/// Mean over that grid of the expected squared projection error [px^2], the fitted shift taken out:
/// tr(Sigma (K - H_k^T H^+ H_k)) / n, from the sums over n pixels of K = J_k^T J_k and of those of
/// the fit. The mean of the traces of pixelCovariance() under imageFitCovariance(), in one pass.
/// Empty where no pixel of the grid has a ray.
std::optional<double> imageFitMeanSquare(const Intrinsics& camera,
                                         const Eigen::MatrixXd& intrinsics_covariance,
                                         const ImageFitOptions& options = {});

/// Covariance [px^2] of the projection of the point that is seen at `uv`, `range_m` away from the
/// camera (> 0; infinity: a direction, on which rho has no influence). Empty where the pixel cannot
/// be unprojected.
std::optional<Eigen::Matrix2d> pixelCovariance(const Intrinsics& camera,
                                               const ProjectionCovariance& covariance,
                                               const Eigen::Vector2d& uv, double range_m);

/// Standard deviation along the worst direction [px]: sqrt of the larger eigenvalue (mrcal's
/// "worstdirection-stdev").
double worstDirectionStd(const Eigen::Matrix2d& covariance);

}  // namespace plumbline

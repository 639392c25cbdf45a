// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/projection_uncertainty.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrator/base/option_check.h"
#include "calibrator/camera/camera.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

using Rows6 = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Each frame's pose answers to the parameters by itself, -H_f^-1 P_f; the noises are independent,
/// so that their mean has a frame's covariance over the number of frames.
std::optional<ImpliedShift> meanFrames(const std::vector<Matrix6d>& H, const Eigen::MatrixXd& P) {
  ImpliedShift shift;
  shift.A = Rows6::Zero(6, P.cols());
  int frames = 0;
  for (std::size_t f = 0; f < H.size(); ++f) {
    const Eigen::LLT<Matrix6d> llt(H[f]);
    // A frame that does not determine its own pose says nothing of a mean shift.
    if (llt.info() != Eigen::Success) continue;
    shift.A -= llt.solve(P.middleRows<6>(6 * f));
    shift.noise += llt.solve(Matrix6d::Identity());
    ++frames;
  }
  if (frames == 0) return std::nullopt;
  shift.A /= frames;
  shift.noise /= static_cast<double>(frames) * frames;
  return shift;
}

/// A frame with a singular H_f still counts here: only the sum needs an inverse.
std::optional<ImpliedShift> crossReprojection(const std::vector<Matrix6d>& H,
                                              const Eigen::MatrixXd& P) {
  Matrix6d sum_H = Matrix6d::Zero();
  Rows6 sum_P = Rows6::Zero(6, P.cols());
  for (std::size_t f = 0; f < H.size(); ++f) {
    sum_H += H[f];
    sum_P += P.middleRows<6>(6 * f);
  }
  const Eigen::LLT<Matrix6d> llt(sum_H);
  if (llt.info() != Eigen::Success) return std::nullopt;
  ImpliedShift shift;
  shift.A = -llt.solve(sum_P);
  shift.noise = llt.solve(Matrix6d::Identity());
  return shift;
}

/// J^T J over the grid, J = d uv / d (rho, phi, dk).
struct ImageFitSums {
  Matrix6d H = Matrix6d::Zero();
  Rows6 H_k;
  Eigen::MatrixXd K;
  int pixels = 0;  ///< that have a ray
};

ImageFitSums imageFitSums(const Intrinsics& camera, Eigen::Index parameters,
                          const ImageFitOptions& options) {
  ImageFitSums sums;
  sums.H_k = Rows6::Zero(6, parameters);
  sums.K = Eigen::MatrixXd::Zero(parameters, parameters);
  for (const Eigen::Vector2d& uv : pixelGrid(camera.resolution, options.columns, options.rows)) {
    const auto ray = unproject(camera, uv);
    const auto J = ray ? pixelJacobian(camera, *ray, options.range_m) : std::nullopt;
    if (!J) continue;
    sums.H += J->leftCols<6>().transpose() * J->leftCols<6>();
    sums.H_k += J->leftCols<6>().transpose() * J->rightCols(parameters);
    sums.K.noalias() += J->rightCols(parameters).transpose() * J->rightCols(parameters);
    ++sums.pixels;
  }
  return sums;
}

/// The shift (rho, phi) that makes up best for dk, 6 x K: -H^+ H_k. Without a range only the
/// rotation is there to be fitted. Over a narrow field a step aside looks like a turn: the
/// pseudo-inverse leaves out what is alike to rounding.
Eigen::MatrixXd fittedShift(const ImageFitSums& sums, bool finite) {
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(6, sums.H_k.cols());
  const int first = finite ? 0 : 3;
  const int size = 6 - first;
  shift.middleRows(first, size) =
      -symmetricPseudoInverse(sums.H.bottomRightCorner(size, size), 1e-15) *
      sums.H_k.bottomRows(size);
  return shift;
}

}  // namespace

// To the very border, where lenses are known worst.
std::vector<Eigen::Vector2d> pixelGrid(const Resolution& image, int columns, int rows) {
  std::vector<Eigen::Vector2d> pixels;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      pixels.emplace_back(c * (image.width - 1.0) / std::max(1, columns - 1),
                          r * (image.height - 1.0) / std::max(1, rows - 1));
    }
  }
  return pixels;
}

std::optional<Eigen::MatrixXd> pixelJacobian(const Intrinsics& camera, const Eigen::Vector3d& ray,
                                             double range_m) {
  const bool finite = std::isfinite(range_m);
  const Eigen::Vector3d p = finite ? Eigen::Vector3d(range_m * ray) : ray;
  const auto projection = projectWithJacobians(camera, p);
  if (!projection) return std::nullopt;
  Eigen::MatrixXd J(2, 6 + projection->J_intrinsics.cols());
  J.leftCols<3>().setZero();
  if (finite) J.leftCols<3>() = projection->J_point;
  // d(phi x p) = -[p]x dphi. J_point falls with 1 / range as p grows, so that the ray alone gives
  // the same.
  J.middleCols<3>(3) = -projection->J_point * skew(p);
  J.rightCols(projection->J_intrinsics.cols()) = projection->J_intrinsics;
  return J;
}

std::optional<ImpliedShift> impliedShift(const std::vector<Matrix6d>& H, const Eigen::MatrixXd& P,
                                         FrameAlignment alignment) {
  assert(P.rows() == 6 * static_cast<Eigen::Index>(H.size()));
  return alignment == FrameAlignment::kMeanFrames ? meanFrames(H, P) : crossReprojection(H, P);
}

void ImageFitOptions::check() const {
  requireOption(range_m > 0, "range_m", range_m, "a positive length, or infinity");
  requireOption(columns >= 1 && rows >= 1, "columns x rows", columns * rows, "1 x 1 or more");
}

ProjectionCovariance imageFitCovariance(const Intrinsics& camera,
                                        const Eigen::MatrixXd& intrinsics_covariance,
                                        const ImageFitOptions& options) {
  options.check();
  const Eigen::Index K = intrinsics_covariance.rows();
  const ImageFitSums sums = imageFitSums(camera, K, options);
  Eigen::MatrixXd M(6 + K, K);  // x = M dk
  M << fittedShift(sums, std::isfinite(options.range_m)), Eigen::MatrixXd::Identity(K, K);
  return M * intrinsics_covariance * M.transpose();
}

std::optional<double> imageFitMeanSquare(const Intrinsics& camera,
                                         const Eigen::MatrixXd& intrinsics_covariance,
                                         const ImageFitOptions& options) {
  options.check();
  const Eigen::Index K = intrinsics_covariance.rows();
  const ImageFitSums sums = imageFitSums(camera, K, options);
  if (sums.pixels == 0) return std::nullopt;
  // The Schur complement: squares that are left once the shift has taken what it can.
  const Eigen::MatrixXd left =
      sums.K + sums.H_k.transpose() * fittedShift(sums, std::isfinite(options.range_m));
  return (left * intrinsics_covariance).trace() / sums.pixels;
}

std::optional<Eigen::Matrix2d> pixelCovariance(const Intrinsics& camera,
                                               const ProjectionCovariance& covariance,
                                               const Eigen::Vector2d& uv, double range_m) {
  assert(range_m > 0);
  const auto ray = unproject(camera, uv);
  const auto J = ray ? pixelJacobian(camera, *ray, range_m) : std::nullopt;
  if (!J) return std::nullopt;
  assert(J->cols() == covariance.rows());
  return Eigen::Matrix2d(*J * covariance * J->transpose());
}

double worstDirectionStd(const Eigen::Matrix2d& covariance) {
  const double mean = 0.5 * covariance.trace();
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(mean + std::hypot(half, covariance(0, 1)));
}

}  // namespace plumbline

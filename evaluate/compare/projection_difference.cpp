// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/projection_difference.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"

namespace plumbline {
namespace {

constexpr int kIterations = 100;
constexpr double kSmallestStep = 1e-15;  // [rad], of ranges

/// The same pixel's rays, of unit length.
struct RayPair {
  Eigen::Vector3d a, b;
  double weight;
};

/// mrcal's choice without weights; with weights they decide what counts.
double focusRadius(const Resolution& image, const DifferenceOptions& options) {
  if (options.focus_radius_px > 0) return options.focus_radius_px;
  if (!options.weights.empty()) return std::numeric_limits<double>::infinity();
  return std::min(image.width, image.height) / 6.0;
}

bool isInFocus(const Resolution& image, const DifferenceOptions& options,
               const Eigen::Vector2d& q) {
  const Eigen::Vector2d centre(0.5 * (image.width - 1), 0.5 * (image.height - 1));
  return (q - centre).norm() < focusRadius(image, options);
}

/// Rays that both models define, of pixels that take part in the fit. A model may have no ray
/// beyond its field of view.
std::vector<RayPair> raysOfFocus(const Intrinsics& A, const Intrinsics& B,
                                 const DifferenceOptions& options) {
  std::vector<RayPair> pairs;
  for (int i = 0; i < options.grid.size(); ++i) {
    const Eigen::Vector2d q = options.grid.pixel(A.resolution, i);
    const double weight =
        options.weights.empty() ? 1.0 : options.weights[static_cast<std::size_t>(i)];
    // Weights that are not finite are of pixels whose uncertainty is unknown in one of the two.
    if (!isInFocus(A.resolution, options, q) || !std::isfinite(weight) || !(weight > 0)) continue;
    const auto a = unproject(A, q);
    const auto b = unproject(B, q);
    if (a && b) pairs.push_back({*a, *b, weight});
  }
  return pairs;
}

/// argmin over R of sum w |R a - b|^2 (Wahba's problem, by Kabsch).
Eigen::Matrix3d bestRotation(const std::vector<RayPair>& pairs) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (const RayPair& p : pairs) M += p.weight * p.b * p.a.transpose();
  return nearestRotation(M);
}

/// Newton's step of sum f(s), s = |e|^2, e = T a / |T a| - b (so that s = th^2 to third order), in
/// the left tangent (translation in units of the range, rotation). `size` is 3 for rotations alone.
Vector6d newtonStep(const std::vector<RayPair>& pairs, const Transform& T, int size,
                    DifferenceFit fit) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  for (const RayPair& pair : pairs) {
    const Eigen::Vector3d Ra = T.R * pair.a;
    const Eigen::Vector3d p = Ra + T.t;
    const double r = p.norm();
    const Eigen::Vector3d ray = p / r;
    const Eigen::Vector3d e = ray - pair.b;
    const double s = e.squaredNorm();
    const Eigen::Matrix3d along = (Eigen::Matrix3d::Identity() - ray * ray.transpose()) / r;
    Eigen::Matrix<double, 3, 6> J;
    J << along, -along * skew(Ra);
    const Vector6d Je = J.transpose() * e;
    const double w = pair.weight;
    const bool squares = fit == DifferenceFit::kSquares;
    // f = w s, or w^2 s^2 / 2: f' is df, f'' is w^2. Gauss and Newton in e, exact in f.
    const double df = squares ? w : w * w * s;
    g += 2 * df * Je;
    H += 2 * df * J.transpose() * J;
    if (!squares) H += 4 * w * w * Je * Je.transpose();
  }
  Vector6d step = Vector6d::Zero();
  const Eigen::MatrixXd reduced = H.bottomRightCorner(size, size);
  // The shortest step where H is singular: the fourth power has no curvature at a perfect fit.
  step.tail(size) = -reduced.completeOrthogonalDecomposition().solve(g.tail(size));
  return step;
}

/// T_BA with its translation in units of the range.
Transform impliedTransform(const std::vector<RayPair>& pairs, const DifferenceOptions& options) {
  Transform T(bestRotation(pairs), Eigen::Vector3d::Zero());
  const bool finite = std::isfinite(options.range_m);
  // For a rotation alone |R a - b|^2 is the squares' cost, of which Kabsch has the minimum in
  // closed form.
  if (!finite && options.fit == DifferenceFit::kSquares) return T;
  // The fourth power has no curvature at a perfect fit; it starts from the squares' minimum.
  if (finite && options.fit == DifferenceFit::kFourthPower) {
    DifferenceOptions squares = options;
    squares.fit = DifferenceFit::kSquares;
    T = impliedTransform(pairs, squares);
  }
  for (int i = 0; i < kIterations; ++i) {
    const Vector6d step = newtonStep(pairs, T, finite ? 6 : 3, options.fit);
    if (!step.allFinite()) break;
    T = boxplus(T, step);
    if (step.norm() < kSmallestStep) break;
  }
  return T;
}

}  // namespace

int pointsInFocus(const Resolution& image, const DifferenceOptions& options) {
  int points = 0;
  for (int i = 0; i < options.grid.size(); ++i) {
    if (isInFocus(image, options, options.grid.pixel(image, i))) ++points;
  }
  return points;
}

std::optional<ProjectionDifference> projectionDifference(const Intrinsics& A, const Intrinsics& B,
                                                         const DifferenceOptions& options) {
  assert(options.grid.columns >= 2 && options.grid.rows >= 2 && options.range_m > 0);
  assert(options.weights.empty() ||
         static_cast<int>(options.weights.size()) == options.grid.size());
  if (!(A.resolution == B.resolution)) {
    throw InputError(fmt::format(
        "images of {}x{} and {}x{} pixels have no difference; compare calibrations of one camera",
        A.resolution.width, A.resolution.height, B.resolution.width, B.resolution.height));
  }
  const std::vector<RayPair> pairs = raysOfFocus(A, B, options);
  if (pairs.size() < kFewestFitRays) return std::nullopt;
  ProjectionDifference out;
  out.fitted = static_cast<int>(pairs.size());
  const Transform T = impliedTransform(pairs, options);
  out.T_BA = T;
  if (std::isfinite(options.range_m)) out.T_BA.t *= options.range_m;
  for (int i = 0; i < options.grid.size(); ++i) {
    const Eigen::Vector2d q = options.grid.pixel(A.resolution, i);
    const auto ray = unproject(A, q);
    const auto seen = ray ? project(B, T * *ray) : std::nullopt;
    out.vectors.push_back(seen ? Eigen::Vector2d(*seen - q)
                               : Eigen::Vector2d::Constant(std::nan("")));
  }
  return out;
}

}  // namespace plumbline

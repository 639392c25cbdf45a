// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrator/camera/camera.h"
#include "calibrator/initialise/camera_start.h"
#include "calibrator/linear/levenberg_marquardt.h"

namespace plumbline {
namespace {

constexpr double kMostSlope = 30;   // of a ray that a pinhole fits: 88 degrees
constexpr double kRegular = 1e-12;  // of a system's diagonal, where parameters are free

/// The fit as minimise() wants it. Outside the domain of the model there is no cost.
class LensSteps {
 public:
  LensSteps(const Intrinsics& start, const std::vector<SeenPoint>& points)
      : points_(points), lens_(start) {
    const auto cost = evaluate(lens_, H_, b_);
    cost_ = cost.value_or(std::numeric_limits<double>::infinity());
  }

  double cost() const { return cost_; }
  const Intrinsics& lens() const { return lens_; }

  std::optional<double> solve(double damping) {
    Eigen::MatrixXd A = H_;
    // Marquardt's scaling: pixels beside coefficients without a unit.
    A.diagonal() *= 1 + damping + kRegular;
    const Eigen::LLT<Eigen::MatrixXd> llt(A);
    if (llt.info() != Eigen::Success) return std::nullopt;
    x_ = -llt.solve(b_);
    return -x_.dot(b_);
  }

  Trial attempt() {
    next_ = lens_;
    next_.setStacked(lens_.stacked() + x_);
    const auto cost = evaluate(next_, next_H_, next_b_);
    if (!cost) return {};
    return {.cost = *cost};
  }

  void accept() {
    lens_ = next_;
    H_ = next_H_;
    b_ = next_b_;
    // squares_ is still that of attempt(), the last evaluation.
    cost_ = 0.5 * squares_;
  }

  static bool refuse() { return false; }

 private:
  std::optional<double> evaluate(const Intrinsics& lens, Eigen::MatrixXd& H, Eigen::VectorXd& b) {
    const auto n = lens.projection.size() + lens.distortion.size();
    H.setZero(n, n);
    b.setZero(n);
    squares_ = 0;
    for (const SeenPoint& point : points_) {
      const auto seen = projectWithJacobians(lens, point.p_C);
      // A step that loses a point is refused, not rewarded with a smaller sum.
      if (!seen) return std::nullopt;
      const Eigen::Vector2d e = seen->uv - point.uv;
      H.noalias() += seen->J_intrinsics.transpose() * seen->J_intrinsics;
      b.noalias() += seen->J_intrinsics.transpose() * e;
      squares_ += e.squaredNorm();
    }
    return 0.5 * squares_;
  }

  const std::vector<SeenPoint>& points_;
  Intrinsics lens_, next_;
  Eigen::MatrixXd H_, next_H_;
  Eigen::VectorXd b_, next_b_, x_;
  double squares_ = 0;
  double cost_ = 0;
};

/// Whether a point takes part. A pinhole's plane coordinates grow without bound towards 90 degrees:
/// a few points there would decide the fit.
bool canBeFitted(const Intrinsics& lens, const SeenPoint& point) {
  if (lens.projection_model == ProjectionModel::kPinhole &&
      !(point.p_C.head<2>().norm() < kMostSlope * point.p_C.z())) {
    return false;
  }
  return project(lens, point.p_C).has_value();
}

}  // namespace

std::optional<LensFit> fitLens(const Intrinsics& start, const std::vector<SeenPoint>& points) {
  // Chosen once, by the start: a set that followed the lens would let the cost fall by losing
  // points.
  std::vector<SeenPoint> used;
  std::copy_if(points.begin(), points.end(), std::back_inserter(used),
               [&](const SeenPoint& p) { return canBeFitted(start, p); });
  // Two equations a point.
  if (2 * static_cast<Eigen::Index>(used.size()) < start.stacked().size()) return std::nullopt;
  LensSteps steps(start, used);
  MinimiserOptions options;
  options.first_damping = 1e-3;  // the start is a lens without its shape
  options.cost_tolerance = 1e-10;
  options.max_iterations =
      200;  // some models have long flat valleys, whose floor need not be found
  (void)minimise(steps, options);
  if (!std::isfinite(steps.cost())) return std::nullopt;
  LensFit fit{steps.lens(), 0, 0, static_cast<int>(used.size())};
  fit.rms_px = std::sqrt(2 * steps.cost() / static_cast<double>(used.size()));
  for (const SeenPoint& p : used) {
    fit.most_px = std::max(fit.most_px, (*project(fit.lens, p.p_C) - p.uv).norm());
  }
  return fit;
}

Intrinsics plainLike(const Intrinsics& lens, ProjectionModel projection,
                     DistortionModel distortion) {
  Intrinsics plain = plainCamera(projection, distortion, lens.resolution, pixelsPerRadian(lens));
  plain.projection.tail<2>() = lens.projection.tail<2>();
  return plain;
}

std::optional<LensFit> convertedLens(const Intrinsics& from, ProjectionModel projection,
                                     DistortionModel distortion, int columns, int rows) {
  std::vector<SeenPoint> points;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      // Middles of even cells of the image, which spans -0.5 to width - 0.5.
      const Eigen::Vector2d uv((i + 0.5) * from.resolution.width / columns - 0.5,
                               (j + 0.5) * from.resolution.height / rows - 0.5);
      const auto ray = unproject(from, uv);
      if (ray) points.push_back({*ray, uv});
    }
  }
  return fitLens(plainLike(from, projection, distortion), points);
}

}  // namespace plumbline

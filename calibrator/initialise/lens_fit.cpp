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

/// Whether steps of a fit may lead to lenses whose distortion folds back within the image: from
/// some starts the way to the best lens, which has no fold there, leads through these.
enum class AtFold { kStay, kPass };

/// The fit as minimise() wants it. Outside the domain of the model there is no cost.
class LensSteps {
 public:
  LensSteps(const Intrinsics& start, const std::vector<SeenPoint>& points, AtFold at_fold)
      : points_(points), at_fold_(at_fold), lens_(start) {
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
      const auto seen = at_fold_ == AtFold::kPass ? projectBeyondFold(lens, point.p_C)
                                                  : projectWithJacobians(lens, point.p_C);
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
  AtFold at_fold_;
  Intrinsics lens_, next_;
  Eigen::MatrixXd H_, next_H_;
  Eigen::VectorXd b_, next_b_, x_;
  double squares_ = 0;
  double cost_ = 0;
};

/// The points that take part in a fit from `start`, chosen once: a set that followed the lens would
/// let the cost fall by losing points. A pinhole's plane coordinates grow without bound towards 90
/// degrees: a few points there would decide the fit.
std::vector<SeenPoint> fittedPoints(const Intrinsics& start, const std::vector<SeenPoint>& points) {
  const bool pinhole = start.projection_model == ProjectionModel::kPinhole;
  std::vector<SeenPoint> used;
  std::copy_if(points.begin(), points.end(), std::back_inserter(used), [&](const SeenPoint& p) {
    return (!pinhole || isWellAhead(p.p_C)) && project(start, p.p_C).has_value();
  });
  return used;
}

/// Where the steps from `start` end.
Intrinsics leastFrom(const Intrinsics& start, const std::vector<SeenPoint>& points,
                     AtFold at_fold) {
  LensSteps steps(start, points, at_fold);
  MinimiserOptions options;
  options.first_damping = 1e-3;  // the start is a lens without its shape
  options.cost_tolerance = 1e-10;
  options.max_iterations =
      200;  // some models have long flat valleys, whose floor need not be found
  (void)minimise(steps, options);
  return steps.lens();
}

/// Empty where the lens does not show a point.
std::optional<LensFit> fitOf(const Intrinsics& lens, const std::vector<SeenPoint>& points) {
  LensFit fit{lens, 0, 0, static_cast<int>(points.size())};
  double squares = 0;
  for (const SeenPoint& p : points) {
    const auto uv = project(lens, p.p_C);
    if (!uv) return std::nullopt;
    const double square = (*uv - p.uv).squaredNorm();
    squares += square;
    fit.most_px = std::max(fit.most_px, std::sqrt(square));
  }
  fit.rms_px = std::sqrt(squares / static_cast<double>(points.size()));
  if (!std::isfinite(fit.rms_px)) return std::nullopt;
  return fit;
}

}  // namespace

bool isWellAhead(const Eigen::Vector3d& p_C) { return p_C.head<2>().norm() < kMostSlope * p_C.z(); }

std::optional<LensFit> fitLens(const Intrinsics& start, const std::vector<SeenPoint>& points) {
  const std::vector<SeenPoint> used = fittedPoints(start, points);
  // Two equations a point.
  if (2 * static_cast<Eigen::Index>(used.size()) < start.stacked().size()) return std::nullopt;
  return fitOf(leastFrom(start, used, AtFold::kStay), used);
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
      // From the first pixel to the last: at the border of the image the error is greatest.
      const Eigen::Vector2d uv(i * (from.resolution.width - 1.0) / (columns - 1),
                               j * (from.resolution.height - 1.0) / (rows - 1));
      const auto ray = unproject(from, uv);
      if (ray) points.push_back({*ray, uv});
    }
  }
  const Intrinsics plain = plainLike(from, projection, distortion);
  const auto fit = fitLens(plain, points);
  if (!fit) return std::nullopt;
  const std::vector<SeenPoint> used = fittedPoints(plain, points);
  const auto past_folds = fitOf(leastFrom(plain, used, AtFold::kPass), used);
  return past_folds && past_folds->rms_px < fit->rms_px ? past_folds : fit;
}

}  // namespace plumbline

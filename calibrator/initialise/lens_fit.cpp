// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrator/camera/camera.h"
#include "calibrator/initialise/camera_start.h"
#include "calibrator/initialise/dense_steps.h"

namespace plumbline {
namespace {

constexpr double kMostSlope = 30;   // of a ray that a pinhole fits: 88 degrees
constexpr double kRegular = 1e-12;  // of a system's diagonal, where parameters are free

/// Whether steps of a fit may lead to lenses whose distortion folds back within the image: from
/// some starts the way to the best lens, which has no fold there, leads through these.
enum class AtFold { kStay, kPass };

/// Of minimise().
struct LensSums {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double cost = std::numeric_limits<double>::infinity();
};

/// Outside the domain of the model there is no cost.
LensSums lensSums(const Intrinsics& lens, const std::vector<SeenPoint>& points, AtFold at_fold) {
  const auto n = lens.projection.size() + lens.distortion.size();
  LensSums sums{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  double squares = 0;
  for (const SeenPoint& point : points) {
    const auto seen = at_fold == AtFold::kPass ? projectBeyondFold(lens, point.p_C)
                                               : projectWithJacobians(lens, point.p_C);
    // A step that loses a point is refused, not rewarded with a smaller sum.
    if (!seen) return sums;
    const Eigen::Vector2d e = seen->uv - point.uv;
    sums.H.noalias() += seen->J_intrinsics.transpose() * seen->J_intrinsics;
    sums.b.noalias() += seen->J_intrinsics.transpose() * e;
    squares += e.squaredNorm();
  }
  sums.cost = squares;
  return sums;
}

Intrinsics movedLens(Intrinsics lens, const Eigen::VectorXd& x) {
  lens.setStacked(lens.stacked() + x);
  return lens;
}

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
  const auto sums = [&](const Intrinsics& lens) { return lensSums(lens, points, at_fold); };
  DenseSteps steps(start, sums, &movedLens, kRegular);
  MinimiserOptions options;
  options.first_damping = 1e-3;  // the start is a lens without its shape
  options.cost_tolerance = 1e-10;
  options.max_iterations =
      200;  // some models have long flat valleys, whose floor need not be found
  (void)minimise(steps, options);
  return steps.point();
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

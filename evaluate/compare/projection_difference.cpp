// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/projection_difference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/core.h>
#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/dense/decompositions.h"
#include "evaluate/compare/compare_calibrations.h"

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
  // The shortest step where H is singular: the fourth power has no curvature at a perfect fit.
  step.tail(size) = -leastSquares(H.bottomRightCorner(size, size), g.tail(size));
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

// A border on either side and a centre between.
constexpr int kFewestGridPoints = 3;
constexpr int kMostGridPoints = 500;

/// Ranges are compared exactly: both maps are made for the same list of options, infinity included.
const ImageMap* find(const std::vector<ImageMap>& maps, const std::string& label,
                     const std::string& camera, double range_m) {
  const auto found = std::ranges::find_if(maps, [&](const ImageMap& m) {
    return m.label == label && m.camera == camera && m.range_m == range_m;
  });
  return found == maps.end() ? nullptr : &*found;
}

/// Whether weights leave enough points for a fit. Deviations of 0 and unknown ones leave none.
bool canWeight(const std::vector<double>& weights) {
  return std::ranges::count_if(weights, [](double w) { return std::isfinite(w) && w > 0; }) >=
         kFewestFitRays;
}

/// Undefined all over where too few pixels of the fit have a ray under both: without a map nobody
/// would miss it.
ImageMap differenceMap(const CameraCalibration& a, const CameraCalibration& b,
                       const std::string& label, const DifferenceOptions& options) {
  const auto difference = projectionDifference(a.intrinsics, b.intrinsics, options);
  ImageMap map = imageMapOf(a, label, options.range_m, options.grid);
  if (!difference) {
    map.method = "no fit: fewer than three pixels have a ray under both";
    map.values.assign(static_cast<std::size_t>(options.grid.size()), std::nan(""));
    return map;
  }
  map.method =
      options.weights.empty() ? "fit over the focus region" : "fit weighted by uncertainty";
  map.implied = difference->T_BA;
  map.vectors = difference->vectors;
  for (const Eigen::Vector2d& v : map.vectors) map.values.push_back(v.norm());
  return map;
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

void MapOptions::check() const {
  if (!(focus_radius_px >= 0) || std::isinf(focus_radius_px)) {
    throw InputError(fmt::format("a focus radius of {} px: expected 0 or more", focus_radius_px));
  }
  for (const int n : {grid.columns, grid.rows}) {
    if (n >= kFewestGridPoints && n <= kMostGridPoints) continue;
    throw InputError(fmt::format("a grid of {}x{}: expected {} to {} columns and rows",
                                 grid.columns, grid.rows, kFewestGridPoints, kMostGridPoints));
  }
  for (const double range : ranges_m) {
    if (range > 0) continue;
    throw InputError(fmt::format("points at {} m: expected a positive distance", range));
  }
}

void MapOptions::checkFocus(const Resolution& image) const {
  DifferenceOptions unweighted;
  unweighted.grid = grid;
  unweighted.focus_radius_px = focus_radius_px;
  const int points = pointsInFocus(image, unweighted);
  if (points >= kFewestFitRays) return;
  throw InputError(
      fmt::format("only {} of the {}x{} points over images of {}x{} pixels are within the focus "
                  "radius, and the alignment needs {}; choose a finer --grid or a larger "
                  "--focus-radius",
                  points, grid.columns, grid.rows, image.width, image.height, kFewestFitRays));
}

std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B) {
  assert(std_A.size() == std_B.size());
  std::vector<double> weights;
  for (std::size_t i = 0; i < std_A.size(); ++i) {
    // 1 / (var_A var_B): a pixel counts where both know it, and falls out where either does not
    // (NaN).
    const double w = 1 / (std_A[i] * std_B[i]);
    weights.push_back(w * w);
  }
  return weights;
}

std::vector<ImageMap> differenceMaps(const ComparedCalibration& a, const ComparedCalibration& b,
                                     const std::vector<ImageMap>& uncertainties,
                                     const MapOptions& options) {
  std::vector<ImageMap> maps;
  const auto& cameras_a = a.calibration.cameras;
  const auto& cameras_b = b.calibration.cameras;
  for (std::size_t c = 0; c < std::min(cameras_a.size(), cameras_b.size()); ++c) {
    // Other sizes are a finding of their own (comparisonFindings()).
    if (!(cameras_a[c].intrinsics.resolution == cameras_b[c].intrinsics.resolution)) continue;
    for (const double range : options.ranges_m) {
      DifferenceOptions difference{range, options.grid, options.focus_radius_px, {}, options.fit};
      const ImageMap* std_a = find(uncertainties, a.label, cameras_a[c].name, range);
      const ImageMap* std_b = find(uncertainties, b.label, cameras_b[c].name, range);
      // A focus radius asked for takes the place of the weights.
      if (options.focus_radius_px == 0 && std_a && std_b) {
        difference.weights = differenceWeights(std_a->values, std_b->values);
        if (!canWeight(difference.weights)) difference.weights.clear();
      }
      if (difference.weights.empty()) options.checkFocus(cameras_a[c].intrinsics.resolution);
      const std::string label = fmt::format("{} - {}", b.label, a.label);
      maps.push_back(differenceMap(cameras_a[c], cameras_b[c], label, difference));
    }
  }
  return maps;
}

}  // namespace plumbline

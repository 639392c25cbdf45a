// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/camera_start.h"

#include <algorithm>
#include <cmath>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

// Of the image's width: 0.2 is a fisheye of 286 degrees over its width, 6 a field of 10 degrees.
// Rungs of 15 % lie inside the basin of the batch that follows.
constexpr double kShortest = 0.2;
constexpr double kLongest = 6;
constexpr double kRung = 1.15;
constexpr double kDefault = 0.7;    // about 70 degrees
constexpr std::size_t kViews = 16;  // as many decide
constexpr double kFlat = 1.02;      // errors closer than this ratio are alike
constexpr double kLoss = 0.02;      // of the image's width: the scale of the Cauchy loss
constexpr double kMiddleOfFov =
    0.9;  // w [rad]; 0 would be a saddle point, the model being even in w

/// Median over views of the error of the view's best pose; a view without pose counts as bad.
double costOf(const Intrinsics& camera, const std::vector<PackedView>& views) {
  PoseRefinementOptions options;
  options.max_iterations = 3;  // the order of the rungs shows by then
  options.gram.cauchy_px = kLoss * camera.resolution.width;
  std::vector<double> errors;
  for (const PackedView& view : views) {
    const auto pose = homographyPose(camera, view);
    if (!pose) {
      // The error of a corner that cannot be projected (root of kInvalidSquaredError).
      errors.push_back(1e5);
      continue;
    }
    errors.push_back(refinePose({{&camera, view, Transform()}}, *pose, options).errorPx());
  }
  return middleOf(errors);
}

/// At most kViews of the views, evenly over the recording: the time grows with rungs times views.
std::vector<PackedView> spread(const std::vector<PackedView>& views) {
  if (views.size() <= kViews) return views;
  std::vector<PackedView> some;
  for (std::size_t i = 0; i < kViews; ++i) some.push_back(views[i * views.size() / kViews]);
  return some;
}

struct Rung {
  double focal, cost;
};

/// Of the rungs that are as good as the best one that closest to `likely` (as a ratio: rungs are
/// even in the logarithm); then the other local minima, the lowest first. Head-on views make all
/// rungs alike, and `likely` decides.
std::vector<double> bestOf(const std::vector<Rung>& rungs, double likely, int count) {
  const double least = std::ranges::min(rungs, {}, &Rung::cost).cost;
  double first = 0;
  for (const Rung& r : rungs) {
    const bool closer = std::abs(std::log(r.focal / likely)) < std::abs(std::log(first / likely));
    if (r.cost <= kFlat * least && (first == 0 || closer)) first = r.focal;
  }
  std::vector<Rung> minima;
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    const bool below_left = i == 0 || rungs[i].cost <= rungs[i - 1].cost;
    const bool below_right = i + 1 == rungs.size() || rungs[i].cost <= rungs[i + 1].cost;
    if (below_left && below_right && rungs[i].focal != first) minima.push_back(rungs[i]);
  }
  std::ranges::stable_sort(minima, {}, &Rung::cost);
  std::vector<double> candidates = {first};
  for (const Rung& m : minima) {
    if (static_cast<int>(candidates.size()) < count) candidates.push_back(m.focal);
  }
  return candidates;
}

}  // namespace

Intrinsics plainCamera(ProjectionModel projection, DistortionModel distortion,
                       const Resolution& resolution, double focal_px) {
  Intrinsics camera;
  camera.projection_model = projection;
  camera.distortion_model = distortion;
  camera.resolution = resolution;
  camera.projection.resize(static_cast<Eigen::Index>(parameterCount(projection)));
  camera.distortion.setZero(static_cast<Eigen::Index>(parameterCount(distortion)));
  double magnification = 1;  // of the model at its centre, under a focal length of 1
  auto shape = camera.projection.head(camera.projection.size() - 4);
  if (projection == ProjectionModel::kOmni) {
    // x / (xi |p| + z): 1 / (1 + xi) on the axis.
    shape << 1;
    magnification = 0.5;
  } else if (projection == ProjectionModel::kEucm) {
    // x / (alpha d + (1 - alpha) z): 1 on the axis, where d = z.
    shape << 0.5, 1;
  } else if (projection == ProjectionModel::kDs) {
    shape << -0.2, 0.6;  // the magnification of the first sphere is 1 / (1 + xi)
    magnification = 1 / 0.8;
  }
  if (distortion == DistortionModel::kFov) {
    camera.distortion[0] = kMiddleOfFov;
    // atan(2 r tan(w / 2)) / w has this slope at r = 0.
    magnification *= 2 * std::tan(0.5 * kMiddleOfFov) / kMiddleOfFov;
  }
  const double focal = focal_px / magnification;
  camera.projection.tail<4>() << focal, focal, 0.5 * (resolution.width - 1),
      0.5 * (resolution.height - 1);
  return camera;
}

std::vector<double> focalCandidates(ProjectionModel projection, DistortionModel distortion,
                                    const Resolution& resolution,
                                    const std::vector<PackedView>& views, int count) {
  const std::vector<PackedView> some = spread(views);
  std::vector<Rung> rungs;
  const double likely = kDefault * resolution.width;
  if (some.empty()) return {likely};
  for (double f = kShortest; f < kLongest; f *= kRung) {
    const double focal = f * resolution.width;
    const Intrinsics camera = plainCamera(projection, distortion, resolution, focal);
    // The floor keeps kFlat a ratio of errors that mean something where corners have no noise.
    rungs.push_back({focal, costOf(camera, some) + kNoiseFloorPx});
  }
  return bestOf(rungs, likely, count);
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/camera_start.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

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

/// T_AB of two cameras from every frame in which both have a pose.
std::vector<Transform> relativePoses(const CameraPoses& a, const CameraPoses& b) {
  std::vector<Transform> all;
  for (std::size_t f = 0; f < a.size(); ++f) {
    if (a[f] && b[f]) all.push_back(*a[f] * b[f]->inverse());
  }
  return all;
}

struct Edge {
  std::size_t from = 0, to = 0, shared = 0;
};

/// The edge with most shared frames from a camera that is reached to one that is not (a step of
/// Prim's algorithm). Empty (shared == 0) where no frame joins the two sides.
Edge widestEdge(const std::vector<CameraPoses>& poses, const std::vector<bool>& reached) {
  Edge best;
  for (std::size_t from = 0; from < poses.size(); ++from) {
    for (std::size_t to = 0; to < poses.size(); ++to) {
      if (!reached[from] || reached[to]) continue;
      const std::size_t shared = relativePoses(poses[from], poses[to]).size();
      if (shared > best.shared) best = {from, to, shared};
    }
  }
  return best;
}

Failure noOverlap(const std::vector<std::string>& names, const std::vector<bool>& reached) {
  std::vector<std::string> together;
  std::vector<std::string> apart;
  for (std::size_t c = 0; c < names.size(); ++c) {
    (reached[c] ? together : apart).push_back(names[c]);
  }
  return {FailureCode::kCamerasShareNoFrame, {{"apart", apart}, {"together", together}}};
}

/// Of some of them, the one with the least sum of distances to all.
Transform mostCentral(const std::vector<Transform>& transforms) {
  constexpr std::size_t kTried = 16;
  const std::size_t n = transforms.size();
  Transform best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(kTried, n); ++i) {
    // Steps of the golden ratio, so that gross errors at regular distances are not all that is
    // tried; one and the same may be tried twice.
    const double share = std::fmod(std::numbers::phi * static_cast<double>(i), 1.0);
    const Transform& candidate =
        transforms[static_cast<std::size_t>(share * static_cast<double>(n))];
    double sum = 0;
    for (const Transform& T : transforms) sum += boxminus(T, candidate).norm();
    if (!(sum < least)) continue;
    least = sum;
    best = candidate;
  }
  return best;
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

Transform medianTransform(const std::vector<Transform>& transforms) {
  assert(!transforms.empty());
  // The first will do, unless it is a gross error: half a turn away the others' rotation vectors
  // point either way.
  constexpr double kGross_rad = 1;
  Transform middle = transforms.front();
  const Transform central = mostCentral(transforms);
  if (rotationAngle(middle.R.transpose() * central.R) > kGross_rad) middle = central;
  // Rotation vectors add like vectors only about a common reference that is close: the median
  // itself, found anew from its own tangent.
  for (int round = 0; round < 3; ++round) {
    std::vector<double> d[6];
    for (const Transform& T : transforms) {
      const Vector6d x = boxminus(T, middle);
      for (int k = 0; k < 6; ++k) d[k].push_back(x[k]);
    }
    Vector6d step;
    for (int k = 0; k < 6; ++k) step[k] = middleOf(d[k]);
    middle = boxplus(middle, step);
  }
  return middle;
}

Result<std::vector<Transform>> extrinsicsFromPoses(const std::vector<CameraPoses>& poses,
                                                   const std::vector<std::string>& names) {
  std::vector<Transform> T_C0Ci(poses.size());
  std::vector<bool> reached(poses.size(), false);
  reached[0] = true;
  for (std::size_t left = poses.size() - 1; left > 0; --left) {
    const Edge edge = widestEdge(poses, reached);
    if (edge.shared == 0) return noOverlap(names, reached);
    const Transform T = medianTransform(relativePoses(poses[edge.from], poses[edge.to]));
    T_C0Ci[edge.to] = T_C0Ci[edge.from] * T;
    reached[edge.to] = true;
  }
  return T_C0Ci;
}

}  // namespace plumbline

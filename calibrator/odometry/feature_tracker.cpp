// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/feature_tracker.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/camera/camera.h"

namespace plumbline {
namespace {

constexpr float kCrowdedPx = 8;      // two tracks closer than this are taken for one
constexpr double kParallel = 1e-12;  // two normals that give no direction
constexpr int kSearchLevel = 2;      // of the pyramids, at which an epipolar line is searched
constexpr int kKnownLevels = 2;      // for a match whose distance is known

}  // namespace

void FeatureTrackerOptions::check() const {
  requireOption(levels >= 1 && levels <= 8, "levels", levels, "1 to 8");
  requirePositive("epipolar_px", epipolar_px);
  requireOption(max_tracks >= 8, "max_tracks", max_tracks, "8 or more");
  requireOption(ransac_rounds >= 1, "ransac_rounds", ransac_rounds, "1 or more");
  requirePositive("nearest_m", nearest_m);
  corners.check();
  patch.check();
}

FeatureTracker::FeatureTracker(RigModel rig, FeatureTrackerOptions options)
    : rig_(std::move(rig)), options_(options) {
  options_.check();
}

FrameTracks FeatureTracker::track(TimeNs t, std::span<const GrayImageView> images,
                                  const Eigen::Matrix3d& R_before_now) {
  now_.clear();
  for (const GrayImageView& image : images) {
    now_.push_back(image.empty() ? ImagePyramid() : ImagePyramid(image, options_.levels));
  }
  if (!before_.empty()) follow(R_before_now);
  addCorners();
  FrameTracks out;
  out.t = t;
  for (const Feature& f : features_) out.points.push_back({f.id, 0, f.at.cast<double>()});
  for (std::size_t c = 1; c < now_.size(); ++c) {
    if (!now_[c].empty()) matchInto(c, out);
  }
  before_ = std::move(now_);
  return out;
}

void FeatureTracker::follow(const Eigen::Matrix3d& R_before_now) {
  const Eigen::Matrix3d& R_SC = rig_.T_SC[0].R;
  // The IMU's rotation in axes of camera 0; what translation adds the search finds.
  const Eigen::Matrix3d R_now_before = (R_SC.transpose() * R_before_now * R_SC).transpose();
  std::vector<Feature> moved;
  std::vector<Eigen::Vector3d> before;
  for (const Feature& f : features_) {
    const auto guess = project(rig_.cameras[0], R_now_before * f.ray);
    if (!guess) continue;
    const auto place = trackThereAndBack(before_[0], now_[0], f.at, guess->cast<float>(),
                                         options_.levels, options_.patch);
    const auto ray = place ? unproject(rig_.cameras[0], place->cast<double>()) : std::nullopt;
    if (!ray) continue;
    // Older tracks come first: of two that have run together the younger one goes.
    const bool crowded = std::any_of(moved.begin(), moved.end(), [&](const Feature& other) {
      return (other.at - *place).squaredNorm() < kCrowdedPx * kCrowdedPx;
    });
    if (crowded) continue;
    moved.push_back({f.id, *place, *ray, f.inverse_depth});
    before.push_back(f.ray);
  }
  keepOneMotion(moved, before, R_now_before);
  features_ = std::move(moved);
}

/// A point moves in the plane of its turned ray and the camera's translation: its normal
/// n = f_now x R f_before is normal to the translation, which two tracks give. Nothing is dropped
/// where too few are there, or agree, to vote. The seed is the number of tracks: same images, same
/// result.
void FeatureTracker::keepOneMotion(std::vector<Feature>& moved,
                                   const std::vector<Eigen::Vector3d>& before,
                                   const Eigen::Matrix3d& R_now_before) const {
  const std::size_t n = moved.size();
  if (n < 8) return;
  const double focal = pixelsPerRadian(rig_.cameras[0]);
  const double limit = options_.epipolar_px / focal;
  std::vector<Eigen::Vector3d> normals(n);
  for (std::size_t i = 0; i < n; ++i) {
    normals[i] = moved[i].ray.cross(R_now_before * before[i]);
  }
  std::mt19937_64 random(n);
  std::vector<char> best(n, 0);
  std::size_t most = 0;
  for (int round = 0; round < options_.ransac_rounds; ++round) {
    const Eigen::Vector3d axis = normals[random() % n].cross(normals[random() % n]);
    if (axis.norm() < kParallel) continue;
    const Eigen::Vector3d direction = axis.normalized();
    std::vector<char> fits(n, 0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      // n is the ray's displacement turned by 90 degrees: along the direction it is what leaves the
      // epipolar plane, [rad] for rays across the direction.
      const double across = direction.cross(moved[i].ray).norm();
      // A floor near the epipole, where the ray is along the direction and any displacement would
      // count.
      fits[i] = std::abs(normals[i].dot(direction)) < limit * std::max(across, 0.05);
      count += fits[i] != 0;
    }
    if (count > most) most = count, best = std::move(fits);
  }
  if (most < 6) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (best[i] != 0) moved[kept++] = moved[i];
  }
  moved.resize(kept);
}

void FeatureTracker::addCorners() {
  std::vector<Eigen::Vector2f> taken;
  for (const Feature& f : features_) taken.push_back(f.at);
  for (const Eigen::Vector2f& at : pickCorners(now_[0].level(0), taken, options_.corners)) {
    const auto ray = unproject(rig_.cameras[0], at.cast<double>());
    if (static_cast<int>(features_.size()) >= options_.max_tracks) return;
    if (ray) features_.push_back({next_id_++, at, *ray, std::nullopt});
  }
}

/// The inverse depth at which the feature looks most alike along its epipolar line, about a pixel
/// of the search's level apart: across the baseline an inverse depth rho moves it by
/// focal |t| rho pixels. From infinity (rho = 0) to the nearest depth.
std::optional<double> FeatureTracker::searched(const Feature& f, std::size_t camera,
                                               const Transform& T_C0) const {
  const Intrinsics& lens = rig_.cameras[camera];
  const double pixel = (1 << kSearchLevel) / pixelsPerRadian(lens) / T_C0.t.norm();  // [1/m]
  std::optional<double> best;
  float most = options_.patch.min_correlation;
  for (double rho = 0; rho < 1 / options_.nearest_m; rho += pixel) {
    const auto place = project(lens, T_C0.R * f.ray + rho * T_C0.t);
    if (!place) continue;
    const float alike =
        patchCorrelation(now_[0], now_[camera], f.at, place->cast<float>(), kSearchLevel);
    if (alike > most) most = alike, best = rho;
  }
  return best;
}

void FeatureTracker::matchInto(std::size_t camera, FrameTracks& out) {
  const Transform T_C0 = rig_.T_SC[camera].inverse() * rig_.T_SC[0];  // camera 0 in this one
  const double focal = pixelsPerRadian(rig_.cameras[camera]);
  for (Feature& f : features_) {
    const bool known = f.inverse_depth.has_value();
    const auto depth = known ? f.inverse_depth : searched(f, camera, T_C0);
    f.inverse_depth.reset();
    if (!depth) continue;
    const auto guess = project(rig_.cameras[camera], T_C0.R * f.ray + *depth * T_C0.t);
    if (!guess) continue;
    const auto place = trackThereAndBack(now_[0], now_[camera], f.at, guess->cast<float>(),
                                         known ? kKnownLevels : kSearchLevel + 1, options_.patch);
    const auto ray = place ? unproject(rig_.cameras[camera], place->cast<double>()) : std::nullopt;
    if (!ray) continue;
    const Eigen::Vector3d turned = T_C0.R * f.ray;
    const Eigen::Vector3d normal = turned.cross(T_C0.t).normalized();
    if (!(std::abs(ray->dot(normal)) < options_.epipolar_px / focal)) continue;
    // turned + rho t is along ray:  rho = (turned x ray) . (ray x t) / |ray x t|^2.
    const Eigen::Vector3d across = ray->cross(T_C0.t);
    const double rho = turned.cross(*ray).dot(across) / across.squaredNorm();
    // [1/m]. A far point may come out behind infinity by the noise of its place; it is put there.
    const double noise = options_.epipolar_px / focal / T_C0.t.norm();
    if (!(rho > -noise && rho < 1 / options_.nearest_m)) continue;
    f.inverse_depth = std::max(rho, 0.0);
    out.points.push_back({f.id, static_cast<int>(camera), place->cast<double>()});
  }
}

}  // namespace plumbline

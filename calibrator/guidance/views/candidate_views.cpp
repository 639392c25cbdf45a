// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/candidate_views.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/motion.h"

namespace plumbline {
namespace {

// Rays further out would put a fisheye's camera so near that the target fills its image only by
// grazing sight, where tags are not detected.
constexpr double kWidestRay = 60 * kDegree;

/// Tangent of the angle off the axis at which the camera sees a pixel `share` of half the image's
/// width right of its principal point. A ray that the model does not know is taken as the next one
/// inside that it does.
double tangentOf(const Intrinsics& camera, double share) {
  const Eigen::Vector2d centre = camera.projection.tail<2>();
  // Inwards from the share asked for: a distortion that folds back leaves its outermost pixels
  // without a ray.
  for (; share > 0.05; share *= 0.9) {
    const double u = centre.x() + share * 0.5 * camera.resolution.width;
    const auto ray = unproject(camera, {u, centre.y()});
    if (!ray) continue;
    const double angle = std::atan2(ray->head<2>().norm(), ray->z());
    return std::tan(std::min(angle, kWidestRay));
  }
  return 1;
}

/// Makes the candidates of one camera.
class Maker {
 public:
  Maker(const CameraCalibration& camera, int index, const AprilGrid& target,
        const CandidateViewOptions& options)
      : index_(index), half_(0.5 * target.width(), 0.5 * target.height()), options_(options) {
    depth_ = half_.maxCoeff() / tangentOf(camera.intrinsics, options.fill);
    T_CiC0_ = camera.T_C0Ci.inverse();
  }

  std::vector<CandidateView> all() {
    for (std::size_t i = 0; i < options_.depths.size(); ++i) {
      const double depth = options_.depths[i];
      // The whole grid at one depth only: about a hundred candidates are scored within a frame's
      // time.
      frontal(i == 0 ? options_.grid : 3, depth);
      tilted(depth, 0);
      for (const double roll : options_.rolls_deg) {
        add({0, 0, depth * depth_}, "x +0.00 y +0.00", depth, roll);
        if (i == 0) tilted(depth, roll);
      }
    }
    return std::move(views_);
  }

 private:
  void frontal(int grid, double depth) {
    for (int row = 0; row < grid; ++row) {
      for (int column = 0; column < grid; ++column) {
        const auto place = [&](int i) {
          return grid > 1 ? options_.reach * (2.0 * i / (grid - 1) - 1) : 0;
        };
        const double x = place(column);
        const double y = place(row);
        add({x * half_.x(), y * half_.y(), depth * depth_},
            fmt::format("x {:+.2f} y {:+.2f}", x, y), depth, 0);
      }
    }
  }

  void tilted(double depth, double roll) {
    for (const double angle : options_.tilts_deg) {
      for (const double sign : {-1, 1}) {
        const double side = depth * depth_ * std::sin(sign * angle * kDegree);
        const double ahead = depth * depth_ * std::cos(angle * kDegree);
        add({0, side, ahead}, fmt::format("tilt-x {:+.0f}", sign * angle), depth, roll);
        add({side, 0, ahead}, fmt::format("tilt-y {:+.0f}", sign * angle), depth, roll);
      }
    }
  }

  void add(const Eigen::Vector3d& offset, const std::string& where, double depth, double roll) {
    const Eigen::Vector3d centre(half_.x(), half_.y(), 0);
    std::string name = fmt::format("cam{} {}", index_, where);
    if (depth != options_.depths.front()) name += fmt::format(" depth {:.2f}", depth);
    if (roll != 0) name += fmt::format(" roll {:.0f}", roll);
    Transform T_FCi = lookingAt(centre + offset, centre);
    // On the right: about the camera's own axis.
    T_FCi.R *= expSO3(roll * kDegree * Eigen::Vector3d::UnitZ());
    views_.push_back({std::move(name), index_, T_FCi * T_CiC0_});
  }

  int index_;
  Eigen::Vector2d half_;  // of the target [m]
  const CandidateViewOptions& options_;
  double depth_ = 1;  // [m]
  Transform T_CiC0_;
  std::vector<CandidateView> views_;
};

}  // namespace

void CandidateViewOptions::check() const {
  requireOption(grid >= 1, "grid", grid, "1 or more");
  requireOption(reach > 0, "reach", reach, "a positive factor");
  requireOption(fill > 0, "fill", fill, "a positive share");
  requireOption(!depths.empty(), "number of depths", depths.size(), "1 or more");
  for (const double depth : depths) requireOption(depth > 0, "depth", depth, "a positive factor");
  for (const double tilt : tilts_deg) {
    // At 90 degrees the camera is in the target's plane.
    requireOption(tilt >= 0 && tilt < 90, "tilt [deg]", tilt, "a value from 0 to below 90");
  }
}

std::vector<CandidateView> candidateViews(const std::vector<CameraCalibration>& cameras,
                                          const AprilGrid& target,
                                          const CandidateViewOptions& options) {
  options.check();
  std::vector<CandidateView> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    std::vector<CandidateView> own = Maker(cameras[c], static_cast<int>(c), target, options).all();
    std::move(own.begin(), own.end(), std::back_inserter(all));
  }
  return all;
}

std::vector<CandidateView> firstViews(const CameraCalibration& camera, const AprilGrid& target) {
  std::vector<CandidateView> views = candidateViews({camera}, target);
  std::erase_if(views, [](const CandidateView& view) {
    return !view.name.starts_with("cam0 tilt-") || !view.name.ends_with("45 depth 0.75");
  });
  assert(!views.empty());
  return views;
}

}  // namespace plumbline

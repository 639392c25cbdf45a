// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// A body's pose at one instant: p_W = q p_B + p. `q` is Hamilton, as it was read: not normalised,
/// for ov_eval's figures stand on unnormalised quaternions. transform() normalises.
struct StampedPose {
  TimeNs t = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  Transform transform() const { return {q, p}; }
};

/// Poses in the order of their stamps (not descending; equal stamps may occur and are reported by
/// whoever pairs them).
struct Trajectory {
  std::string name;
  std::vector<StampedPose> poses;
  /// Whether the source had orientations (leica0 has none; then every q is the identity).
  bool has_orientation = true;
  /// Of each pose, tangent (dt, da) of Transform [m, rad]; empty, or one per pose.
  std::vector<Matrix6d> covariances;
};

}  // namespace plumbline

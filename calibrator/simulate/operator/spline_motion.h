// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/simulate/motion.h"

namespace plumbline {

/// A motion through control poses that may be added while it goes on: a uniform cubic B-spline, of
/// positions in F and, cumulatively, of rotations (Sommer et al., 2020). Twice continuously
/// differentiable; with B the moving frame,
///   p(u) = p_i + sum_{j=1..3} l_j(u) (p_{i+j} - p_{i+j-1}),
///   R(u) = R_i prod_{j=1..3} Exp(l_j(u) Log(R_{i+j-1}^T R_{i+j})),
/// l_1 = (5 + 3u - 3u^2 + u^3) / 6, l_2 = (1 + 3u + 3u^2 - 2u^3) / 6, l_3 = u^3 / 6, u in [0, 1)
/// within segment i = floor(t / spacing). Consecutive rotations differ by less than pi.
class SplineMotion {
 public:
  explicit SplineMotion(double spacing_s) : spacing_s_(spacing_s) {}

  std::size_t size() const { return poses_.size(); }
  void add(const Transform& T_FB) { poses_.push_back(T_FB); }

  /// Until when at() is known: (size - 3) spacing, 0 with fewer than four poses.
  double knownUntilS() const;

  /// State at t_s, moved into [0, knownUntilS()): beyond its ends the motion is that of the ends.
  /// At least four poses.
  MotionState at(double t_s) const;

 private:
  double spacing_s_;
  std::vector<Transform> poses_;
};

}  // namespace plumbline

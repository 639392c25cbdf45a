// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to visible_tags.cpp: a tag's four corners projected W lanes at a time. Everything is
// always_inline, so that the function into which it is inlined decides on the instruction set.

#include <cstddef>
#include <cstring>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/camera/lanes.h"
#include "calibrator/camera/pinhole.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Where the four corners of a tag are seen [px].
struct PredictedTag {
  double u[4], v[4];
};

/// Corners that a camera would see, in memory that the next view uses again.
class PredictedCorners {
 public:
  /// Takes up to `most` corners.
  explicit PredictedCorners(int most);
  void clear() { count_ = 0; }
  /// The corners first, first + 1 ... of a tag, at (x, y, z) of F [m] (four of each).
  void add(int first, const double* const (&xyz)[3], const PredictedTag& seen) {
    double* row = columns_.data() + count_;
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      std::memcpy(row + axis * stride_, xyz[axis], sizeof seen.u);
    }
    std::memcpy(row + 3 * stride_, seen.u, sizeof seen.u);
    std::memcpy(row + 4 * stride_, seen.v, sizeof seen.v);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      row[5 * stride_ + i] = 1;
      ids_[static_cast<std::size_t>(count_ + i)] = first + i;
    }
    count_ += 4;
  }
  /// All that was added, each with weight 1; valid until the next change.
  PackedView view();

 private:
  int stride_;
  int count_ = 0;
  std::vector<double> columns_;  // x y z u v w
  std::vector<int> ids_;
};

}  // namespace plumbline

namespace plumbline::tags {

/// What makes a tag visible in a camera.
struct Bounds {
  CameraValues lens;
  double squared_radius_limit;  ///< of X/Z, Y/Z: where a pinhole's distortion folds
  double least_px;              ///< of u and of v
  double right_px, bottom_px;   ///< most of u, of v
  double squared_side_px;       ///< least of a tag's sides
};

/// Points of the camera frame [m].
template <int W>
struct Points {
  Lanes<W> X, Y, Z;
};

template <int W, class Mask>
[[gnu::always_inline]] inline bool all(const Mask& mask) {
  auto both = mask[0];
  for (int i = 1; i < W; ++i) both &= mask[i];
  return both != 0;
}

template <int W>
[[gnu::always_inline]] inline Points<W> pointsOf(const Transform& T_CF,
                                                 const double* const (&xyz)[3], int i) {
  const Eigen::Matrix3d& R = T_CF.R;
  const Eigen::Vector3d& t = T_CF.t;
  const Lanes<W> x = load<W>(xyz[0] + i);
  const Lanes<W> y = load<W>(xyz[1] + i);
  const Lanes<W> z = load<W>(xyz[2] + i);
  return {R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + t[0],
          R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + t[1],
          R(2, 0) * x + R(2, 1) * y + R(2, 2) * z + t[2]};
}

/// Whether the model projects all of the points one-to-one.
template <int W, class Distortion>
[[gnu::always_inline]] inline bool areInDomain(Pinhole<Distortion>, const Bounds& bounds,
                                               const Points<W>& p) {
  return all<W>((p.Z > 0.0) & (p.X * p.X + p.Y * p.Y < bounds.squared_radius_limit * p.Z * p.Z));
}
template <int W, class Model>
[[gnu::always_inline]] inline bool areInDomain(Model, const Bounds& bounds, const Points<W>& p) {
  for (int i = 0; i < W; ++i) {
    if (!Model::isInDomain(bounds.lens.k.data(), p.X[i], p.Y[i], p.Z[i])) return false;
  }
  return true;
}

/// Writes the pixels of W points; whether all of them are in the domain and in the image.
template <int W, class Model>
[[gnu::always_inline]] inline bool projectInto(const Bounds& bounds, const Points<W>& p, double* u,
                                               double* v) {
  if (!areInDomain<W>(Model{}, bounds, p)) return false;
  const CameraValues& lens = bounds.lens;
  const auto m = Model::image(lens.k.data(), p.X, p.Y, p.Z);
  const Lanes<W> pixel_u = lens.fu * m.x + lens.pu;
  const Lanes<W> pixel_v = lens.fv * m.y + lens.pv;
  store<W>(u, pixel_u);
  store<W>(v, pixel_v);
  return all<W>((pixel_u >= bounds.least_px) & (pixel_u <= bounds.right_px) &
                (pixel_v >= bounds.least_px) & (pixel_v <= bounds.bottom_px));
}

[[gnu::always_inline]] inline bool hasLongSides(const PredictedTag& tag, double least_squared) {
  bool all_long = true;
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    const double du = tag.u[(i + 1) % 4] - tag.u[i];
    const double dv = tag.v[(i + 1) % 4] - tag.v[i];
    all_long &= du * du + dv * dv >= least_squared;
  }
  return all_long;
}

/// The target's corners by id, in F [m].
struct Corners {
  const double* x;
  const double* y;
  const double* z;
  int count;
};

/// Adds the tags that are visible with the target at T_CF.
template <int W, class Model>
[[gnu::always_inline]] inline void predict(const Bounds& bounds, const Corners& target,
                                           const Transform& T_CF, PredictedCorners& into) {
  for (int first = 0; first < target.count; first += 4) {
    const double* const xyz[3] = {target.x + first, target.y + first, target.z + first};
    PredictedTag tag;
    bool seen = true;
    for (int i = 0; i < 4 && seen; i += W) {
      seen = projectInto<W, Model>(bounds, pointsOf<W>(T_CF, xyz, i), tag.u + i, tag.v + i);
    }
    if (seen && hasLongSides(tag, bounds.squared_side_px)) into.add(first, xyz, tag);
  }
}

}  // namespace plumbline::tags

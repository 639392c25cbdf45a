// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/visible_tags.h"

#include <cstring>
#include <limits>

#include "calibrator/camera/lanes.h"

namespace plumbline {
namespace {

/// A pinhole's limit is searched for once; other models have closed forms.
template <class Distortion>
double squaredRadiusLimit(Pinhole<Distortion>, const double* k) {
  return Distortion::squaredRadiusLimit(k);
}
template <class Model>
double squaredRadiusLimit(Model, const double*) {
  return std::numeric_limits<double>::infinity();
}

/// A tag's corners side by side.
using Tag = Lanes<4>;
using TagMask = decltype(Tag{} < Tag{});

Tag load(const double* from) {
  Tag tag;
  std::memcpy(&tag, from, sizeof tag);
  return tag;
}

bool all(const TagMask& mask) { return mask[0] && mask[1] && mask[2] && mask[3]; }

/// Points of the camera frame [m].
struct TagPoints {
  Tag X, Y, Z;
};

template <class Distortion>
bool isInDomain(Pinhole<Distortion>, const double*, const TagPoints& p, double limit) {
  return all((p.Z > 0.0) & (p.X * p.X + p.Y * p.Y < limit * p.Z * p.Z));
}
template <class Model>
bool isInDomain(Model, const double* k, const TagPoints& p, double) {
  for (int i = 0; i < 4; ++i) {
    if (!Model::isInDomain(k, p.X[i], p.Y[i], p.Z[i])) return false;
  }
  return true;
}

bool hasLongSides(const Tag& u, const Tag& v, double least_squared) {
  for (int i = 0; i < 4; ++i) {
    const double du = u[(i + 1) % 4] - u[i];
    const double dv = v[(i + 1) % 4] - v[i];
    if (!(du * du + dv * dv >= least_squared)) return false;
  }
  return true;
}

}  // namespace

PredictedCorners::PredictedCorners(int most)
    : stride_((most + kLanes - 1) / kLanes * kLanes),
      columns_(static_cast<std::size_t>(5 * stride_)),
      ids_(static_cast<std::size_t>(stride_)) {}

void PredictedCorners::add(int id, double x, double y, double u, double v) {
  double* row = columns_.data() + count_;
  row[0] = x;
  row[stride_] = y;
  row[2 * stride_] = u;
  row[3 * stride_] = v;
  row[4 * stride_] = 1;
  ids_[static_cast<std::size_t>(count_)] = id;
  ++count_;
}

PackedView PredictedCorners::view() {
  PackedView view;
  view.count = count_;
  view.padded = (count_ + kLanes - 1) / kLanes * kLanes;
  double* all = columns_.data();
  for (int i = count_; i < view.padded; ++i) {
    for (int column = 0; column < 4; ++column) {
      all[column * stride_ + i] = all[column * stride_ + count_ - 1];
    }
    all[4 * stride_ + i] = 0;
  }
  view.x = all;
  view.y = all + stride_;
  view.u = all + 2 * stride_;
  view.v = all + 3 * stride_;
  view.w = all + 4 * stride_;
  view.id = ids_.data();
  return view;
}

VisibleTags::VisibleTags(const Intrinsics& camera, const AprilGrid& target, const Limits& limits)
    : model_(cameraModelOf(camera)),
      lens_(camera),
      squared_radius_limit_(std::visit(
          [this](auto model) { return squaredRadiusLimit(model, lens_.k.data()); }, model_)),
      border_px_(limits.border_px),
      squared_side_(limits.min_tag_px * limits.min_tag_px),
      right_px_(camera.resolution.width - 1 - limits.border_px),
      bottom_px_(camera.resolution.height - 1 - limits.border_px) {
  for (int id = 0; id < target.cornerCount(); ++id) {
    x_.push_back(target.corner(id).x());
    y_.push_back(target.corner(id).y());
  }
}

void VisibleTags::predict(const Transform& T_CF, PredictedCorners& into) const {
  into.clear();
  const double ahead_of_target = -T_CF.R.col(2).dot(T_CF.t);  // z of the camera in F
  if (!(ahead_of_target > 0)) return;
  std::visit([&](auto model) { predictAs(model, T_CF, into); }, model_);
}

template <class Model>
void VisibleTags::predictAs(Model model, const Transform& T_CF, PredictedCorners& into) const {
  const double* k = lens_.k.data();
  const Eigen::Matrix3d& R = T_CF.R;
  const Eigen::Vector3d& t = T_CF.t;
  for (int first = 0; first < cornerCount(); first += 4) {
    const Tag x = load(x_.data() + first);
    const Tag y = load(y_.data() + first);
    const TagPoints p{R(0, 0) * x + R(0, 1) * y + t[0], R(1, 0) * x + R(1, 1) * y + t[1],
                      R(2, 0) * x + R(2, 1) * y + t[2]};
    if (!isInDomain(model, k, p, squared_radius_limit_)) continue;
    const auto m = Model::image(k, p.X, p.Y, p.Z);
    const Tag u = lens_.fu * m.x + lens_.pu;
    const Tag v = lens_.fv * m.y + lens_.pv;
    const bool inside =
        all((u >= border_px_) & (u <= right_px_) & (v >= border_px_) & (v <= bottom_px_));
    if (!inside || !hasLongSides(u, v, squared_side_)) continue;
    for (int i = 0; i < 4; ++i) into.add(first + i, x[i], y[i], u[i], v[i]);
  }
}

}  // namespace plumbline

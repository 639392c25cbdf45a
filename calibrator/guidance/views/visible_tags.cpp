// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/visible_tags.h"

#include <cassert>
#include <limits>
#include <variant>

#include "calibrator/camera/pinhole.h"

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

/// Where a corner counts as seen: within the lens, clear of the image's border, on a tag large
/// enough.
tags::Bounds boundsOf(const Intrinsics& camera, const AnyCameraModel& model,
                      const VisibleTags::Limits& limits) {
  const CameraValues lens(camera);
  return {lens,
          std::visit([&](auto m) { return squaredRadiusLimit(m, lens.k.data()); }, model),
          limits.border_px,
          camera.resolution.width - 1 - limits.border_px,
          camera.resolution.height - 1 - limits.border_px,
          limits.min_tag_px * limits.min_tag_px};
}

// One entry per version: only this function carries the instruction set.
#if defined(__x86_64__)
template <class Model>
[[gnu::target("avx2,fma")]] void predictAvx2(const tags::Bounds& bounds,
                                             const tags::Corners& target, const Transform& T_CF,
                                             PredictedCorners& into) {
  tags::predict<4, Model>(bounds, target, T_CF, into);
}
#endif

template <class Model>
void predictAs(InstructionSet set, const tags::Bounds& bounds, const tags::Corners& target,
               const Transform& T_CF, PredictedCorners& into) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx2) return predictAvx2<Model>(bounds, target, T_CF, into);
#endif
  tags::predict<2, Model>(bounds, target, T_CF, into);
}

}  // namespace

VisibleTags::VisibleTags(const Intrinsics& camera, const AprilGrid& target, const Limits& limits)
    : model_(cameraModelOf(camera)), bounds_(boundsOf(camera, model_, limits)) {
  for (const Eigen::Vector3d& p : cornerPoints(target)) {
    x_.push_back(p.x());
    y_.push_back(p.y());
    z_.push_back(p.z());
  }
}

void VisibleTags::predictWith(InstructionSet set, const Transform& T_CF,
                              PredictedCorners& into) const {
  assert(isAvailable(set));
  into.clear();
  const double ahead_of_target = -T_CF.R.col(2).dot(T_CF.t);  // z of the camera in F
  if (!(ahead_of_target > 0)) return;
  const tags::Corners target{x_.data(), y_.data(), z_.data(), cornerCount()};
  std::visit([&]<class Model>(Model) { predictAs<Model>(set, bounds_, target, T_CF, into); },
             model_);
}

std::vector<Corner> VisibleTags::corners(const Transform& T_CF) const {
  PredictedCorners memory(cornerCount());
  predict(T_CF, memory);
  const PackedView view = memory.view();
  std::vector<Corner> corners;
  for (int i = 0; i < view.count; ++i) corners.push_back({view.id[i], {view.u[i], view.v[i]}});
  return corners;
}

PredictedCorners::PredictedCorners(int most)
    : stride_((most + kLanes - 1) / kLanes * kLanes),
      columns_(static_cast<std::size_t>(6 * stride_)),
      ids_(static_cast<std::size_t>(stride_)) {}

PackedView PredictedCorners::view() {
  PackedView view;
  view.count = count_;
  view.padded = (count_ + kLanes - 1) / kLanes * kLanes;
  double* all = columns_.data();
  // Lanes that fill up repeat the last corner, which the model can project, at weight 0.
  for (int i = count_; i < view.padded; ++i) {
    for (int column = 0; column < 5; ++column) {
      all[column * stride_ + i] = all[column * stride_ + count_ - 1];
    }
    all[5 * stride_ + i] = 0;
  }
  view.x = all;
  view.y = all + stride_;
  view.z = all + 2 * stride_;
  view.u = all + 3 * stride_;
  view.v = all + 4 * stride_;
  view.w = all + 5 * stride_;
  view.id = ids_.data();
  return view;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/visible_tags.h"

#include <cassert>
#include <limits>

#include "calibrator/guidance/tag_kernel.h"

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
  for (int id = 0; id < target.cornerCount(); ++id) {
    x_.push_back(target.corner(id).x());
    y_.push_back(target.corner(id).y());
  }
}

void VisibleTags::predictWith(InstructionSet set, const Transform& T_CF,
                              PredictedCorners& into) const {
  assert(isAvailable(set));
  into.clear();
  const double ahead_of_target = -T_CF.R.col(2).dot(T_CF.t);  // z of the camera in F
  if (!(ahead_of_target > 0)) return;
  const tags::Corners target{x_.data(), y_.data(), cornerCount()};
  std::visit([&]<class Model>(Model) { predictAs<Model>(set, bounds_, target, T_CF, into); },
             model_);
}

PredictedCorners::PredictedCorners(int most)
    : stride_((most + kLanes - 1) / kLanes * kLanes),
      columns_(static_cast<std::size_t>(5 * stride_)),
      ids_(static_cast<std::size_t>(stride_)) {}

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

}  // namespace plumbline

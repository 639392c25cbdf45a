// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/visible_tags.h"

#include <array>
#include <limits>

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

template <class Distortion>
bool isInDomain(Pinhole<Distortion>, const double*, const Eigen::Vector3d& p, double limit) {
  return p.z() > 0 && p.head<2>().squaredNorm() < limit * p.z() * p.z();
}
template <class Model>
bool isInDomain(Model, const double* k, const Eigen::Vector3d& p, double) {
  return Model::isInDomain(k, p.x(), p.y(), p.z());
}

}  // namespace

PredictedCorners::PredictedCorners(int most)
    : stride_((most + kLanes - 1) / kLanes * kLanes),
      columns_(static_cast<std::size_t>(5 * stride_)),
      ids_(static_cast<std::size_t>(stride_)) {}

void PredictedCorners::add(int id, const Eigen::Vector2d& target, const Eigen::Vector2d& uv) {
  double* row = columns_.data() + count_;
  row[0] = target.x();
  row[stride_] = target.y();
  row[2 * stride_] = uv.x();
  row[3 * stride_] = uv.y();
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
  for (int id = 0; id < target.cornerCount(); ++id) corners_.push_back(target.corner(id));
}

void VisibleTags::predict(const Transform& T_CF, PredictedCorners& into) const {
  into.clear();
  const double ahead_of_target = -T_CF.R.col(2).dot(T_CF.t);  // z of the camera in F
  if (!(ahead_of_target > 0)) return;
  std::visit(
      [&]<class Model>(Model model) {
        const double* k = lens_.k.data();
        std::array<Eigen::Vector2d, 4> uv;
        const auto sees = [&](std::size_t corner, const Eigen::Vector2d& p_F) {
          const Eigen::Vector3d p = T_CF.R.leftCols<2>() * p_F + T_CF.t;
          if (!isInDomain(model, k, p, squared_radius_limit_)) return false;
          const auto m = Model::image(k, p.x(), p.y(), p.z());
          uv[corner] = {lens_.fu * m.x + lens_.pu, lens_.fv * m.y + lens_.pv};
          return uv[corner].x() >= border_px_ && uv[corner].y() >= border_px_ &&
                 uv[corner].x() <= right_px_ && uv[corner].y() <= bottom_px_;
        };
        for (std::size_t first = 0; first < corners_.size(); first += 4) {
          bool seen = true;
          for (std::size_t j = 0; j < 4 && seen; ++j) seen = sees(j, corners_[first + j]);
          for (std::size_t j = 0; j < 4 && seen; ++j) {
            seen = (uv[(j + 1) % 4] - uv[j]).squaredNorm() >= squared_side_;
          }
          for (std::size_t j = 0; j < 4 && seen; ++j) {
            into.add(static_cast<int>(first + j), corners_[first + j], uv[j]);
          }
        }
      },
      model_);
}

}  // namespace plumbline

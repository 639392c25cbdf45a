// SPDX-License-Identifier: BSD-3-Clause
// The unknowns of the camera-IMU batch: where they stand, and how a step moves them.
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

BorderLayout::BorderLayout(const CameraImuEstimate& estimate, bool free_cameras) {
  const std::size_t count = estimate.cameras.size();
  for (std::size_t c = 0; free_cameras && c < count; ++c) {
    intrinsics.push_back(size);
    size += static_cast<int>(estimate.cameras[c].intrinsics.stacked().size());
  }
  for (std::size_t c = 0; free_cameras && c < count; ++c) {
    T_C0Ci.push_back(c == 0 ? -1 : size);
    if (c > 0) size += 6;
  }
  for (std::size_t c = 0; c < count; ++c) {
    own_offset.push_back(estimate.hasOwnOffset(c) ? size : -1);
    if (estimate.hasOwnOffset(c)) ++size;
  }
}

CameraImuEstimate moved(const CameraImuEstimate& estimate, const ChainSolution& step,
                        bool free_cameras) {
  CameraImuEstimate out = estimate;
  for (std::size_t i = 0; i < out.states.size(); ++i) {
    out.states[i] = boxplus(estimate.states[i], step.step[i]);
  }
  const Eigen::VectorXd& border = step.border_step;
  out.T_SC0 = boxplus(estimate.T_SC0, Vector6d(border.segment<6>(BorderLayout::kExtrinsics)));
  out.gravity_direction = boxplusDirection(
      estimate.gravity_direction, Eigen::Vector2d(border.segment<2>(BorderLayout::kGravity)));
  out.time_offset_s += border(BorderLayout::kOffset);
  const BorderLayout layout(estimate, free_cameras);
  for (std::size_t c = 0; c < out.offset_differences_s.size(); ++c) {
    if (estimate.hasOwnOffset(c)) *out.offset_differences_s[c] += border(layout.own_offset[c]);
  }
  if (!free_cameras) return out;
  for (std::size_t c = 0; c < out.cameras.size(); ++c) {
    Intrinsics& k = out.cameras[c].intrinsics;
    const Eigen::VectorXd stacked = k.stacked();
    k.setStacked(stacked + border.segment(layout.intrinsics[c], stacked.size()));
    if (layout.T_C0Ci[c] < 0) continue;
    out.cameras[c].T_C0Ci =
        boxplus(estimate.cameras[c].T_C0Ci, Vector6d(border.segment<6>(layout.T_C0Ci[c])));
  }
  return out;
}

}  // namespace plumbline

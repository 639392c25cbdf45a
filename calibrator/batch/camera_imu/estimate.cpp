// SPDX-License-Identifier: BSD-3-Clause
// The unknowns of the camera-IMU batch: where they stand, and how a step moves them.
#include <algorithm>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {
namespace {

/// Interpolated sample and its slope at an instant; those of the nearest interval beyond the ends.
struct Reading {
  Eigen::Vector3d gyro, accel;
  Eigen::Vector3d gyro_slope, accel_slope;  // per second
};

Reading readingAt(const std::vector<ImuSample>& samples, TimeNs frame, double after_frame_s) {
  const TimeNs t = frame + toNanoseconds(after_frame_s);
  auto next = std::ranges::upper_bound(samples, t, {}, &ImuSample::t);
  // A delay of milliseconds may lead past the last sample though its frame is covered.
  next = std::clamp(next, samples.begin() + 1, samples.end() - 1);
  const ImuSample& a = *(next - 1);
  const double interval = secondsBetween(a.t, next->t);
  // The rounded stamp chooses the interval alone; the place in it is exact.
  const double s = secondsBetween(a.t, frame) + after_frame_s;
  Reading r;
  r.gyro_slope = (next->gyro - a.gyro) / interval;
  r.accel_slope = (next->accel - a.accel) / interval;
  r.gyro = a.gyro + s * r.gyro_slope;
  r.accel = a.accel + s * r.accel_slope;
  return r;
}

}  // namespace

BorderLayout::BorderLayout(const CameraImuEstimate& estimate, bool free_cameras) {
  const std::size_t count = estimate.cameras.size();
  for (std::size_t c = 0; free_cameras && c < count; ++c) {
    intrinsics.push_back(size);
    size += static_cast<int>(estimate.cameras[c].intrinsics.stacked().size());
  }
  for (std::size_t c = 0; free_cameras && c < count; ++c) {
    // Camera 0 is the rig's frame.
    T_C0Ci.push_back(c == 0 ? -1 : size);
    if (c > 0) size += 6;
  }
  for (std::size_t c = 0; c < count; ++c) {
    const bool own = hasOwnOffset(estimate.time_offsets, c);
    own_offset.push_back(own ? size : -1);
    if (own) ++size;
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
  const BorderLayout layout(estimate, free_cameras);
  // A camera's own column is its difference to camera 0, so that the chain's IMU intervals, which
  // hang on camera 0's offset alone, keep one column.
  for (std::size_t c = 0; c < out.time_offsets.size(); ++c) {
    double& offset = out.time_offsets[c].s;
    offset += border(BorderLayout::kOffset);
    if (hasOwnOffset(estimate.time_offsets, c)) offset += border(layout.own_offset[c]);
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

double exposureDelay(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                     std::size_t i, std::size_t c) {
  double delay = 0;
  if (!problem.view_stamps.empty()) {
    const Frame& frame = problem.frames[i];
    delay = secondsBetween(frame.t, problem.view_stamps[c][frame.view[c]]);
  }
  return delay + (estimate.timeOffset(c) - estimate.timeOffset());
}

ExposurePose exposurePose(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                          std::size_t i, double delay_s) {
  const ImuState& state = estimate.states[i];
  const double d = delay_s;
  const Reading m =
      readingAt(problem.samples, problem.frames[i].t, estimate.timeOffset() + 0.5 * d);
  const Eigen::Matrix3d& R = state.T_FS.R;
  const Eigen::Vector3d w = m.gyro - state.gyro_bias;
  const Eigen::Vector3d force_F = R * (m.accel - state.accel_bias);
  const Eigen::Vector3d a = force_F + problem.gravity_m_s2 * estimate.gravity_direction;
  const Eigen::Matrix3d turn = R * leftJacobianSO3(w * d);  // of w d, on the left in F
  const double half = 0.5 * d * d;

  ExposurePose out;
  // Rate and acceleration half-way through the delay: the midpoint rule, whose error is of third
  // order. A change of t_d moves that reading by its slope; one of the delay by half as much.
  out.T_FS = {R * expSO3(w * d), state.T_FS.t + d * state.v_F + half * a};
  out.by_state.setZero();
  out.by_state.leftCols<6>().setIdentity();
  // A turn a of R on the left passes through to the pose, and turns the force: a x force_F =
  // -[force_F]x a. Biases are taken off the readings, hence their minus.
  out.by_state.block<3, 3>(0, 3) = -half * skew(force_F);
  out.by_state.block<3, 3>(0, 6) = d * Eigen::Matrix3d::Identity();
  out.by_state.block<3, 3>(3, 9) = -d * turn;
  out.by_state.block<3, 3>(0, 12) = -half * R;
  out.by_calibration.setZero();
  out.by_calibration.block<3, 2>(0, BorderLayout::kGravity) =
      half * problem.gravity_m_s2 * tangentBasis(estimate.gravity_direction);
  out.by_calibration.col(BorderLayout::kOffset) << half * (R * m.accel_slope),
      d * (turn * m.gyro_slope);
  out.by_delay << state.v_F + d * a + 0.5 * half * (R * m.accel_slope),
      turn * (w + 0.5 * d * m.gyro_slope);
  return out;
}

MovedView movedView(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                    const GramOptions& gram, const ViewIndex& index) {
  const auto [i, c] = index;
  const CameraCalibration& camera = estimate.cameras[c];
  const ExposurePose pose =
      exposurePose(problem, estimate, i, exposureDelay(problem, estimate, i, c));
  const CameraImuChain chain = cameraImuChain(pose.T_FS, estimate.T_SC0, camera.T_C0Ci);
  Eigen::Matrix<double, 6, MovedView::kIntrinsics> A;
  A << chain.A_FS * pose.by_state, chain.A_FS * pose.by_calibration, chain.A_FS * pose.by_delay,
      chain.A_C0Ci;
  // by_calibration leaves T_SC0 zero: it moves the camera on the sensor, not the sensor.
  A.middleCols<6>(MovedView::kFixed) += chain.A_SC0;

  // The view's Gram matrix is of the camera's own pose: A carries it to the columns, so that the
  // corners are visited once, whatever moves the camera.
  const PackedView view = problem.corners[c].view(problem.frames[i].view[c]);
  ViewGram g;
  if (problem.free_cameras) {
    g = viewGram(camera.intrinsics, chain.T_CiF, view, gram);
  } else {
    // The cheaper kernel: held intrinsics have no columns.
    static_cast<PoseGram&>(g) = poseGram(camera.intrinsics, chain.T_CiF, view, gram);
  }
  constexpr int n = MovedView::kIntrinsics;
  const Eigen::Index k = g.b_k.size();
  MovedView out;
  out.H = Eigen::MatrixXd::Zero(n + k, n + k);
  out.H.topLeftCorner(n, n) = A.transpose() * g.H * A;
  if (k > 0) {
    out.H.topRightCorner(n, k) = A.transpose() * g.H_pose_k;
    out.H.bottomLeftCorner(k, n) = out.H.topRightCorner(n, k).transpose();
    out.H.bottomRightCorner(k, k) = g.H_k;
  }
  out.b.resize(n + k);
  out.b.head(n) = A.transpose() * g.b;
  if (k > 0) out.b.tail(k) = g.b_k;
  out.cost = g.cost;
  out.squared_error = g.squared_error;
  return out;
}

Transform targetInCamera(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                         std::size_t i, std::size_t c) {
  const double delay = exposureDelay(problem, estimate, i, c);
  const Transform T_FS =
      delay == 0 ? estimate.states[i].T_FS : exposurePose(problem, estimate, i, delay).T_FS;
  return (T_FS * estimate.T_SC0 * estimate.cameras[c].T_C0Ci).inverse();
}

}  // namespace plumbline

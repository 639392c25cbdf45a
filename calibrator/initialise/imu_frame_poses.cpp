// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/imu_frame_poses.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "calibrator/base/lie.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/tangent.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

constexpr int kCornersOfStart = 24;  // as many, evenly spread, are enough for a start

struct PlanarPoint {
  Eigen::Vector2d target;
  Eigen::Vector2d image;  // normalised
};

std::vector<PlanarPoint> planarPoints(const Intrinsics& camera, const PackedView& view) {
  std::vector<PlanarPoint> points;
  const int count = std::min(view.count, kCornersOfStart);
  for (int k = 0; k < count; ++k) {
    const int i = count == view.count ? k : k * view.count / count;
    const auto ray = unproject(camera, {view.u[i], view.v[i]});
    if (!ray || ray->z() < 0.05) continue;
    points.push_back({{view.x[i], view.y[i]}, ray->head<2>() / ray->z()});
  }
  return points;
}

/// H with image ~ H (target - centre), scaled to H(2, 2) = 1: the centre lies in front.
std::optional<Eigen::Matrix3d> homography(const std::vector<PlanarPoint>& points,
                                          const Eigen::Vector2d& centre) {
  Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b = Eigen::Matrix<double, 8, 1>::Zero();
  for (const PlanarPoint& p : points) {
    const Eigen::Vector3d X(p.target.x() - centre.x(), p.target.y() - centre.y(), 1);
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix<double, 8, 1> row = Eigen::Matrix<double, 8, 1>::Zero();
      row.segment<3>(3 * axis) = X;
      row.tail<2>() = -p.image(axis) * X.head<2>();
      A += row * row.transpose();
      b += row * p.image(axis);
    }
  }
  const Eigen::LDLT<Eigen::Matrix<double, 8, 8>> ldlt(A);
  if (ldlt.info() != Eigen::Success || ldlt.rcond() < 1e-14) return std::nullopt;
  const Eigen::Matrix<double, 8, 1> h = ldlt.solve(b);
  if (!h.allFinite()) return std::nullopt;
  Eigen::Matrix3d H;
  H << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1;
  return H;
}

double rmsOf(double squared_error, int corners) {
  return corners > 0 ? std::sqrt(squared_error / corners) : 0;
}

}  // namespace

std::optional<Transform> planarPose(const Intrinsics& camera, const PackedView& view) {
  const auto points = planarPoints(camera, view);
  if (points.size() < 4) return std::nullopt;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const PlanarPoint& p : points) centre += p.target / static_cast<double>(points.size());
  const auto H = homography(points, centre);
  if (!H) return std::nullopt;
  const double scale = 2 / (H->col(0).norm() + H->col(1).norm());
  Eigen::Matrix3d R;
  R << scale * H->col(0), scale * H->col(1), scale * scale * H->col(0).cross(H->col(1));
  Transform T_CF;
  T_CF.R = nearestRotation(R);
  T_CF.t = scale * H->col(2) - T_CF.R * Eigen::Vector3d(centre.x(), centre.y(), 0);
  return T_CF;
}

RefinedPose refineViewPose(const Intrinsics& camera, const PackedView& view, const Transform& T_CF,
                           int iterations) {
  RefinedPose best{T_CF, 0};
  PoseGram gram = poseGram(camera, T_CF, view);
  for (int i = 0; i < iterations; ++i) {
    const Vector6d x = -gram.H.ldlt().solve(gram.b);
    if (!x.allFinite()) break;
    const Eigen::Matrix3d turn = expSO3(x.tail<3>());
    const Transform moved(turn * best.pose.R, turn * best.pose.t + x.head<3>());
    const PoseGram next = poseGram(camera, moved, view);
    if (!(next.cost < gram.cost)) break;
    const bool settled = gram.cost - next.cost < 1e-9 * gram.cost;
    best.pose = moved;
    gram = next;
    if (settled) break;
  }
  best.rms_px = rmsOf(gram.squared_error, view.count);
  return best;
}

std::optional<Transform> framePose(const std::vector<CameraCalibration>& cameras,
                                   const std::vector<PackedCorners>& corners, const Frame& frame,
                                   double max_rms_px) {
  std::size_t most = cameras.size();
  int total = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (frame.view[c] < 0) continue;
    const int count = corners[c].view(frame.view[c]).count;
    total += count;
    if (most == cameras.size() || count > corners[most].view(frame.view[most]).count) most = c;
  }
  if (most == cameras.size()) return std::nullopt;
  const auto start = planarPose(cameras[most].intrinsics, corners[most].view(frame.view[most]));
  if (!start) return std::nullopt;
  Transform T_FC0 = (cameras[most].T_C0Ci * *start).inverse();
  double last = 0;
  for (int iteration = 0; iteration < 5; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    double cost = 0;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (frame.view[c] < 0) continue;
      const CameraChain chain = cameraChain(T_FC0, cameras[c].T_C0Ci);
      const PoseGram g =
          poseGram(cameras[c].intrinsics, chain.T_CiF, corners[c].view(frame.view[c]));
      H += chain.A_FC0.transpose() * g.H * chain.A_FC0;
      b += chain.A_FC0.transpose() * g.b;
      cost += g.cost;
    }
    const bool settled = iteration > 0 && cost > 0.99 * last;
    last = cost;
    if (settled) break;
    const Vector6d d = -H.ldlt().solve(b);
    if (!d.allFinite()) return std::nullopt;
    T_FC0 = boxplus(T_FC0, d);
  }
  if (!(rmsOf(last, total) < max_rms_px)) return std::nullopt;
  return T_FC0;
}

}  // namespace plumbline

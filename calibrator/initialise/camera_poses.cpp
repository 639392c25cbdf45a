// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/camera_poses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calibrator/base/option_check.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/initialise/dense_steps.h"
#include "calibrator/linear/levenberg_marquardt.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

constexpr int kCornersOfStart = 16;  // evenly spread, they are enough for a start
constexpr int kFewCorners = 16;      // up to here the mirrored pose is tried
constexpr int kParts = 8;            // of a view that are tried by themselves
constexpr double kLine = 1e-5;       // corners closer to a line than this (squared) give no pose
constexpr double kLeastRcond = 1e-12;

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

struct RayPoint {
  Eigen::Vector2d target;
  Eigen::Vector3d ray;
};

/// At most kCornersOfStart of the used corners, evenly over the view. Corners without a ray are
/// left out.
std::vector<RayPoint> rayPoints(const Intrinsics& camera, const PackedView& view) {
  std::vector<int> used;
  for (int i = 0; i < view.count; ++i) {
    if (view.w[i] > 0) used.push_back(i);
  }
  const auto count = static_cast<int>(used.size());
  const int taken = std::min(count, kCornersOfStart);
  std::vector<RayPoint> points;
  for (int k = 0; k < taken; ++k) {
    const int i = used[static_cast<std::size_t>(k * count / taken)];
    const auto ray = unproject(camera, {view.u[i], view.v[i]});
    if (ray) points.push_back({{view.x[i], view.y[i]}, *ray});
  }
  return points;
}

struct Homography {
  Eigen::Matrix3d H;  // ray ~ H (target - centre) / scale
  Eigen::Vector2d centre;
  double scale = 1;
};

/// In a frame whose z axis is the mean ray, where H(2, 2), the depth of the target's centre, is
/// positive: scaled to 1. Two rows of ray x H X = 0 for each corner,
///   r_z (h_axis . X) - r_axis (h_2 . X) = 0,   axis x and y,
/// in least squares. Target coordinates about their centre and over their RMS spread keep the 8 x 8
/// system well conditioned (as Hartley 1997). Empty for corners on a line.
std::optional<Homography> solveHomography(const std::vector<RayPoint>& points,
                                          const Eigen::Matrix3d& R_ZC) {
  Homography out;
  const auto n = static_cast<double>(points.size());
  out.centre.setZero();
  for (const RayPoint& p : points) out.centre += p.target / n;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const RayPoint& p : points) {
    spread += (p.target - out.centre) * (p.target - out.centre).transpose() / n;
  }
  // det / trace^2 is the ratio of the variances across and along, where one is small.
  if (!(spread.determinant() > kLine * spread.trace() * spread.trace())) return std::nullopt;
  out.scale = std::sqrt(spread.trace());
  Matrix8d A = Matrix8d::Zero();
  Vector8d b = Vector8d::Zero();
  for (const RayPoint& p : points) {
    const Eigen::Vector2d q = (p.target - out.centre) / out.scale;
    const Eigen::Vector3d X(q.x(), q.y(), 1);
    const Eigen::Vector3d r = R_ZC * p.ray;
    // Sums of row row^T and row r_axis over both rows (r_z X, 0, -r_x q), (0, r_z X, -r_y q).
    const Eigen::Matrix3d XX = X * (r.z() * r.z() * X).transpose();
    const Eigen::Matrix<double, 2, 3> qX = -r.z() * q * X.transpose();
    const double across = r.head<2>().squaredNorm();
    A.block<3, 3>(0, 0) += XX;
    A.block<3, 3>(3, 3) += XX;
    A.block<2, 3>(6, 0) += r.x() * qX;
    A.block<2, 3>(6, 3) += r.y() * qX;
    A.block<2, 2>(6, 6) += across * q * q.transpose();
    b.segment<3>(0) += r.z() * r.x() * X;
    b.segment<3>(3) += r.z() * r.y() * X;
    b.tail<2>() -= across * q;
  }
  const SymmetricFactor factor(A);
  // A bound of the condition from below, which is enough to tell corners that give no homography.
  const Vector8d D = factor.pivots();
  if (!factor.succeeded() || !(D.minCoeff() > kLeastRcond * D.maxCoeff())) {
    return std::nullopt;
  }
  const Vector8d h = factor.solve(b);
  if (!h.allFinite()) return std::nullopt;
  out.H << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1;
  return out;
}

/// Sums of all views in the left twist of T_C0F.
PoseGram frameGram(const std::vector<FrameView>& views, const Transform& T_C0F,
                   const GramOptions& options) {
  PoseGram sum;
  for (const FrameView& v : views) {
    const PoseGram g = poseGram(*v.camera, v.T_CiC0 * T_C0F, v.view, options);
    const Matrix6d A = adjoint(v.T_CiC0);  // twists of C0 to those of Ci
    const Matrix6d AtH = A.transpose().lazyProduct(g.H);
    sum.H.noalias() += AtH.lazyProduct(A);
    sum.b.noalias() += A.transpose().lazyProduct(g.b);
    sum.cost += g.cost;
  }
  return sum;
}

double countUsed(const std::vector<FrameView>& views) {
  double count = 0;
  for (const FrameView& v : views) count += v.view.used();
  return count;
}

Eigen::Vector2d centreOf(const PackedView& view) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (int i = 0; i < view.count; ++i) centre += Eigen::Vector2d(view.x[i], view.y[i]);
  return centre / std::max(1, view.count);
}

/// Runs of consecutive corners, which lie close together on the target. For homographyPose(), which
/// does not look at z and edge; those are not moved along.
std::vector<PackedView> partsOf(const PackedView& view) {
  std::vector<PackedView> parts;
  const int size = kCornersOfStart;
  const int count = std::min(kParts, view.count / size);
  for (int k = 0; k < count && count > 1; ++k) {
    const int first = k * (view.count - size) / (count - 1);
    PackedView part = view;
    part.count = size;
    part.padded = size;
    for (const double** column : {&part.x, &part.y, &part.u, &part.v, &part.w}) *column += first;
    part.id += first;
    parts.push_back(part);
  }
  return parts;
}

}  // namespace

double rmsWidth(const std::vector<FrameView>& views) {
  double squares = 0, corners = 0;
  for (const FrameView& v : views) {
    const double width = v.camera->resolution.width;
    squares += v.view.count * width * width;
    corners += v.view.count;
  }
  return corners > 0 ? std::sqrt(squares / corners) : 0;
}

double PoseRefinement::errorPx() const { return corners > 0 ? std::sqrt(cost / corners) : 0; }

double errorPx(const std::vector<FrameView>& views, const Transform& T_C0F,
               const GramOptions& options) {
  PoseRefinement as_it_stands{.T_C0F = T_C0F, .corners = countUsed(views)};
  for (const FrameView& v : views) {
    as_it_stands.cost += viewCost(*v.camera, v.T_CiC0 * T_C0F, v.view, options);
  }
  return as_it_stands.errorPx();
}

std::optional<Transform> homographyPose(const Intrinsics& camera, const PackedView& view) {
  const std::vector<RayPoint> points = rayPoints(camera, view);
  if (points.size() < 4) return std::nullopt;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  for (const RayPoint& p : points) axis += p.ray;
  const Eigen::Matrix3d R_ZC = shortestTurn(axis, Eigen::Vector3d::UnitZ());
  const auto h = solveHomography(points, R_ZC);
  if (!h) return std::nullopt;
  const Eigen::Vector3d x = h->H.col(0) / h->scale;
  const Eigen::Vector3d y = h->H.col(1) / h->scale;
  // H = (r_x, r_y, t) up to scale: the first two columns of a rotation have length 1. The target is
  // in front, since H(2, 2) > 0.
  const double scale = 2 / (x.norm() + y.norm());
  Eigen::Matrix3d R_ZF;
  R_ZF << scale * x, scale * y, scale * scale * x.cross(y);
  Transform T_CF;
  T_CF.R = R_ZC.transpose() * nearestRotation(R_ZF);
  T_CF.t = R_ZC.transpose() * (scale * h->H.col(2)) -
           T_CF.R * Eigen::Vector3d(h->centre.x(), h->centre.y(), 0);
  if (!T_CF.R.allFinite() || !T_CF.t.allFinite()) return std::nullopt;
  return T_CF;
}

Transform mirroredPose(const Transform& T_CF, const Eigen::Vector2d& centre) {
  const Eigen::Vector3d C(centre.x(), centre.y(), 0);
  const Eigen::Vector3d p = T_CF * C;
  const Eigen::Vector3d sight = p.normalized();
  const Eigen::Vector3d normal = T_CF.R.col(2);
  // Half a turn about the line of sight moves the normal to its mirror image; so does the shortest
  // turn, which leaves the picture of the target nearly as it was.
  const Eigen::Vector3d mirrored = 2 * sight.dot(normal) * sight - normal;
  Transform other;
  other.R = shortestTurn(normal, mirrored) * T_CF.R;
  other.t = p - other.R * C;
  return other;
}

void PoseRefinementOptions::check() const {
  requireAtLeast(0, "max_iterations", max_iterations);
  requirePositive("tolerance", tolerance);
}

PoseRefinement refinePose(const std::vector<FrameView>& views, const Transform& T_C0F,
                          const PoseRefinementOptions& options) {
  options.check();
  DenseSteps steps(
      T_C0F, [&](const Transform& T) { return frameGram(views, T, options.gram); },
      [](const Transform& T, const Vector6d& x) { return twisted(T, x); });
  MinimiserOptions minimiser;
  minimiser.max_iterations = options.max_iterations;
  minimiser.tolerance = options.tolerance;
  const MinimiserSummary summary = minimise(steps, minimiser);
  return {steps.point(), steps.sums().cost, countUsed(views), summary.converged(), steps.sums().H};
}

std::optional<PoseRefinement> findPose(const std::vector<FrameView>& views, double good_px,
                                       const PoseRefinementOptions& options) {
  if (views.empty()) return std::nullopt;
  const FrameView& most =
      *std::ranges::max_element(views, {}, [](const FrameView& view) { return view.view.count; });
  const Transform T_C0Ci = most.T_CiC0.inverse();
  std::optional<PoseRefinement> best;
  // The least cost over all views decides, not that of the view that gave the start.
  const auto attempt = [&](const Transform& T_CiF) {
    const PoseRefinement pose = refinePose(views, T_C0Ci * T_CiF, options);
    if (!best || pose.cost < best->cost) best = pose;
  };
  const auto whole = homographyPose(*most.camera, most.view);
  if (whole) attempt(*whole);
  // The error of a plane's pose has two minima, mirror images of each other, which come close where
  // the plane is small in the image (Schweighofer and Pinz, PAMI 2006). No descent crosses from one
  // to the other.
  if (whole && most.view.count <= kFewCorners) {
    attempt(mirroredPose(*whole, centreOf(most.view)));
  }
  if (best && best->errorPx() <= good_px) return best;
  for (const PackedView& part : partsOf(most.view)) {
    const auto start = homographyPose(*most.camera, part);
    if (start) attempt(*start);
    if (best && best->errorPx() <= good_px) break;
  }
  return best;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

// Sums over pairs of points (x, y) that every alignment by positions needs.
struct PointMoments {
  Eigen::Vector3d mean_x = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_y = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_yx = Eigen::Matrix3d::Zero();  ///< mean of (y - mean)(x - mean)^T
  double variance_x = 0;                                    ///< mean of |x - mean|^2
  double variance_y = 0;
};

// The proper rotation R and the factor c that minimise sum |y - (c R x + t)|^2 with
// t = mean_y - c R mean_x (Umeyama, PAMI 1991, eqs. 40-42). `across` is the second singular value
// of covariance_yx over the first: where it is zero the points of x or y lie on a line and R is
// not unique.
struct Similarity {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double scale = 1;
  double across = 0;
};

Similarity bestSimilarity(const PointMoments& moments) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments.covariance_yx,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  const Eigen::Vector3d& d = svd.singularValues();
  // Umeyama's S = diag(1, 1, +-1): without it points that lie in a plane, or are noisy, may be
  // fitted best by a reflection.
  const double handed = U.determinant() * V.determinant() < 0 ? -1 : 1;
  Similarity best;
  best.R = U * Eigen::Vector3d(1, 1, handed).asDiagonal() * V.transpose();
  if (d[0] > 0) best.across = d[1] / d[0];
  if (moments.variance_x > 0) best.scale = (d[0] + d[1] + handed * d[2]) / moments.variance_x;
  return best;
}

// The angle [rad] about z that minimises sum |y - (Rz x + t)|^2: it maximises tr(Rz^T C) for
// C = covariance_yx (Zhang and Scaramuzza, IROS 2018, eqs. 17 and 18). `strength` is the maximum
// of that trace's horizontal part; zero where no horizontal direction tells the angle.
struct BestYaw {
  double yaw = 0;
  double strength = 0;
};

BestYaw bestYaw(const Eigen::Matrix3d& C) {
  const double sine = C(1, 0) - C(0, 1);
  const double cosine = C(0, 0) + C(1, 1);
  return {std::atan2(sine, cosine), std::hypot(sine, cosine)};
}

constexpr std::size_t kFewestPairs = 3;

// Of singular values of a covariance: squares of the spread across a line over that along it.
constexpr double kLine = 1e-10;

/// Those that least squares over positions determine; the others stand on the first pair, or on
/// none.
bool isFit(AlignmentKind kind) {
  return kind == AlignmentKind::kSe3 || kind == AlignmentKind::kSim3 ||
         kind == AlignmentKind::kScale || kind == AlignmentKind::kYaw;
}

/// x: the estimate's positions, y: the truth's, of the first `count` pairs. Two passes, as sums of
/// squares about zero would cancel far from the origin.
PointMoments momentsOf(const std::vector<PosePair>& pairs, std::size_t count) {
  PointMoments m;
  const auto n = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    m.mean_x += pairs[i].estimate.p / n;
    m.mean_y += pairs[i].truth.p / n;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d x = pairs[i].estimate.p - m.mean_x;
    const Eigen::Vector3d y = pairs[i].truth.p - m.mean_y;
    m.covariance_yx += y * x.transpose() / n;
    m.variance_x += x.squaredNorm() / n;
    m.variance_y += y.squaredNorm() / n;
  }
  return m;
}

Eigen::Matrix3d aboutZ(double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

// With s and R given, the t that brings x onto y.
AlignmentRecord through(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                        const Eigen::Matrix3d& R, double scale) {
  AlignmentRecord record;
  record.scale = scale;
  record.T_truth_estimate = Transform(R, Eigen::Vector3d(y - scale * (R * x)));
  return record;
}

// A square spread below this share of the squared distance from the origin is rounding.
bool standsStill(double variance, const Eigen::Vector3d& mean) {
  return !(variance > 1e-20 * (mean.squaredNorm() + variance)) || variance < 1e-24;
}

Result<AlignmentRecord> fitYaw(const PointMoments& m) {
  const BestYaw best = bestYaw(m.covariance_yx);
  if (!(best.strength > kLine * (m.variance_x + m.variance_y))) {
    return Failure{FailureCode::kNoHorizontalMotion};
  }
  return through(m.mean_x, m.mean_y, aboutZ(best.yaw), 1);
}

Result<AlignmentRecord> fitRotation(const PointMoments& m, bool with_scale) {
  // The bound is of singular values, squares of lengths: a spread of 1e-5 across the line.
  const Similarity best = bestSimilarity(m);
  if (!(best.across > kLine)) {
    return Failure{FailureCode::kPositionsOnALine};
  }
  return through(m.mean_x, m.mean_y, best.R, with_scale ? best.scale : 1);
}

Result<AlignmentRecord> fit(const std::vector<PosePair>& pairs, const AlignmentOptions& o) {
  const std::size_t count =
      o.first_n > 0 ? std::min(pairs.size(), static_cast<std::size_t>(o.first_n)) : pairs.size();
  // Two points leave the rotation about their line free.
  if (count < kFewestPairs) {
    return Failure{FailureCode::kTooFewPairs,
                   {{"aligned", count}, {"pairs", pairs.size()}, {"alignment", toString(o.kind)}}};
  }
  const PointMoments m = momentsOf(pairs, count);
  if (standsStill(m.variance_x, m.mean_x) || standsStill(m.variance_y, m.mean_y)) {
    return Failure{FailureCode::kPositionsStandStill};
  }
  if (o.kind == AlignmentKind::kYaw) return fitYaw(m);
  if (o.kind == AlignmentKind::kScale) {
    // Of the full similarity, applied without its rotation (evo's correct_only_scale).
    AlignmentRecord record;
    record.scale = bestSimilarity(m).scale;
    return record;
  }
  return fitRotation(m, o.kind == AlignmentKind::kSim3);
}

/// R = R_truth R_estimate^T of the first pair, or its best yaw; t brings the first positions
/// together.
Result<AlignmentRecord> alignFirst(const PosePair& first, const AlignmentOptions& o) {
  const Eigen::Matrix3d R_truth = rotationOf(first.truth.q, o.quaternions);
  const Eigen::Matrix3d R_estimate = rotationOf(first.estimate.q, o.quaternions);
  const Eigen::Matrix3d R = R_truth * R_estimate.transpose();
  if (o.kind != AlignmentKind::kYawFirst) return through(first.estimate.p, first.truth.p, R, 1);
  const BestYaw best = bestYaw(R);
  // R is a half turn about a horizontal axis: sine and cosine of the yaw both vanish.
  if (!(best.strength > 1e-9)) {
    return Failure{FailureCode::kUpsideDown};
  }
  return through(first.estimate.p, first.truth.p, aboutZ(best.yaw), 1);
}

}  // namespace

Result<AlignmentRecord> align(const std::vector<PosePair>& pairs, const AlignmentOptions& options) {
  assert(options.first_n >= 0);
  Result<AlignmentRecord> result = AlignmentRecord{};
  if (isFit(options.kind)) {
    result = fit(pairs, options);
  } else if (options.kind != AlignmentKind::kNone) {
    if (pairs.empty()) return Failure{FailureCode::kNoPairs};
    result = alignFirst(pairs.front(), options);
  }
  if (!result) return result;
  result.value().kind = toString(options.kind);
  result.value().first_n = isFit(options.kind) ? options.first_n : 0;
  return result;
}

AlignedPoses alignedPoses(const std::vector<PosePair>& pairs, const AlignmentRecord& alignment,
                          QuaternionUse use) {
  const Transform& T = alignment.T_truth_estimate;
  // By way of quaternions, as ov_eval has it: its figures show the rounding of this product.
  const Eigen::Quaterniond q = shepperdQuaternion(T.R);
  AlignedPoses aligned;
  aligned.truth.reserve(pairs.size());
  aligned.estimate.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d p = alignment.scale * (T.R * pair.estimate.p) + T.t;
    aligned.truth.emplace_back(rotationOf(pair.truth.q, use), pair.truth.p);
    aligned.estimate.emplace_back(rotationOf(q * pair.estimate.q, QuaternionUse::kNormalised), p);
  }
  return aligned;
}

Eigen::Matrix3d rotationOf(const Eigen::Quaterniond& q, QuaternionUse use) {
  const Eigen::Quaterniond r = use == QuaternionUse::kNormalised ? q.normalized() : q;
  return (2 * r.w() * r.w() - 1) * Eigen::Matrix3d::Identity() + 2 * r.w() * skew(r.vec()) +
         2 * r.vec() * r.vec().transpose();
}

Eigen::Quaterniond shepperdQuaternion(const Eigen::Matrix3d& R) {
  // 4 (w^2, x^2, y^2, z^2) of a unit quaternion.
  const double trace = R.trace();
  const Eigen::Vector4d squares(1 + trace, 1 + 2 * R(0, 0) - trace, 1 + 2 * R(1, 1) - trace,
                                1 + 2 * R(2, 2) - trace);
  Eigen::Index largest = 0;
  squares.maxCoeff(&largest);
  const double c = 2 * std::sqrt(squares[largest]);  // four times the component
  const Eigen::Vector3d vee(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  Eigen::Vector4d q;  // w, x, y, z
  if (largest == 0) {
    q << c / 4, vee / c;
  } else {
    const Eigen::Index i = largest - 1;
    q << vee[i] / c, (R.col(i) + R.row(i).transpose()) / c;
    q[largest] = c / 4;
  }
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R) {
  const double trace = R.trace();
  // Within 0.01 rad of a half turn (1 + tr R = 4 cos^2(theta / 2) = theta'^2, theta' = pi - theta)
  // R - R^T vanishes and with it the axis.
  if (trace + 1 < 1e-4) {
    const Eigen::AngleAxisd turn(shepperdQuaternion(R));
    return turn.angle() * turn.axis();
  }
  const Eigen::Vector3d vee(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  // theta^2 = 3 - tr R to second order, and theta / (2 sin theta) = 1/2 + theta^2 / 12.
  if (trace - 3 >= -1e-7) return (0.5 - (trace - 3) / 12) * vee;
  const double theta = std::acos((trace - 1) / 2);
  return theta / (2 * std::sin(theta)) * vee;
}

}  // namespace plumbline

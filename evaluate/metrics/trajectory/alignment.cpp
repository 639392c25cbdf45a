// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

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

/// The scale of the full similarity, applied without its rotation (evo's correct_only_scale).
AlignmentRecord scaleAlone(const PointMoments& m) {
  AlignmentRecord record;
  record.scale = bestSimilarity(m).scale;
  return record;
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
  if (o.kind == AlignmentKind::kScale) return scaleAlone(m);
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

Result<AlignmentRecord> alignUnnamed(const std::vector<PosePair>& pairs,
                                     const AlignmentOptions& o) {
  if (o.kind == AlignmentKind::kNone) return AlignmentRecord{};
  if (isFit(o.kind)) return fit(pairs, o);
  if (pairs.empty()) return Failure{FailureCode::kNoPairs};
  return alignFirst(pairs.front(), o);
}

}  // namespace

Result<AlignmentRecord> align(const std::vector<PosePair>& pairs, const AlignmentOptions& options) {
  assert(options.first_n >= 0);
  Result<AlignmentRecord> result = alignUnnamed(pairs, options);
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

}  // namespace plumbline

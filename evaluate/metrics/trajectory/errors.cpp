// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/errors.h"

#include <cassert>
#include <cmath>

#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/transform.h"
#include "calibrator/dense/decompositions.h"
#include "evaluate/metrics/trajectory/association.h"

namespace plumbline {
namespace {

/// E = R_estimate R_truth^T is the estimate's error in the truth's frame, on the left.
double errorOf(const Transform& estimate, const Transform& truth, AbsoluteMeasure measure) {
  const Eigen::Vector3d d = estimate.t - truth.t;
  if (measure == AbsoluteMeasure::kTranslation) return d.norm();
  if (measure == AbsoluteMeasure::kXy) return d.head<2>().norm();
  const Eigen::Matrix3d E = estimate.R * truth.R.transpose();
  switch (measure) {
    case AbsoluteMeasure::kRotationPart:
      return (E - Eigen::Matrix3d::Identity()).norm();
    case AbsoluteMeasure::kFullTransformation:
      return std::hypot((E - Eigen::Matrix3d::Identity()).norm(), d.norm());
    // The yaw only while the tilt is small, but what ov_eval prints under that name.
    case AbsoluteMeasure::kYawDeg:
      return kDegrees * rotationVector(E).z();
    case AbsoluteMeasure::kHeadingDeg:
      return kDegrees * std::abs(std::atan2(E(1, 0), E(0, 0)));
    default:
      return kDegrees * rotationVector(E).norm();
  }
}

// An estimate whose rotations differ by more from the truth's is of another body frame, or lost.
constexpr double kOtherBodyDeg = 45;
constexpr double kTolerance = 0.1;        // of delta; evo's too
constexpr double kRpgTolerance = 0.2;     // of delta
constexpr double kOvEvalTolerance = 0.5;  // [m]

struct YawPitchRoll {
  double yaw = 0, pitch = 0, roll = 0;
};

// R = Rz(yaw) Ry(pitch) Rx(roll).
YawPitchRoll anglesOf(const Eigen::Matrix3d& R) {
  // By hypot and atan2: asin loses half the digits where the pitch is near 90 degrees.
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  return {std::atan2(R(1, 0), R(0, 0)), std::atan2(-R(2, 0), cos_pitch),
          std::atan2(R(2, 1), R(2, 2))};
}

// Of the angles [deg] that make the same rotation as `angles` those nearest to `near`: whole turns,
// and (roll + 180, 180 - pitch, yaw + 180), into which they go over where the pitch passes 90.
Eigen::Vector3d nearest(const Eigen::Vector3d& angles, const Eigen::Vector3d& near) {
  const auto turned = [&](const Eigen::Vector3d& a) -> Eigen::Vector3d {
    return a + 360 * ((near - a) / 360).array().round().matrix();
  };
  const Eigen::Vector3d one = turned(angles);
  const Eigen::Vector3d other = turned({angles[0] + 180, 180 - angles[1], angles[2] + 180});
  return (one - near).norm() <= (other - near).norm() ? one : other;
}

Eigen::Vector3d degreesOf(const Eigen::Matrix3d& R) {
  const YawPitchRoll angles = anglesOf(R);
  return kDegrees * Eigen::Vector3d(angles.roll, angles.pitch, angles.yaw);
}

/// `R_end`: the estimate's attitude at the end of the motion. Heading and gravity are of E in the
/// estimate's world, R_end E R_end^T (rpg), and mean something only if that world is level.
double measured(const Transform& E, const Eigen::Matrix3d& R_end, RelativeMeasure measure) {
  if (measure == RelativeMeasure::kTranslation) return E.t.norm();
  if (measure == RelativeMeasure::kRotationDeg) return kDegrees * rotationVector(E.R).norm();
  const YawPitchRoll angles = anglesOf(R_end * E.R * R_end.transpose());
  if (measure == RelativeMeasure::kHeadingDeg) return kDegrees * std::abs(angles.yaw);
  return kDegrees * std::hypot(angles.pitch, angles.roll);
}

/// The tolerances that the tools have in their sources; theirs exclude the limit, and let a pose be
/// its own end.
SubTrajectoryRule ruleOf(const RelativeDelta& delta) {
  switch (delta.pairs) {
    case RelativePairs::kRpg:
      return {delta.delta, kRpgTolerance * delta.delta, false, true};
    case RelativePairs::kOvEval:
      return {delta.delta, kOvEvalTolerance, false, true};
    default:
      return {delta.delta, kTolerance * delta.delta};
  }
}

std::vector<double> secondsFromStart(const std::vector<TimeNs>& t) {
  std::vector<double> seconds;
  seconds.reserve(t.size());
  for (const TimeNs stamp : t) seconds.push_back(secondsBetween(t.front(), stamp));
  return seconds;
}

constexpr double kConfidence = 0.95;

/// `sum` of n poses' e^T P^-1 e: with consistent poses a chi-square deviate with n dof degrees of
/// freedom, so the bounds of the mean are its quantiles over n.
NeesRecord recordOf(const char* part, int dof, double sum, std::size_t count) {
  const auto n = static_cast<double>(count);
  const double tail = (1 - kConfidence) / 2;
  NeesRecord record;
  record.part = part;
  record.dof = dof;
  record.mean = sum / n;
  record.lower = chiSquaredQuantile(n * dof, tail) / n;
  record.upper = chiSquaredTailQuantile(n * dof, tail) / n;
  record.confidence = kConfidence;
  if (record.mean > record.upper) record.reading = NeesReading::kOverconfident;
  if (record.mean < record.lower) record.reading = NeesReading::kCautious;
  return record;
}

}  // namespace

Eigen::Vector3d meanOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  return mean;
}

double spreadOf(const std::vector<Eigen::Vector3d>& points) {
  const auto n = static_cast<double>(points.size());
  const Eigen::Vector3d mean = meanOf(points);
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += (p - mean).squaredNorm() / n;
  return std::sqrt(sum);
}

std::vector<double> pathLengths(const std::vector<Transform>& poses) {
  std::vector<double> path(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    path[i] = path[i - 1] + (poses[i].t - poses[i - 1].t).norm();
  }
  return path;
}

std::vector<IndexPair> overlappingFrames(std::size_t poses, std::size_t step) {
  assert(step > 0);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i + step < poses; ++i) pairs.push_back({i, i + step});
  return pairs;
}

std::vector<IndexPair> consecutiveFrames(std::size_t poses, std::size_t step) {
  assert(step > 0);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i + step < poses; i += step) pairs.push_back({i, i + step});
  return pairs;
}

std::vector<IndexPair> subTrajectories(const std::vector<double>& path,
                                       const SubTrajectoryRule& rule) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t from = rule.may_stay ? i : i + 1;
    if (from >= path.size()) break;
    const std::size_t to = firstNearest(path, path[i] + rule.length, from);
    const double miss = std::abs(path[to] - (path[i] + rule.length));
    if (miss < rule.tolerance || (rule.inclusive && miss <= rule.tolerance)) {
      pairs.push_back({i, to});
    }
  }
  return pairs;
}

std::vector<IndexPair> consecutiveSegments(const std::vector<Transform>& poses, double length) {
  std::vector<IndexPair> pairs;
  std::size_t mark = 0;
  bool marked = false;
  double travelled = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    travelled += (poses[i].t - poses[i - 1].t).norm();
    if (travelled < length) continue;
    if (marked) pairs.push_back({mark, i});
    mark = i;
    marked = true;
    // evo drops what the last step went beyond `length`: segments are never shorter, up to a step
    // longer.
    travelled = 0;
  }
  return pairs;
}

std::vector<double> absoluteErrors(const AlignedPoses& poses, AbsoluteMeasure measure) {
  std::vector<double> errors;
  errors.reserve(poses.truth.size());
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    errors.push_back(errorOf(poses.estimate[i], poses.truth[i], measure));
  }
  return errors;
}

std::vector<Eigen::Vector3d> rollPitchYaw(const std::vector<Transform>& poses) {
  std::vector<Eigen::Vector3d> angles;
  for (const Transform& T : poses) {
    const Eigen::Vector3d own = degreesOf(T.R);
    angles.push_back(angles.empty() ? own : nearest(own, angles.back()));
  }
  return angles;
}

std::vector<Eigen::Vector3d> rollPitchYaw(const AlignedPoses& poses,
                                          const std::vector<Eigen::Vector3d>& truth_rpy) {
  assert(poses.estimate.size() == truth_rpy.size());
  // Near a pitch of 90 degrees roll and yaw may differ by much although the rotations do not;
  // carried along, that would keep the angles half a turn from the truth's.
  const bool carried =
      sampleStatistics(absoluteErrors(poses, AbsoluteMeasure::kRotationDeg)).median > kOtherBodyDeg;
  std::vector<Eigen::Vector3d> angles;
  for (std::size_t i = 0; i < poses.estimate.size(); ++i) {
    const Eigen::Vector3d apart = !carried || i == 0 ? Eigen::Vector3d::Zero().eval()
                                                     : (angles.back() - truth_rpy[i - 1]).eval();
    angles.push_back(nearest(degreesOf(poses.estimate[i].R), truth_rpy[i] + apart));
  }
  return angles;
}

std::vector<double> relativeErrors(const AlignedPoses& poses, const std::vector<IndexPair>& pairs,
                                   RelativeMeasure measure) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const auto [i, j] : pairs) {
    const Transform truth = poses.truth[i].inverse() * poses.truth[j];
    const Transform estimate = poses.estimate[i].inverse() * poses.estimate[j];
    errors.push_back(measured(truth.inverse() * estimate, poses.estimate[j].R, measure));
  }
  return errors;
}

bool hasPairsOver(RelativePairs pairs, RelativeDelta::Unit unit) {
  if (pairs == RelativePairs::kPlumbline || unit == RelativeDelta::Unit::kMetres) return true;
  const bool evo = pairs == RelativePairs::kEvo || pairs == RelativePairs::kEvoAll;
  return evo && unit == RelativeDelta::Unit::kFrames;
}

std::vector<IndexPair> pairsOver(const RelativeDelta& delta, const AlignedPoses& poses,
                                 const std::vector<TimeNs>& t) {
  assert(hasPairsOver(delta.pairs, delta.unit));
  const bool evo = delta.pairs == RelativePairs::kEvo;
  if (delta.unit == RelativeDelta::Unit::kFrames) {
    const auto step = static_cast<std::size_t>(delta.delta);
    return evo ? consecutiveFrames(poses.truth.size(), step)
               : overlappingFrames(poses.truth.size(), step);
  }
  if (evo) return consecutiveSegments(poses.estimate, delta.delta);
  const SubTrajectoryRule rule = ruleOf(delta);
  if (delta.unit == RelativeDelta::Unit::kSeconds)
    return subTrajectories(secondsFromStart(t), rule);
  // Along the truth all estimates of a recording are judged on the same segments; along the
  // estimate its own noise and scale choose them.
  const bool along_estimate = delta.pairs == RelativePairs::kEvoAll;
  return subTrajectories(pathLengths(along_estimate ? poses.estimate : poses.truth), rule);
}

RelativeErrorRecord relativeErrorOver(const RelativeDelta& delta, const AlignedPoses& poses,
                                      const std::vector<TimeNs>& t) {
  const std::vector<IndexPair> pairs = pairsOver(delta, poses, t);
  RelativeErrorRecord record;
  record.delta = delta.delta;
  record.unit = toString(delta.unit);
  record.pairs = toString(delta.pairs);
  record.translation_m =
      sampleStatistics(relativeErrors(poses, pairs, RelativeMeasure::kTranslation));
  record.rotation_deg =
      sampleStatistics(relativeErrors(poses, pairs, RelativeMeasure::kRotationDeg));
  return record;
}

Matrix6d alignedCovariance(const Matrix6d& P, const AlignmentRecord& alignment) {
  Matrix6d B = Matrix6d::Zero();
  B.topLeftCorner<3, 3>() = alignment.scale * alignment.T_truth_estimate.R;
  B.bottomRightCorner<3, 3>() = alignment.T_truth_estimate.R;
  return B * P * B.transpose();
}

Nees neesOf(const AlignedPoses& poses, const std::vector<Matrix6d>& covariances) {
  assert(covariances.size() == poses.truth.size());
  Nees nees;
  double position = 0, orientation = 0, pose = 0;
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    const Matrix6d& P = covariances[i];
    const SymmetricFactor factor(P);
    // A factor of NaN may succeed, so it is asked for apart.
    if (!P.allFinite() || !factor.isPositiveDefinite()) {
      ++nees.left_out;
      continue;
    }
    // In the tangent at the estimate, where its covariance is.
    const Vector6d e = boxminus(poses.truth[i], poses.estimate[i]);
    position += SymmetricFactor(P.topLeftCorner<3, 3>()).squaredNorm(e.head<3>());
    orientation += SymmetricFactor(P.bottomRightCorner<3, 3>()).squaredNorm(e.tail<3>());
    pose += factor.squaredNorm(e);
    ++nees.used;
  }
  if (nees.used == 0) return nees;
  // The parts' own blocks of P: marginal covariances, so position and orientation add up to the
  // pose's only where they are uncorrelated.
  nees.parts = {recordOf("position", 3, position, nees.used),
                recordOf("orientation", 3, orientation, nees.used),
                recordOf("pose", 6, pose, nees.used)};
  return nees;
}

}  // namespace plumbline

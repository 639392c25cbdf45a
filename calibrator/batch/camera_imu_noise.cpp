// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrator/batch/parallel_chunks.h"

namespace plumbline {
namespace {

constexpr int kChunk = 64;     // intervals
constexpr int kStretch = 150;  // frames
constexpr int kGroups = 4;     // rotation; velocity and position; gyro walk; accelerometer walk
constexpr double kLeastFactor = 1e-3;
constexpr double kMostFactor = 1e3;
using Groups = Eigen::Array<double, kGroups, 1>;

double limited(double factor) { return std::clamp(factor, kLeastFactor, kMostFactor); }

/// Columns: state i (15), state j without biases (9), gravity (2), offset (1), residual (1).
using MotionRows = Eigen::Matrix<double, 9, 28>;

/// One link, whitened by the assumed densities.
struct Link {
  int at = 0;  ///< of the earlier frame
  bool inertial = false;
  MotionRows motion = MotionRows::Zero();
  Vector6d walk = Vector6d::Zero();         ///< residual
  Vector6d walk_weight = Vector6d::Zero();  ///< Jacobian: - and + this
};

std::optional<std::vector<Link>> linksOf(const CameraImuProblem& problem,
                                         const CameraImuEstimate& estimate,
                                         const ImuWeights& weights) {
  std::vector<Link> links;
  const Gravity gravity{estimate.gravity_direction, problem.gravity_m_s2};
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] == FrameLink::kBroken) continue;
    const ImuState& i = estimate.states[k];
    const ImuState& j = estimate.states[k + 1];
    Link& link = links.emplace_back();
    link.at = static_cast<int>(k);
    link.walk_weight << Eigen::Vector3d::Constant(weights[k].gyro_walk),
        Eigen::Vector3d::Constant(weights[k].accel_walk);
    link.walk = biasWalkResidual(i, j).cwiseProduct(link.walk_weight);
    if (problem.links[k] != FrameLink::kInertial) continue;
    const ImuWindow window{problem.frames[k].t, problem.frames[k + 1].t, estimate.time_offset_s};
    const auto motion = preintegrate(problem.samples, window, {i.gyro_bias, i.accel_bias});
    if (!motion) return std::nullopt;
    const ImuResidual r = imuResidual(*motion, i, j, gravity);
    MotionRows J;
    J << r.J_i, r.J_j, r.J_gravity, r.J_offset, r.r;
    link.motion = weights[k].sqrt_information.lazyProduct(J);
    link.inertial = true;
  }
  return links;
}

/// Factors on the assumed standard deviations.
struct Factors {
  double pixel = 1;
  Groups imu = Groups::Ones();
};

/// A link whitened by the assumed densities times the factors.
Link scaled(Link link, const Groups& factors) {
  link.motion.topRows<3>() /= factors(0);
  link.motion.bottomRows<6>() /= factors(1);
  link.walk.head<3>() /= factors(2);
  link.walk.tail<3>() /= factors(3);
  link.walk_weight.head<3>() /= factors(2);
  link.walk_weight.tail<3>() /= factors(3);
  return link;
}

void addLink(const Link& link, BorderedChain& chain) {
  const auto at = static_cast<std::size_t>(link.at);
  const int last = chain.border();
  const Vector6d information = link.walk_weight.cwiseAbs2();
  const Vector6d b = link.walk_weight.cwiseProduct(link.walk);
  chain.diagonal[at].diagonal().tail<6>() += information;
  chain.next[at].diagonal().tail<6>() -= information;
  chain.diagonal[at + 1].diagonal().tail<6>() += information;
  chain.to_border[at].col(last).tail<6>() -= b;
  chain.to_border[at + 1].col(last).tail<6>() += b;
  if (!link.inertial) return;
  const Eigen::Matrix<double, 28, 28> G = link.motion.transpose().lazyProduct(link.motion);
  constexpr int kGravity = BorderLayout::kGravity;
  chain.diagonal[at] += G.topLeftCorner<15, 15>();
  chain.next[at].leftCols<9>() += G.block<15, 9>(0, 15);
  chain.diagonal[at + 1].topLeftCorner<9, 9>() += G.block<9, 9>(15, 15);
  chain.to_border[at].middleCols<3>(kGravity) += G.block<15, 3>(0, 24);
  chain.to_border[at].col(last) += G.block<15, 1>(0, 27);
  chain.to_border[at + 1].block<9, 3>(0, kGravity) += G.block<9, 3>(15, 24);
  chain.to_border[at + 1].col(last).head<9>() += G.block<9, 1>(15, 27);
  chain.border_block.block<3, 3>(kGravity, kGravity) += G.block<3, 3>(24, 24);
  chain.border_gradient.segment<3>(kGravity) += G.block<3, 1>(24, 27);
}

BorderedChain combined(const BorderedChain& cameras, const std::vector<Link>& links,
                       const Factors& factors) {
  BorderedChain chain = cameras;
  const double scale = 1 / (factors.pixel * factors.pixel);
  for (ChainMatrix& D : chain.diagonal) D *= scale;
  for (ChainBorderRows& C : chain.to_border) C *= scale;
  chain.border_block *= scale;
  chain.border_gradient *= scale;
  for (const Link& link : links) addLink(scaled(link, factors.imu), chain);
  return chain;
}

/// Squared residuals at the optimum under some factors, and what they are expected to be.
struct Evaluation {
  Groups squares = Groups::Zero();
  Groups redundancy = Groups::Zero();
  Groups rows = Groups::Zero();
  double pose_squares = 0;  ///< see poseSquares(), in units of pixel_sigma whatever the factor
};

/// Adds a link's rows, `link` whitened by the factors that gave `inverse`.
void addRows(const Link& link, const ChainInverse& inverse, Evaluation& sum) {
  const auto at = static_cast<std::size_t>(link.at);
  const ChainCovariance& S = inverse.covariance;
  const auto& dx_i = inverse.solution.step[at];
  const auto& dx_j = inverse.solution.step[at + 1];
  const Vector6d walk = link.walk + link.walk_weight.cwiseProduct((dx_j - dx_i).tail<6>());
  const Vector6d variance =
      (S.diagonal[at] + S.diagonal[at + 1] - 2 * S.next[at]).diagonal().tail<6>();
  const Vector6d walk_redundancy =
      (1 - (link.walk_weight.cwiseAbs2().cwiseProduct(variance)).array());
  for (int g = 0; g < 2; ++g) {
    sum.squares(2 + g) += walk.segment<3>(3 * g).squaredNorm();
    sum.redundancy(2 + g) += walk_redundancy.segment<3>(3 * g).sum();
    sum.rows(2 + g) += 3;
  }
  if (!link.inertial) return;
  constexpr int kGravity = BorderLayout::kGravity;
  Eigen::Matrix<double, 27, 27> joint;
  joint.topLeftCorner<15, 15>() = S.diagonal[at];
  joint.block<15, 9>(0, 15) = S.next[at].leftCols<9>();
  joint.block<9, 9>(15, 15) = S.diagonal[at + 1].topLeftCorner<9, 9>();
  joint.block<15, 3>(0, 24) = S.to_border[at].middleCols<3>(kGravity);
  joint.block<9, 3>(15, 24) = S.to_border[at + 1].block<9, 3>(0, kGravity);
  joint.block<3, 3>(24, 24) = S.border.block<3, 3>(kGravity, kGravity);
  joint.triangularView<Eigen::StrictlyLower>() = joint.transpose();
  Eigen::Matrix<double, 27, 1> dx;
  dx << dx_i, dx_j.head<9>(), inverse.solution.border_step.segment<3>(kGravity);
  const auto J = link.motion.leftCols<27>();
  const Vector9d r = link.motion.col(27) + J * dx;
  const Eigen::Matrix<double, 9, 27> JS = J.lazyProduct(joint);
  const Vector9d redundancy = 1 - JS.cwiseProduct(J).rowwise().sum().array();
  sum.squares(0) += r.head<3>().squaredNorm();
  sum.squares(1) += r.tail<6>().squaredNorm();
  sum.redundancy(0) += redundancy.head<3>().sum();
  sum.redundancy(1) += redundancy.tail<6>().sum();
  sum.rows.head<2>() += Eigen::Array2d(3, 6);
}

/// Squared distance of every frame's pose from the one that its corners alone would choose, in the
/// metric of the corners' information: sum of e' H e, e = x + H^-1 (b + C y).
double poseSquares(const BorderedChain& cameras, const ChainSolution& step) {
  const int m = cameras.border();
  double sum = 0;
  for (std::size_t i = 0; i < cameras.diagonal.size(); ++i) {
    const Matrix6d H = cameras.diagonal[i].topLeftCorner<6, 6>();
    const auto& C = cameras.to_border[i];
    const Vector6d g =
        H * step.step[i].head<6>() + C.col(m).head<6>() + C.topLeftCorner(6, m) * step.border_step;
    sum += g.dot(H.ldlt().solve(g));
  }
  return sum;
}

class VarianceComponents {
 public:
  VarianceComponents(BorderedChain cameras, std::vector<Link> links, int threads)
      : cameras_(std::move(cameras)), links_(std::move(links)), threads_(threads) {}

  std::optional<Evaluation> at(const Factors& factors) const {
    const auto inverse = invertChain(combined(cameras_, links_, factors), {0, threads_});
    if (!inverse) return std::nullopt;
    const int count = static_cast<int>(links_.size());
    std::vector<Evaluation> parts(static_cast<std::size_t>(chunkCount(count, kChunk)));
    forChunks(count, kChunk, threads_, [&](const Chunk& chunk) {
      Evaluation& part = parts[static_cast<std::size_t>(chunk.index)];
      for (int k = chunk.begin; k < chunk.end; ++k) {
        addRows(scaled(links_[static_cast<std::size_t>(k)], factors.imu), *inverse, part);
      }
    });
    Evaluation sum;
    for (const Evaluation& part : parts) {
      sum.squares += part.squares;
      sum.redundancy += part.redundancy;
      sum.rows += part.rows;
    }
    sum.pose_squares = poseSquares(cameras_, inverse->solution);
    return sum;
  }

  /// Standard deviation of the corners that the poses show, in units of pixel_sigma. The poses have
  /// 6 rows a frame, and all redundancies add up to the number of rows less that of unknowns.
  double pixelFactor(const Evaluation& e) const {
    const double redundancy = (e.rows - e.redundancy).sum() -
                              (kChainBlock - 6.0) * cameras_.blocks() - BorderLayout::kFixed;
    return limited(std::sqrt(e.pose_squares / std::max(redundancy, 1.0)));
  }

 private:
  BorderedChain cameras_;
  std::vector<Link> links_;
  int threads_;
};

/// The next factors of the densities. Plain estimation would raise the ratio to 1/2; the more
/// converges faster at the usual redundancy of a third to two thirds of the rows.
Groups nextFactors(const Groups& factors, const Groups& ratio) {
  return (factors * ratio.pow(0.7)).max(kLeastFactor).min(kMostFactor);
}

ImuNoiseCheck checkOf(int group, const Evaluation& assumed, const Evaluation& end,
                      const Groups& factors) {
  ImuNoiseCheck check;
  check.expected_rms =
      std::sqrt(std::max(0.0, assumed.redundancy(group)) / std::max(assumed.rows(group), 1.0));
  check.factor = factors(group);
  check.redundancy = end.redundancy(group);
  return check;
}

/// All of n frames, or `most` of them in evenly spread stretches.
std::vector<int> spreadFrames(int n, int most) {
  std::vector<int> frames;
  const int stretches = std::max(2, most / kStretch);
  if (n <= std::max(most, stretches * kStretch)) {
    for (int f = 0; f < n; ++f) frames.push_back(f);
    return frames;
  }
  for (int s = 0; s < stretches; ++s) {
    const int first = s * (n - kStretch) / (stretches - 1);
    for (int f = 0; f < kStretch; ++f) frames.push_back(first + f);
  }
  return frames;
}

/// Leaves the given frames (ascending), cut loose from each other where others lay between them.
void keepOnly(const std::vector<int>& kept, CameraImuProblem& problem,
              CameraImuSolution& solution) {
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto from = static_cast<std::size_t>(kept[k]);  // never before k
    problem.frames[k] = problem.frames[from];
    problem.weights[k] = problem.weights[from];
    solution.estimate.states[k] = solution.estimate.states[from];
    if (k + 1 == kept.size()) break;
    const bool neighbours = kept[k + 1] == kept[k] + 1;
    problem.links[k] = neighbours ? problem.links[from] : FrameLink::kBroken;
    solution.weights[k] = solution.weights[from];
  }
  problem.frames.resize(kept.size());
  problem.weights.resize(kept.size());
  solution.estimate.states.resize(kept.size());
  problem.links.resize(kept.empty() ? 0 : kept.size() - 1);
  solution.weights.resize(problem.links.size());
}

}  // namespace

ImuNoiseChecks checkImuNoise(CameraImuProblem problem, CameraImuSolution solution,
                             const ImuNoiseOptions& options) {
  solution.normals = CameraImuNormals();  // large, and not needed here
  keepOnly(spreadFrames(problem.frameCount(), options.max_frames), problem, solution);
  auto cameras = cameraInformationAt(problem, solution.estimate);
  auto links = linksOf(problem, solution.estimate, solution.weights);
  if (!links) return {};
  const VarianceComponents components(std::move(cameras.chain), std::move(*links), problem.threads);
  Factors factors;
  const auto assumed = components.at(factors);
  if (!assumed) return {};
  Evaluation now = *assumed;
  for (int round = 0; round < options.max_rounds; ++round) {
    const double pixel = components.pixelFactor(now);
    const Groups ratio =
        (now.redundancy >= options.least_redundancy).select(now.squares / now.redundancy, 1.0);
    const double change = std::max(std::abs(std::log(pixel / factors.pixel)),
                                   0.5 * ratio.max(1e-12).log().abs().maxCoeff());
    if (change < options.tolerance) break;
    factors = {pixel, nextFactors(factors.imu, ratio)};
    const auto next = components.at(factors);
    if (!next) return {};
    now = *next;
  }
  return {checkOf(0, *assumed, now, factors.imu), checkOf(1, *assumed, now, factors.imu),
          checkOf(2, *assumed, now, factors.imu), checkOf(3, *assumed, now, factors.imu),
          factors.pixel * problem.pixel_sigma};
}

}  // namespace plumbline

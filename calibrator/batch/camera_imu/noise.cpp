// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/distributions.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

constexpr int kSegment = 100;    // frames
constexpr int kNoiseGroups = 4;  // rotation; velocity and position; gyro walk; accelerometer walk
constexpr double kLeastFactor = 1e-3;
constexpr double kMostFactor = 1e3;
// A group keeps its assumed density where its redundancy is below this, also under the factor that
// it would have; from the other it may move to see where it leads.
constexpr double kLeastRedundancy = 10;
constexpr double kTriedRedundancy = 1;
constexpr double kChance = 1e-3;  // that squares are as large without a cause
// Most recordings need fewer than eight. Beside a noisy IMU poses have little redundancy, and the
// corners' factor moves by a third a round: from 1 px to corners of 0.009 px that takes twenty.
constexpr int kMostRounds = 40;
constexpr double kFactorTolerance =
    0.02;  // end where no factor is asked to change by more, relative
using Groups = Eigen::Array<double, kNoiseGroups, 1>;

/// (J | r)'(J | r) of some rows of a link. Columns: state i (15), state j without biases (9),
/// gravity (2), offset (1), residual (1).
using LinkGram = Eigen::Matrix<double, 28, 28>;
constexpr int kResidual = 27;

/// One link, whitened by the assumed densities.
struct Link {
  int at = 0;  ///< of the earlier frame
  bool inertial = false;
  std::array<LinkGram, 2> motion;           ///< of its rotation rows, of the other six
  Vector6d walk = Vector6d::Zero();         ///< residual
  Vector6d walk_weight = Vector6d::Zero();  ///< Jacobian: - and + this
};

/// Once, at the solution; afterwards only the factors change, and no sample is visited again.
std::optional<std::vector<Link>> linksOf(const CameraImuProblem& problem,
                                         const CameraImuEstimate& estimate,
                                         const ImuWeights& weights) {
  std::vector<Link> links;
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] == FrameLink::kBroken) continue;
    Link& link = links.emplace_back();
    link.at = static_cast<int>(k);
    link.walk_weight = weights[k].walk();
    link.walk =
        biasWalkResidual(estimate.states[k], estimate.states[k + 1]).cwiseProduct(link.walk_weight);
    if (problem.links[k] != FrameLink::kInertial) continue;
    const auto W = motionRows(problem, estimate, weights, k, OffsetDerivative::kExact);
    if (!W) return std::nullopt;
    link.motion[0] = W->topRows<3>().transpose().lazyProduct(W->topRows<3>());
    link.motion[1] = W->bottomRows<6>().transpose().lazyProduct(W->bottomRows<6>());
    link.inertial = true;
  }
  return links;
}

/// Factors on the assumed standard deviations.
struct Factors {
  double pixel = 1;
  Groups imu = Groups::Ones();
};

/// One factor for each row of the biases' walk.
Vector6d walkRows(const Groups& groups) {
  Vector6d rows;
  rows << Eigen::Vector3d::Constant(groups(2)), Eigen::Vector3d::Constant(groups(3));
  return rows;
}

/// Adds a link, each group of its rows times its factor on the information.
void addLink(const Link& link, const Groups& information, BlockArrow& chain) {
  const int at = link.at;
  const int last = chain.border();
  const Vector6d weight = walkRows(information).cwiseProduct(link.walk_weight);
  const Vector6d walk_information = weight.cwiseProduct(link.walk_weight);
  const Vector6d b = weight.cwiseProduct(link.walk);
  chain.diagonal[at].diagonal().tail<6>() += walk_information;
  chain.next[at].diagonal().tail<6>() -= walk_information;
  chain.diagonal[at + 1].diagonal().tail<6>() += walk_information;
  chain.to_border[at].col(last).tail<6>() -= b;
  chain.to_border[at + 1].col(last).tail<6>() += b;
  if (!link.inertial) return;
  const LinkGram G = information(0) * link.motion[0] + information(1) * link.motion[1];
  constexpr int kGravity = BorderLayout::kGravity;
  chain.diagonal[at] += G.topLeftCorner<15, 15>();
  chain.next[at].leftCols<9>() += G.block<15, 9>(0, 15);
  chain.diagonal[at + 1].topLeftCorner<9, 9>() += G.block<9, 9>(15, 15);
  chain.to_border[at].middleCols<3>(kGravity) += G.block<15, 3>(0, 24);
  chain.to_border[at].col(last) += G.block<15, 1>(0, kResidual);
  chain.to_border[at + 1].block<9, 3>(0, kGravity) += G.block<9, 3>(15, 24);
  chain.to_border[at + 1].col(last).head<9>() += G.block<9, 1>(15, kResidual);
  chain.border_block.block<3, 3>(kGravity, kGravity) += G.block<3, 3>(24, 24);
  chain.border_gradient.segment<3>(kGravity) += G.block<3, 1>(24, kResidual);
}

/// The normal equations under other variances: corners over pixel^2, each group of links over its
/// factor squared.
BlockArrow combined(const BlockArrow& cameras, const std::vector<Link>& links,
                    const Factors& factors) {
  BlockArrow chain = cameras;
  const double scale = 1 / (factors.pixel * factors.pixel);
  for (ChainMatrix& D : chain.diagonal) D *= scale;
  for (ChainBorderRows& C : chain.to_border) C *= scale;
  chain.border_block *= scale;
  chain.border_gradient *= scale;
  for (const Link& link : links) addLink(link, factors.imu.square().inverse(), chain);
  return chain;
}

/// Squared residuals at the optimum under some factors, and what they are expected to be.
struct VarianceSums {
  Groups squares = Groups::Zero();
  Groups redundancy = Groups::Zero();
  Groups rows = Groups::Zero();
  double pose_squares = 0;  ///< see poseSquares(), in units of pixel_sigma whatever the factor
};

/// Covariance of the unknowns of link.motion; 0 in the residual's row and column.
LinkGram jointCovariance(int at, const ChainCovariance& S) {
  constexpr int kGravity = BorderLayout::kGravity;
  LinkGram joint = LinkGram::Zero();
  joint.topLeftCorner<15, 15>() = S.diagonal[at];
  joint.block<15, 9>(0, 15) = S.next[at].leftCols<9>();
  joint.block<9, 9>(15, 15) = S.diagonal[at + 1].topLeftCorner<9, 9>();
  joint.block<15, 3>(0, 24) = S.to_border[at].middleCols<3>(kGravity);
  joint.block<9, 3>(15, 24) = S.to_border[at + 1].block<9, 3>(0, kGravity);
  joint.block<3, 3>(24, 24) = S.border.block<3, 3>(kGravity, kGravity);
  joint.triangularView<Eigen::StrictlyLower>() = joint.transpose();
  return joint;
}

/// Adds a link's rows: (J dx + r)^2 from their Gram, and 1 - J S J' summed as a trace.
void addRows(const Link& link, const Groups& information, const ChainInverse& inverse,
             VarianceSums& sum) {
  const int at = link.at;
  const ChainCovariance& S = inverse.covariance;
  const auto& dx_i = inverse.solution.step[at];
  const auto& dx_j = inverse.solution.step[at + 1];
  const Vector6d walk = link.walk + link.walk_weight.cwiseProduct((dx_j - dx_i).tail<6>());
  // Var(x_j - x_i) of the biases.
  const Vector6d variance =
      (S.diagonal[at] + S.diagonal[at + 1] - 2 * S.next[at]).diagonal().tail<6>();
  const Vector6d explained = link.walk_weight.cwiseAbs2().cwiseProduct(variance);
  // Gyroscope, then accelerometer; their groups stand behind those of the motion.
  for (int g = 0; g < 2; ++g) {
    sum.squares(2 + g) += information(2 + g) * walk.segment<3>(3 * g).squaredNorm();
    sum.redundancy(2 + g) += 3 - information(2 + g) * explained.segment<3>(3 * g).sum();
    sum.rows(2 + g) += 3;
  }
  if (!link.inertial) return;
  const LinkGram joint = jointCovariance(at, S);
  Eigen::Matrix<double, 28, 1> x;
  x << dx_i, dx_j.head<9>(), inverse.solution.border_step.segment<3>(BorderLayout::kGravity), 1;
  for (int g = 0; g < 2; ++g) {
    const LinkGram& G = link.motion[g];
    const double rows = g == 0 ? 3 : 6;
    sum.squares(g) += information(g) * x.dot(G.lazyProduct(x));
    sum.redundancy(g) += rows - information(g) * G.cwiseProduct(joint).sum();
    sum.rows(g) += rows;
  }
}

/// Squared distance of every frame's pose from the one that its corners alone would choose, in the
/// metric of the corners' information: sum of e' H e, e = x + H^-1 (b + C y).
double poseSquares(const BlockArrow& cameras, const ChainSolution& step) {
  const int m = cameras.border();
  double sum = 0;
  for (std::size_t i = 0; i < cameras.diagonal.size(); ++i) {
    const Matrix6d H = cameras.diagonal[i].topLeftCorner<6, 6>();
    const auto& C = cameras.to_border[i];
    // g = H e, so that e' H e = g' H^-1 g.
    const Vector6d g =
        H * step.step[i].head<6>() + C.col(m).head<6>() + C.topLeftCorner(6, m) * step.border_step;
    sum += SymmetricFactor(H).squaredNorm(g);
  }
  return sum;
}

/// The optimum as a function of the factors, by one linear step from the solution.
class VarianceComponents {
 public:
  VarianceComponents(BlockArrow cameras, std::vector<Link> links, int threads)
      : cameras_(std::move(cameras)), links_(std::move(links)), threads_(threads) {}

  std::optional<VarianceSums> at(const Factors& factors) const {
    const auto inverse = invertChain(combined(cameras_, links_, factors), {0, threads_});
    if (!inverse) return std::nullopt;
    // The Gram matrices are of rows under the assumed densities; what is asked for is their squares
    // under these factors.
    const Groups information = factors.imu.square().inverse();
    const int count = static_cast<int>(links_.size());
    std::vector<VarianceSums> parts(chunkCount(count, kImuChunk));
    forChunks(count, kImuChunk, threads_, [&](const Chunk& chunk) {
      VarianceSums& part = parts[chunk.index];
      for (int k = chunk.begin; k < chunk.end; ++k) {
        addRows(links_[k], information, *inverse, part);
      }
    });
    VarianceSums sum;
    for (const VarianceSums& part : parts) {
      sum.squares += part.squares;
      sum.redundancy += part.redundancy;
      sum.rows += part.rows;
    }
    sum.pose_squares = poseSquares(cameras_, inverse->solution);
    return sum;
  }

  /// Of the poses: they have 6 rows a frame, and all redundancies add up to the number of rows less
  /// that of unknowns. What is freed of the cameras does not count: it takes its own from what
  /// corners leave beside poses.
  double poseRedundancy(const VarianceSums& e) const {
    return (e.rows - e.redundancy).sum() - (kChainBlock - 6.0) * cameras_.blocks() -
           BorderLayout::kFixed;
  }
  /// Standard deviation of the corners that the poses show, in units of pixel_sigma.
  double pixelFactor(const VarianceSums& e) const {
    return std::clamp(std::sqrt(e.pose_squares / std::max(poseRedundancy(e), 1.0)), kLeastFactor,
                      kMostFactor);
  }

 private:
  BlockArrow cameras_;
  std::vector<Link> links_;
  int threads_;
};

/// The next factors of the densities. Plain estimation would raise the ratio to 1/2; the more
/// converges faster at the usual redundancy of a third to two thirds of the rows.
Groups nextFactors(const Groups& factors, const Groups& ratio) {
  return (factors * ratio.pow(0.7)).max(kLeastFactor).min(kMostFactor);
}

ImuNoiseCheck checkOf(int group, const VarianceSums& assumed, const VarianceSums& end,
                      const Groups& factors) {
  const double share =
      std::max(0.0, assumed.redundancy(group)) / std::max(assumed.rows(group), 1.0);
  return {std::sqrt(share), factors(group), end.redundancy(group)};
}

/// All of n frames, or `most` of them in evenly spread segments.
std::vector<int> spreadFrames(int n, int most) {
  std::vector<int> frames;
  const int segments = std::max(2, most / kSegment);
  if (n <= std::max(most, segments * kSegment)) {
    for (int f = 0; f < n; ++f) frames.push_back(f);
    return frames;
  }
  for (int s = 0; s < segments; ++s) {
    // The first segment begins with the recording, the last one ends with it.
    const int first = s * (n - kSegment) / (segments - 1);
    for (int f = 0; f < kSegment; ++f) frames.push_back(first + f);
  }
  return frames;
}

/// Leaves the given frames (ascending), cut loose from each other where others lay between them.
void keepOnly(const std::vector<int>& kept, CameraImuProblem& problem,
              CameraImuSolution& solution) {
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const int from = kept[k];  // never before k
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

struct VarianceFit {
  Factors factors;
  VarianceSums at;
};

/// From the densities as assumed; a group moves while its redundancy is at least `least`.
std::optional<VarianceFit> fitVariances(const VarianceComponents& components,
                                        const VarianceSums& assumed, const Groups& least) {
  VarianceFit fit{{}, assumed};
  for (int round = 0; round < kMostRounds; ++round) {
    const double pixel = components.pixelFactor(fit.at);
    const Groups ratio =
        (fit.at.redundancy >= least).select(fit.at.squares / fit.at.redundancy, 1.0);
    // Both in the logarithm of a standard deviation; `ratio` is of variances.
    const double change = std::max(std::abs(std::log(pixel / fit.factors.pixel)),
                                   0.5 * ratio.max(1e-12).log().abs().maxCoeff());
    if (change < kFactorTolerance) break;
    fit.factors = {pixel, nextFactors(fit.factors.imu, ratio)};
    const auto next = components.at(fit.factors);
    if (!next) return std::nullopt;
    fit.at = *next;
  }
  return fit;
}

/// Densities far too small leave an interval nothing to say: its states follow the samples, and the
/// poses pay. A group that has the redundancy once its factor is found is believed, however little
/// it had under the density assumed; the others keep that. Where that does not come out with the
/// others held, nothing is released.
std::optional<VarianceFit> fitVariances(const VarianceComponents& components,
                                        const VarianceSums& assumed) {
  const Groups least = Groups::Constant(kLeastRedundancy);
  const auto fit = fitVariances(components, assumed, least);
  const Groups tried = least.min(kTriedRedundancy);
  if (!fit || (fit->at.redundancy >= least || fit->at.redundancy < tried).all()) return fit;
  const auto released = fitVariances(components, assumed, tried);
  if (!released) return fit;
  const auto found = (released->at.redundancy >= least).eval();
  if ((found == (fit->at.redundancy >= least)).all()) return fit;
  const auto chosen = fitVariances(components, assumed, found.select(tried, least));
  const bool holds = chosen && (!found || chosen->at.redundancy >= least).all();
  return holds ? chosen : fit;
}

/// Whether poses whose corners have this noise, in units of pixel_sigma, show what theirs is: they
/// have the redundancy, or the squares of all rows are more than chance makes of theirs.
bool posesTellTheirNoise(const VarianceComponents& components, const Groups& imu, double pixel) {
  const double assumed = std::clamp(pixel, kLeastFactor, kMostFactor);
  const auto at = components.at({assumed, imu});
  if (!at) return false;
  const double of_poses = std::max(components.poseRedundancy(*at), 0.0);
  if (of_poses >= kLeastRedundancy) return true;
  const double squares = at->squares.sum() + at->pose_squares / (assumed * assumed);
  return squares > chiSquaredTailQuantile(at->redundancy.sum() + of_poses, kChance);
}

}  // namespace

ImuNoiseChecks checkImuNoise(CameraImuProblem problem, CameraImuSolution solution,
                             double corner_sigma_px) {
  solution.normals = CameraImuNormals();  // large, and not needed here
  keepOnly(spreadFrames(problem.frameCount(), kMostNoiseFrames), problem, solution);
  auto cameras = cameraInformationAt(problem, solution.estimate);
  auto links = linksOf(problem, solution.estimate, solution.weights);
  if (!links) return {};
  const VarianceComponents components(std::move(cameras.chain), std::move(*links), problem.threads);
  const auto assumed = components.at({});
  const auto fit = assumed ? fitVariances(components, *assumed) : std::nullopt;
  if (!fit) return {};
  const auto check = [&](int group) { return checkOf(group, *assumed, fit->at, fit->factors.imu); };
  const bool told =
      posesTellTheirNoise(components, fit->factors.imu, corner_sigma_px / problem.pixel_sigma);
  return {check(0), check(1), check(2), check(3),
          told ? fit->factors.pixel * problem.pixel_sigma : 0};
}

}  // namespace plumbline

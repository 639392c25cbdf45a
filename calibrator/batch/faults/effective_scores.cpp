// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "calibrator/batch/faults/score_tests.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSlowestSway = 0.1;  // [Hz]
constexpr double kFastestSway = 5;    // [Hz]

/// Specific force that the motion leaves over in a link.
struct Force {
  double t;  ///< [s] from the first frame
  Eigen::Vector3d a;
};

std::vector<Force> forcesLeftOver(const CameraImuProblem& problem,
                                  const CameraImuSolution& solution) {
  std::vector<Force> forces;
  const CameraImuEstimate& e = solution.estimate;
  const Gravity gravity{e.gravity_direction, problem.gravity_m_s2};
  const TimeNs begin = problem.frames.front().t;
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] != FrameLink::kInertial) continue;
    const ImuState& i = e.states[k];
    const ImuWindow window{problem.frames[k].t, problem.frames[k + 1].t, e.timeOffset()};
    const auto motion = preintegrate(problem.samples, window, {i.gyro_bias, i.accel_bias});
    if (!motion) continue;
    const ImuResidual r = imuResidual(*motion, i, e.states[k + 1], gravity);
    forces.push_back(
        // In F, where the target sways: the direction in S turns with the sensor.
        {secondsBetween(begin, window.from), i.T_FS.R * r.r.segment<3>(3) / window.duration_s()});
  }
  return forces;
}

/// A jump in one link: rows of the whitened residual that it moves, and by how much.
using Jump = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Jump biasJump(const LinkTerms& t, int first_row) {
  Jump C = Jump::Zero(t.r.size(), 3);
  const Index row = t.r.size() - 6 + first_row;
  // J_i holds minus the weights of the walk there.
  C.block<3, 3>(row, 0) = t.J_i.block<3, 3>(row, 9 + first_row);
  return C;
}

/// The later state's position moves against the earlier one's: the link sees the target jump
/// between.
Jump targetJump(const LinkTerms& t) { return t.J_j.leftCols<3>(); }

/// 1 - J S J' of a link's rows.
MatrixXd redundancyOf(const LinkTerms& t, const ChainCovariance& S, Index border) {
  constexpr Index n = kChainBlock;
  MatrixXd joint(2 * n + border, 2 * n + border);
  joint << S.diagonal[t.at], S.next[t.at], S.to_border[t.at], S.next[t.at].transpose(),
      S.diagonal[t.at + 1], S.to_border[t.at + 1], S.to_border[t.at].transpose(),
      S.to_border[t.at + 1].transpose(), S.border;
  MatrixXd J(t.r.size(), 2 * n + border);
  J << t.J_i, t.J_j, t.J_B.leftCols(border);
  return MatrixXd::Identity(t.r.size(), t.r.size()) - J * joint * J.transpose();
}

/// The frequency [Hz] of the largest periodogram of the forces left over, in F. It is looked for in
/// the residuals as they are: what the states absorb of a sine changes its size, not its frequency.
double swayFrequency(const CameraImuProblem& problem, const CameraImuSolution& solution) {
  const std::vector<Force> forces = forcesLeftOver(problem, solution);
  const double span = secondsBetween(problem.frames.front().t, problem.frames.back().t);
  const double rate = static_cast<double>(forces.size()) / span;
  // Half of what the span resolves, lest the peak falls between two steps.
  const double step = 0.5 / span;
  // exp(i 2 pi f t) of every force, turned on from one frequency to the next.
  const auto phasor = [&](const Force& force, double hz) {
    return std::polar(1.0, 2 * std::numbers::pi * hz * force.t);
  };
  std::vector<std::complex<double>> phase, turn;
  for (const Force& force : forces) {
    phase.push_back(phasor(force, kSlowestSway));
    turn.push_back(phasor(force, step));
  }
  double best = kSlowestSway;
  double most = -1;
  // Up to 0.4 of the links' rate, short of the half at which frequencies fold back.
  for (double hz = kSlowestSway; hz < std::min(kFastestSway, 0.4 * rate); hz += step) {
    Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
    for (std::size_t k = 0; k < forces.size(); ++k) {
      sum += phase[k] * forces[k].a.cast<std::complex<double>>();
      phase[k] *= turn[k];
    }
    if (!(sum.squaredNorm() > most)) continue;
    most = sum.squaredNorm();
    best = hz;
  }
  return best;
}

/// Puts the jumps' columns into the links that they explain best: the largest
///   s' A^-1 s,   s = C' r,   A = C' (1 - J S J') C,
/// C what the jump adds to the link's whitened residual r, J its Jacobian and S the covariance of
/// states and border.
JumpPlaces placeJumps(const CameraImuProblem& problem, const FaultColumns& columns,
                      const ChainCovariance& S, std::vector<LinkTerms>& links) {
  JumpPlaces out;
  struct Place {
    int column;
    TimeNs* at;
    double best = -1;
    std::size_t link = 0;
  };
  std::array<Place, 3> places{{{columns.gyro_jump, &out.gyro_at},
                               {columns.accel_jump, &out.accel_at},
                               {columns.target_jump, &out.target_at}}};
  const auto jumpOf = [](std::size_t kind, const LinkTerms& t) {
    return kind == 2 ? targetJump(t) : biasJump(t, kind == 0 ? 0 : 3);
  };
  std::vector<double> of_target;
  for (std::size_t l = 0; l < links.size(); ++l) {
    // Links over a pause have no motion by which a jump would show.
    if (links[l].r.size() != 15) continue;
    const MatrixXd R = redundancyOf(links[l], S, columns.border.size);
    for (std::size_t kind = 0; kind < places.size(); ++kind) {
      const Jump C = jumpOf(kind, links[l]);
      const Eigen::Vector3d s = C.transpose() * links[l].r;
      const Eigen::Matrix3d A = C.transpose() * R * C;
      const double explained = SymmetricFactor(A).squaredNorm(s);
      if (kind == 2) of_target.push_back(explained);
      if (!(explained > places[kind].best)) continue;
      places[kind].best = explained;
      places[kind].link = l;
    }
  }
  // Of three degrees of freedom. A high quantile, for links of fast motion may have larger
  // residuals than the others; a displacement shows in one or two.
  constexpr double kQuantile = 0.95;
  constexpr double kChi2Quantile = 7.815;
  if (!of_target.empty()) {
    out.target_dispersion = quantile(std::move(of_target), kQuantile) / kChi2Quantile;
  }
  for (std::size_t kind = 0; kind < places.size(); ++kind) {
    LinkTerms& t = links[places[kind].link];
    t.J_B.middleCols<3>(places[kind].column) = jumpOf(kind, t);
    *places[kind].at = problem.frames[t.at].t;
  }
  return out;
}

using PoseRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Adds U' H U and U' b of a view, the first six rows of U being T and the others unit vectors of
/// its own columns; only the first T.cols() columns of the border.
void addViewGram(const FaultViewTerms& v, const PoseRows& T, MatrixXd& information,
                 VectorXd& gradient) {
  const Index n = T.cols();
  information.noalias() += T.transpose() * (v.H.leftCols<6>() * T).eval();
  gradient.noalias() += T.transpose() * v.b.head<6>();
  const double* H_own = v.H_own.data();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    const Index row = 6 + i;
    const Index column = v.own[i];
    if (column < n) {
      const VectorXd cross = T.transpose() * v.H.col(row);
      information.col(column) += cross;
      information.row(column) += cross.transpose();
      gradient(column) += v.b(row);
    }
    for (std::size_t j = i; j < v.own.size(); ++j, ++H_own) {
      // H_own goes on for columns that are left out, too: it is one list.
      if (column >= n || v.own[j] >= n) continue;
      information(column, v.own[j]) += *H_own;
      if (j > i) information(v.own[j], column) += *H_own;
    }
  }
}

/// T += A_B, in its first T.cols() columns.
void addByBorder(const FaultViewTerms& v, PoseRows& T) {
  for (std::size_t k = 0; k < v.by.size(); ++k) {
    if (v.by[k] < T.cols()) T.col(v.by[k]) += v.A_B.col(k);
  }
}

/// The chain's own blocks and its coupling to the first n columns of the border.
void addView(const FaultViewTerms& v, Index n, BlockArrow& chain) {
  const Eigen::Matrix<double, kChainBlock, 6> AxH = v.A_x.transpose() * v.H.leftCols<6>();
  chain.diagonal[v.frame] += AxH * v.A_x;
  ChainBorderRows& rows = chain.to_border[v.frame];
  for (std::size_t k = 0; k < v.by.size(); ++k) {
    if (v.by[k] < n) rows.col(v.by[k]) += AxH * v.A_B.col(k);
  }
  rows.col(n) += v.A_x.transpose() * v.b.head<6>();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    if (v.own[i] >= n) continue;
    rows.col(v.own[i]) += v.A_x.transpose() * v.H.col(6 + i);
  }
}

void addLink(const LinkTerms& t, Index n, BlockArrow& chain) {
  // Columns from of_links on are zero in every link, and not stored.
  const Index touched = std::min(n, t.J_B.cols());
  const auto J_B = t.J_B.leftCols(touched);
  chain.diagonal[t.at] += t.J_i.transpose() * t.J_i;
  chain.next[t.at] += t.J_i.transpose() * t.J_j;
  chain.diagonal[t.at + 1] += t.J_j.transpose() * t.J_j;
  chain.to_border[t.at].leftCols(touched) += t.J_i.transpose() * J_B;
  chain.to_border[t.at].col(n) += t.J_i.transpose() * t.r;
  chain.to_border[t.at + 1].leftCols(touched) += t.J_j.transpose() * J_B;
  chain.to_border[t.at + 1].col(n) += t.J_j.transpose() * t.r;
}

/// With the first n columns of the border, whose own block stays zero.
BlockArrow chainOf(const CameraImuProblem& problem, const std::vector<FaultViewTerms>& views,
                   const std::vector<LinkTerms>& links, Index n) {
  BlockArrow chain(problem.frameCount(), static_cast<int>(n));
  for (const FaultViewTerms& v : views) addView(v, n, chain);
  for (const LinkTerms& t : links) addLink(t, n, chain);
  return chain;
}

// At the optimum of the batch, with its own columns alone: what the residuals' redundancy is judged
// by.
std::optional<ChainCovariance> chainCovariance(const CameraImuProblem& problem,
                                               const std::vector<FaultViewTerms>& views,
                                               const std::vector<LinkTerms>& links, Index border) {
  BlockArrow chain = chainOf(problem, views, links, border);
  for (const FaultViewTerms& v : views) {
    PoseRows T = PoseRows::Zero(6, border);
    addByBorder(v, T);
    addViewGram(v, T, chain.border_block, chain.border_gradient);
  }
  for (const LinkTerms& t : links) {
    const auto J_B = t.J_B.leftCols(border);
    chain.border_block += J_B.transpose() * J_B;
    chain.border_gradient += J_B.transpose() * t.r;
  }
  auto inverse = invertChain(chain, {0, problem.threads});
  if (!inverse) return std::nullopt;
  return std::move(inverse->covariance);
}

void addTo(ScoreBlock& block, const FaultViewTerms& v, const ChainResponse& W) {
  PoseRows T = v.A_x * W;
  addByBorder(v, T);
  addViewGram(v, T, block.information, block.gradient);
  ++block.views;
}

void addTo(ScoreBlock& block, const LinkTerms& t, const std::vector<ChainResponse>& W) {
  // J~ = J_B + J_i W_i + J_j W_j.
  MatrixXd U = t.J_i * W[t.at] + t.J_j * W[t.at + 1];
  U.leftCols(t.J_B.cols()) += t.J_B;
  block.information.noalias() += U.transpose() * U;
  block.gradient.noalias() += U.transpose() * t.r;
}

/// One readout time of all cameras moves the views as those of each together do.
void addCommonReadout(const FaultColumns& columns, ScoreBlock& block) {
  if (columns.line_delays.size() < 2) return;
  VectorXd common = VectorXd::Zero(columns.size);
  for (const int own : columns.line_delays) {
    block.gradient(columns.line_delay) += block.gradient(own);
    common += block.information.col(own);
  }
  double of_itself = 0;
  for (const int own : columns.line_delays) of_itself += common(own);
  common(columns.line_delay) = of_itself;
  block.information.col(columns.line_delay) = common;
  block.information.row(columns.line_delay) = common.transpose();
}

}  // namespace

TimeBlocks::TimeBlocks(const std::vector<Frame>& frames, double block_s) : begin(frames.front().t) {
  const double span = secondsBetween(begin, frames.back().t);
  count = static_cast<std::size_t>(std::max(1.0, std::round(span / block_s)));
  // One nanosecond more than the share, so that the last frame falls into the last block.
  length = (frames.back().t - begin) / static_cast<TimeNs>(count) + 1;
}

std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s) {
  EffectiveScores out;
  out.sway_hz = swayFrequency(problem, solution);
  const auto views = viewTerms(problem, solution, columns);
  auto links = linkTerms(problem, solution, columns, out.sway_hz);
  if (!links) return std::nullopt;
  // Before the scores: where a jump is tested decides what its column is. Ended before the
  // responses are formed, for no other step takes as much memory.
  if (const auto S = chainCovariance(problem, views, *links, columns.border.size)) {
    out.jumps = placeJumps(problem, columns, *S, *links);
  } else {
    return std::nullopt;
  }
  // Now with all columns, jumps included; the border's own information comes from the blocks.
  const auto W = chainResponses(chainOf(problem, views, *links, columns.size), problem.threads);
  if (!W) return std::nullopt;
  const TimeBlocks blocks(problem.frames, block_s);
  for (std::size_t b = 0; b < blocks.count; ++b) {
    out.blocks.push_back({blocks.begin + static_cast<TimeNs>(b) * blocks.length, 0,
                          VectorXd::Zero(columns.size),
                          MatrixXd::Zero(columns.size, columns.size)});
  }
  const auto blockOf = [&](std::size_t frame) -> ScoreBlock& {
    return out.blocks[blocks.of(problem.frames[frame].t)];
  };
  for (const FaultViewTerms& v : views) addTo(blockOf(v.frame), v, (*W)[v.frame]);
  for (const LinkTerms& t : *links) addTo(blockOf(t.at), t, *W);
  for (ScoreBlock& block : out.blocks) addCommonReadout(columns, block);
  return out;
}

}  // namespace plumbline

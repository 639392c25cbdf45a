// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace plumbline {

/// Size of a block of the chain: one state of the sensor (pose, velocity, biases).
inline constexpr int kChainBlock = 15;

using ChainMatrix = Eigen::Matrix<double, kChainBlock, kChainBlock>;
/// 15 x (m + 1) row-major: coupling of one block to the border, and the block's gradient last.
using ChainBorderRows = Eigen::Matrix<double, kChainBlock, Eigen::Dynamic, Eigen::RowMajor>;

/// Normal equations H x = -b of a chain of n states with a dense border of m parameters that touch
/// every state:
///
///       | D_0  N_0            C_0 |        | b_0 |
///   H = | N_0' D_1  N_1       C_1 |,   b = | b_1 |,   and so on; last row the border.
///       |      N_1' D_2  ..   C_2 |        | b_2 |
///       | C_0' C_1' C_2' ..   B   |        | b_B |
///
/// Units are the caller's; the upper triangles of D and B are enough, H must be positive definite.
/// A zero N_i breaks the chain there.
struct BlockArrow {
  explicit BlockArrow(int blocks = 0, int border = 0);

  int blocks() const { return static_cast<int>(diagonal.size()); }
  int border() const { return static_cast<int>(border_gradient.size()); }
  /// Takes a parameter of the border out of the system: its step is zero.
  void hold(int parameter);

  std::vector<ChainMatrix> diagonal;       ///< D_i, n
  std::vector<ChainMatrix> next;           ///< N_i = H(i, i + 1), n (the last one is unused)
  std::vector<ChainBorderRows> to_border;  ///< (C_i | b_i), n
  Eigen::MatrixXd border_block;            ///< B, m x m
  Eigen::VectorXd border_gradient;         ///< b_B, m
};

struct ChainOptions {
  double damping = 0;  ///< Levenberg-Marquardt: the diagonal is multiplied by 1 + damping
  int threads = 1;     ///< 2 or more: both sweeps run at once; the result is the same bit by bit
};

struct ChainSolution {
  std::vector<Eigen::Matrix<double, kChainBlock, 1>> step;  ///< x of the blocks, n
  Eigen::VectorXd border_step;                              ///< x of the border, m
  /// Information of the border with the chain marginalised: B - C' (chain)^-1 C, m x m symmetric.
  Eigen::MatrixXd border_information;
  double decrement = 0;  ///< b' H^-1 b: twice the decrease of the cost that H and b predict
};

/// Solves by a block Cholesky factorisation that starts at both ends and meets in the middle
/// (n (15^3 + 15^2 m) operations). Empty where a pivot is not positive.
std::optional<ChainSolution> solveChain(const BlockArrow& system, const ChainOptions& options = {});

/// The blocks of H^-1 where H has blocks: the covariance of each state, of each state with the next
/// one, and of each with the border.
struct ChainCovariance {
  std::vector<ChainMatrix> diagonal;       ///< H^-1(i, i), n
  std::vector<ChainMatrix> next;           ///< H^-1(i, i + 1), n (the last one is zero)
  std::vector<ChainBorderRows> to_border;  ///< H^-1(i, border), n of 15 x m
  Eigen::MatrixXd border;                  ///< H^-1(border, border), m x m
};

struct ChainInverse {
  ChainSolution solution;  ///< equal to solveChain()'s, bit by bit
  ChainCovariance covariance;
};

/// Solves, and goes from the middle outwards again for the selected inverse: with x_i = -K (x_j,
/// x_B)
/// + noise of covariance (L L')^-1 from the elimination of block i towards block j,
///   S_i,jB = -K S_jB,   S_ii = (L L')^-1 + K S_jB K'
/// (Takahashi et al. 1973, by blocks); n (15^3 + 15 (15 + m)^2) operations. Empty where
/// solveChain() is.
std::optional<ChainInverse> invertChain(const BlockArrow& system, const ChainOptions& options = {});

/// 15 x m row-major: how a block of the chain follows the border.
using ChainResponse = Eigen::Matrix<double, kChainBlock, Eigen::Dynamic, Eigen::RowMajor>;

/// W_i = dx_i / dx_B with the chain at its optimum for every border, W = -(chain)^-1 C, n of them;
/// B and the gradients play no part. Empty where a pivot of the chain is not positive. The system
/// is released on the way, since system, factor and result are of one size.
std::optional<std::vector<ChainResponse>> chainResponses(BlockArrow system, int threads = 1);

}  // namespace plumbline

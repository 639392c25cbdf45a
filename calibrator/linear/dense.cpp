// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/linear/dense.h"

#include <Eigen/Eigenvalues>
#include <cassert>

namespace plumbline {
namespace {

constexpr double kLeastPivot = 1e-13;  // of a matrix with unit diagonal: below lies rounding

/// The indices below `size` that are not in `keep`, ascending.
std::vector<int> others(const std::vector<int>& keep, Eigen::Index size) {
  std::vector<char> kept(size, 0);
  for (const int i : keep) {
    assert(i >= 0 && i < size && kept[i] == 0);
    kept[i] = 1;
  }
  std::vector<int> drop;
  for (int i = 0; i < size; ++i) {
    if (kept[i] == 0) drop.push_back(i);
  }
  return drop;
}

/// (I, -K^T) noise (I, -K^T)^T of the parameters (kept, dropped).
Eigen::MatrixXd noiseKept(const Eigen::MatrixXd& noise, const std::vector<int>& keep,
                          const std::vector<int>& drop, const Eigen::MatrixXd& K) {
  const Eigen::MatrixXd across = noise(keep, drop) * K;
  const Eigen::MatrixXd dropped = noise(drop, drop);
  return Eigen::MatrixXd(noise(keep, keep)) - across - across.transpose() +
         K.transpose() * dropped * K;
}

}  // namespace

QuadraticCost QuadraticCost::at(const Eigen::VectorXd& d) const {
  assert(d.size() == b.size());
  const Eigen::VectorXd Hd = H * d;
  return {H, b + Hd, c + d.dot(b) + 0.5 * d.dot(Hd), noise};
}

QuadraticCost QuadraticCost::through(const Eigen::MatrixXd& J) const {
  // The curvature of the change of coordinates, which b would multiply, is left out (Gauss-Newton).
  QuadraticCost out{J.transpose() * H * J, J.transpose() * b, c};
  if (noise.size() > 0) out.noise = J.transpose() * noise * J;
  return out;
}

std::optional<ScaledCholesky> scaledCholesky(const Eigen::MatrixXd& A) {
  assert(A.rows() == A.cols());
  if (!(A.diagonal().array() > 0).all()) return std::nullopt;
  ScaledCholesky f;
  f.D = A.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = f.D.cwiseInverse();
  f.llt.compute(inverse.asDiagonal() * A * inverse.asDiagonal());
  if (f.llt.info() != Eigen::Success) return std::nullopt;
  // With a unit diagonal the pivot of parameter j is 1 - R^2 of its regression on those before it.
  if (!(f.llt.matrixLLT().diagonal().array().square() >= kLeastPivot).all()) return std::nullopt;
  return f;
}

std::optional<QuadraticCost> marginalised(const QuadraticCost& cost, const std::vector<int>& keep) {
  assert(cost.H.rows() == cost.H.cols() && cost.H.rows() == cost.b.size());
  const std::vector<int> drop = others(keep, cost.b.size());
  const bool noisy = cost.noise.size() > 0;
  QuadraticCost out{cost.H(keep, keep), cost.b(keep), cost.c};
  if (noisy) out.noise = cost.noise(keep, keep);
  if (drop.empty()) return out;
  const auto factor = scaledCholesky(cost.H(drop, drop));
  if (!factor) return std::nullopt;
  const Eigen::VectorXd scale = factor->D.cwiseInverse();
  // W = L^-1 H_dk and y = L^-1 b_d: products with their transposes are symmetric to the last bit.
  Eigen::MatrixXd W = scale.asDiagonal() * cost.H(drop, keep);
  Eigen::VectorXd y = scale.asDiagonal() * cost.b(drop);
  factor->llt.matrixL().solveInPlace(W);
  factor->llt.matrixL().solveInPlace(y);
  out.H.triangularView<Eigen::Lower>() -= W.transpose() * W;
  out.H.triangularView<Eigen::StrictlyUpper>() = out.H.transpose();
  out.b -= W.transpose() * y;
  out.c -= 0.5 * y.squaredNorm();
  if (noisy) {
    factor->llt.matrixU().solveInPlace(W);
    const Eigen::MatrixXd K = scale.asDiagonal() * W;  // H_dd^-1 H_dk
    out.noise = noiseKept(cost.noise, keep, drop, K);
  }
  return out;
}

SymmetricEigen symmetricEigen(const Eigen::MatrixXd& A) {
  assert(A.rows() == A.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::MatrixXd symmetricPseudoInverse(const Eigen::MatrixXd& A, double tolerance) {
  const SymmetricEigen eigen = symmetricEigen(A);
  const double least = tolerance * eigen.values.maxCoeff();
  const Eigen::VectorXd inverse =
      eigen.values.unaryExpr([least](double value) { return value > least ? 1 / value : 0.0; });
  return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
}

Eigen::MatrixXd finiteInverse(const Eigen::MatrixXd& A, double least, double prior) {
  assert(A.rows() == A.cols());
  const Eigen::VectorXd scale = A.diagonal().cwiseMax(least).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  scaled.diagonal().array() += prior;
  const Eigen::MatrixXd inverse =
      scaled.ldlt().solve(Eigen::MatrixXd::Identity(A.rows(), A.cols()));
  const Eigen::MatrixXd out = scale.asDiagonal() * inverse * scale.asDiagonal();
  return 0.5 * (out + out.transpose());
}

}  // namespace plumbline

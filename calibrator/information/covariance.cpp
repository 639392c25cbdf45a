// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/covariance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibrator/linear/dense.h"

namespace plumbline {
namespace {

// Of A = D L L' D.
double logDeterminantOf(const ScaledCholesky& f) {
  return 2 * (f.llt.matrixLLT().diagonal().array().log().sum() + f.D.array().log().sum());
}

// log_determinant: of the covariance of n parameters.
double gaussianEntropy(Eigen::Index n, double log_determinant) {
  const double log_2_pi_e = std::log(2 * std::numbers::pi * std::numbers::e);
  return 0.5 * (static_cast<double>(n) * log_2_pi_e + log_determinant);
}

// The parameters that carry a direction: those within a factor of three of the largest.
std::vector<int> leadingOf(const Eigen::VectorXd& weights) {
  const double least = 0.3 * weights.cwiseAbs().maxCoeff();
  std::vector<int> leading;
  for (int i = 0; i < weights.size(); ++i) {
    if (std::abs(weights(i)) > least) leading.push_back(i);
  }
  std::stable_sort(leading.begin(), leading.end(), [&weights](int a, int b) {
    return std::abs(weights(a)) > std::abs(weights(b));
  });
  return leading;
}

}  // namespace

std::optional<double> logDeterminant(const Eigen::MatrixXd& information) {
  const auto f = scaledCholesky(information);
  if (!f) return std::nullopt;
  return logDeterminantOf(*f);
}

std::optional<Eigen::MatrixXd> covarianceOf(const Eigen::MatrixXd& information) {
  const auto f = scaledCholesky(information);
  if (!f) return std::nullopt;
  const Eigen::Index n = information.rows();
  const Eigen::VectorXd inverse = f->D.cwiseInverse();
  // L^-1 first: its product with its transpose has no negative eigenvalue but for rounding. The
  // mean with the transpose, below, makes it symmetric to the last bit, in whatever order the
  // product sums.
  Eigen::MatrixXd L_inverse = Eigen::MatrixXd::Identity(n, n);
  f->llt.matrixL().solveInPlace(L_inverse);
  const Eigen::MatrixXd scaled = L_inverse * inverse.asDiagonal();
  Eigen::MatrixXd covariance = scaled.transpose() * scaled;
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
  return covariance;
}

std::optional<double> entropyNats(const Eigen::MatrixXd& information) {
  const auto log_determinant = logDeterminant(information);
  if (!log_determinant) return std::nullopt;
  return gaussianEntropy(information.rows(), -*log_determinant);
}

std::optional<double> entropyNatsOfCovariance(const Eigen::MatrixXd& covariance) {
  const auto log_determinant = logDeterminant(covariance);
  if (!log_determinant) return std::nullopt;
  return gaussianEntropy(covariance.rows(), *log_determinant);
}

std::optional<double> mutualInformationNats(const Eigen::MatrixXd& before,
                                            const Eigen::MatrixXd& after) {
  // 0.5 log(|Sigma| / |Sigma given z|), the paper's mutual information (after Maye et al., IV
  // 2013), by the determinants of the inverses: no matrix is inverted.
  const auto log_before = logDeterminant(before);
  const auto log_after = logDeterminant(after);
  if (!log_before || !log_after) return std::nullopt;
  return 0.5 * (*log_after - *log_before);
}

double bitsFromNats(double nats) { return nats / std::numbers::ln2; }

std::vector<FreeDirection> freeDirections(const Eigen::MatrixXd& information,
                                          const Eigen::VectorXd& sizes) {
  assert(information.rows() == sizes.size());
  // In units of the sizes an eigenvalue below 1 is a deviation above 1: a worthless direction.
  const Eigen::MatrixXd scaled = sizes.asDiagonal() * information * sizes.asDiagonal();
  const SymmetricEigen eigen = symmetricEigen(scaled);
  std::vector<FreeDirection> free;
  // Ascending; an eigenvalue that is NaN counts as free.
  for (Eigen::Index i = 0; i < sizes.size() && !(eigen.values(i) >= 1); ++i) {
    FreeDirection direction;
    const double eigenvalue = eigen.values(i);
    direction.std =
        eigenvalue > 0 ? 1 / std::sqrt(eigenvalue) : std::numeric_limits<double>::infinity();
    direction.weights = eigen.vectors.col(i);
    direction.leading = leadingOf(direction.weights);
    free.push_back(std::move(direction));
  }
  return free;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace plumbline {

// An information matrix is the inverse of a covariance, symmetric; rows in any units, for every
// function here scales its diagonal to 1 before it factors.

/// log det of an information matrix from its Cholesky factor [nats]. Empty where the matrix is not
/// positive definite to working precision (a scaled pivot below 1e-13).
std::optional<double> logDeterminant(const Eigen::MatrixXd& information);

/// Sigma = information^-1. Empty where logDeterminant() is.
std::optional<Eigen::MatrixXd> covarianceOf(const Eigen::MatrixXd& information);

/// Entropy of a Gaussian with that information: 0.5 log((2 pi e)^n |Sigma|) [nats].
std::optional<double> entropyNats(const Eigen::MatrixXd& information);

/// The same by its covariance; empty where that is not positive definite to working precision.
std::optional<double> entropyNatsOfCovariance(const Eigen::MatrixXd& covariance);

/// What measurements that turn the information `before` into `after` tell of the parameters:
/// 0.5 (log |after| - log |before|) [nats]. Empty where either determinant is.
std::optional<double> mutualInformationNats(const Eigen::MatrixXd& before,
                                            const Eigen::MatrixXd& after);

/// Nats to bits: divided by log 2.
double bitsFromNats(double nats);

/// A direction of the parameters that the data leave free.
struct FreeDirection {
  double std = 0;            ///< along it, in units of `sizes`; infinite where nothing is known
  Eigen::VectorXd weights;   ///< unit vector over the parameters in units of `sizes`
  std::vector<int> leading;  ///< parameters with |weight| > 0.3 of the largest, largest first
};

/// Directions along which the standard deviation exceeds the parameters' own size: eigenvectors of
/// diag(sizes) information diag(sizes) with eigenvalues below 1, the freest first. `sizes` says
/// for each parameter how large an error would make it worthless, in its own unit.
std::vector<FreeDirection> freeDirections(const Eigen::MatrixXd& information,
                                          const Eigen::VectorXd& sizes);

}  // namespace plumbline

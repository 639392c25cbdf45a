// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace plumbline::test {

/// J^T J of `rows` random measurements of n parameters whose units differ by orders of magnitude,
/// as pixels and radians do.
inline Eigen::MatrixXd randomInformation(int n, int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd J(rows, n);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < n; ++j) J(i, j) = normal(random) * (j % 2 == 0 ? 1e3 : 1e-2);
  }
  return J.transpose() * J;
}

}  // namespace plumbline::test

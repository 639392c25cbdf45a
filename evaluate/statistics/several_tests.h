// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace plumbline {

/// Holm's step-down correction: p_(i) becomes max over j <= i of (m - j + 1) p_(j), at most 1. In
/// the order given.
std::vector<double> holm(const std::vector<double>& p);

/// Quade's test that k methods do not differ.
struct QuadeTest {
  double statistic = 0;    ///< F; infinite where the weighted ranks agree throughout
  int dof1 = 0, dof2 = 0;  ///< k - 1, (k - 1) (n - 1)
  double p = 1;
};

/// blocks[i][j]: participant i under method j. Ranks within a participant are weighted by the rank
/// of the participant's range (Quade, 1979). At least 2 participants and 2 methods, rows of one
/// length.
QuadeTest quade(const std::vector<std::vector<double>>& blocks);

}  // namespace plumbline

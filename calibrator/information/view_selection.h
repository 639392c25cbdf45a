// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace plumbline {

/// Collects views as long as each tells enough of the parameters. Information is additive over
/// views once each view's own pose is marginalised, so a candidate costs one small Cholesky.
class ViewSelector {
 public:
  /// `typical` holds one positive size per parameter, such as the diagonal of the information of
  /// all candidates: it decides when the views kept determine the parameters at all.
  ViewSelector(double threshold_bits, const Eigen::VectorXd& typical);

  /// Gain of a candidate given the views kept: 0.5 log2(|I + view| / |I|) [bits]. Empty as long as
  /// the views kept do not determine all parameters (the gain is unbounded then).
  std::optional<double> gainBits(const Eigen::MatrixXd& view) const;

  /// Keeps the view, and says true, if its gain is unbounded or reaches the threshold.
  bool offer(const Eigen::MatrixXd& view);

  /// Sum of the views kept.
  const Eigen::MatrixXd& information() const { return information_; }

 private:
  std::optional<double> logDeterminantScaled(const Eigen::MatrixXd& information) const;

  double threshold_bits_;
  Eigen::VectorXd inverse_scale_;
  Eigen::MatrixXd information_;
  std::optional<double> log_determinant_;  // of information_, scaled
};

/// 0 .. count - 1, shuffled (Fisher and Yates); the seed decides, alike on every platform. Of 64
/// bits the remainder is even enough.
std::vector<int> randomOrder(int count, std::uint64_t seed);

/// Kalibr's selection: the views are offered once, in an order shuffled by the seed; those kept, in
/// ascending order. `views` holds the information of every view over the same parameters.
std::vector<int> selectViews(const std::vector<Eigen::MatrixXd>& views, double threshold_bits,
                             std::uint64_t seed);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace plumbline {

/// Summary of the reprojection errors e [px] of a set of corners. Every tool prints another one of
/// these, so all are kept.
struct ErrorStatistics {
  double rmse_px = 0;    ///< sqrt(mean(|e|^2)) over corners
  double mean_px = 0;    ///< mean of |e|
  double median_px = 0;  ///< median of |e|
  double std_px = 0;     ///< standard deviation of |e| (divisor n); rmse^2 = mean^2 + std^2
  Eigen::Vector2d axis_mean_px = Eigen::Vector2d::Zero();  ///< mean of e_u, e_v
  Eigen::Vector2d axis_std_px = Eigen::Vector2d::Zero();   ///< std of e_u, e_v (divisor n)
  std::size_t count = 0;                                   ///< corners
};

/// Statistics of the given errors; all zero for none. Takes a copy because the median reorders.
ErrorStatistics summariseErrors(const std::vector<Eigen::Vector2d>& errors);

/// The q-quantile (0 <= q <= 1) of values by linear interpolation (type 7); values must not be
/// empty.
double quantile(std::vector<double> values, double q);

/// quantile(values, 0.5): the mean of the middle two where their number is even.
double median(std::vector<double> values);

/// The middle of values of any ordered type, the upper one of two: the median where an average of
/// two values would mean nothing more (stamps, starts of a search). Not empty.
template <class T>
T middleOf(std::vector<T> values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether a value takes the place of the largest so far: what is not a number is larger than every
/// number, and stays.
inline bool isLarger(double value, double largest) {
  return largest == largest && !(value <= largest);
}

/// Percents at which SampleStatistics keeps percentiles.
inline constexpr std::array<double, 6> kPercents = {1, 5, 25, 75, 95, 99};

/// What is said of a set of scalar errors x_i, i = 1..n, in their own unit.
struct SampleStatistics {
  double rmse = 0;    ///< sqrt(sse / n)
  double mean = 0;    ///< sum x / n
  double median = 0;  ///< mean of the middle two where n is even
  double std = 0;     ///< sqrt(sum (x - mean)^2 / (n - ddof))
  double min = 0;
  double max = 0;
  double sse = 0;                                      ///< sum x^2
  std::array<double, kPercents.size()> percentiles{};  ///< at kPercents, linear interpolation
  std::size_t n = 0;
};

/// Statistics of `values`; all zero for none. `ddof` 0 divides the variance by n (evo, rpg), 1 by
/// n - 1 (ov_eval; 0 there for a single value).
SampleStatistics sampleStatistics(std::vector<double> values, int ddof = 0);

/// Median of |e| over sigma where both axes of e have white noise of standard deviation sigma: that
/// of the Rayleigh distribution, sqrt(2 ln 2).
inline constexpr double kRayleighMedian = 1.1774100225154747;

/// A variance that was estimated from data: dof value / truth is a chi-square deviate with `dof`
/// degrees of freedom.
struct EstimatedVariance {
  double value = 0;
  double dof = std::numeric_limits<double>::infinity();  ///< infinite: the variance is known
};

/// Of the sum of two independent quantities (Welch 1947; Satterthwaite 1946):
///   v = v_1 + v_2,   dof = v^2 / (v_1^2 / dof_1 + v_2^2 / dof_2).
EstimatedVariance sumOf(const EstimatedVariance& a, const EstimatedVariance& b);

/// Standard deviations beside the degrees of freedom of the variances that they are roots of.
struct RobustDeviations {
  Eigen::VectorXd std, dof;
};

/// Half width of the 90 % interval about an estimate, in the unit of its deviation:
///   std t,   t the quantile 0.95 of Student's t with `dof` degrees of freedom,
/// of the normal distribution (1.645) where dof is infinite. NaN where either is, or dof is not
/// above 0.
double halfWidth90(double std, double dof);

/// Of every deviation; empty where there are none or their degrees of freedom are not known.
std::optional<Eigen::VectorXd> halfWidths90(const std::optional<Eigen::VectorXd>& std,
                                            const std::optional<Eigen::VectorXd>& dof);

/// Degrees of freedom of cluster-robust variances (calibrator/information/cluster_robust.h). That
/// of a combination l' p of the parameters is a sum over blocks,
///   v = sum_b (a_b' s_b)^2,   a_b = A_b l,
/// of scores s_b that have under white noise the covariance G_b where b = c less G_b G_c, G_b the
/// blocks' leverage in whitened parameters: that of a_b' s_b is W, and (Satterthwaite 1946)
///   dof = tr(W)^2 / tr(W^2).
struct ClusterDegrees {
  std::vector<Eigen::MatrixXd> adjustment;  ///< A_b
  std::vector<Eigen::MatrixXd> leverage;    ///< G_b

  double of(const Eigen::VectorXd& combination) const;
};

/// Cluster-robust ("sandwich") covariance of the cameras' parameters and the board's terms
/// (calibrator/batch/camera/information.h).
struct RobustCovariance {
  Eigen::MatrixXd matrix;  ///< in the order of CameraLayout
  /// What of it no block tells: a known board's, the corners' common error; empty: nothing.
  Eigen::MatrixXd known;
  /// The part of `known` that the corners' common error has; empty: nothing.
  Eigen::MatrixXd common;
  ClusterDegrees degrees;         ///< of the rest
  int blocks = 0;                 ///< M: the rest has rank M - 1 at most
  double correlation_frames = 1;  ///< correlation length of the scores [frames]

  /// Of a combination l' p of the parameters.
  EstimatedVariance variance(const Eigen::VectorXd& combination) const;
  /// Of what scatters alone: for those who use the same corners again.
  RobustCovariance withoutCommon() const;
  /// Of the first `count` parameters.
  RobustDeviations deviations(Eigen::Index count) const;
};

}  // namespace plumbline

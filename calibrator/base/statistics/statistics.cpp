// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/statistics/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrator/base/statistics/distributions.h"

namespace plumbline {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The q-quantile of ascending values (type 7). A position on a value needs no neighbour, which may
/// be infinite; between two infinite values there is no difference to take a share of.
double quantileOfSorted(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(position);
  // 0 also at the last value, which has no neighbour.
  const double share = position - static_cast<double>(low);
  if (share == 0 || sorted[low] == sorted[low + 1]) return sorted[low];
  return sorted[low] + share * (sorted[low + 1] - sorted[low]);
}

/// Of SampleStatistics what no order is needed for.
SampleStatistics momentsOf(const std::vector<double>& values, int ddof) {
  SampleStatistics s;
  s.n = values.size();
  if (values.empty()) return s;
  const auto n = static_cast<double>(values.size());
  for (const double x : values) {
    s.mean += x / n;
    s.sse += x * x;
  }
  s.rmse = std::sqrt(s.sse / n);
  double spread = 0;
  // In a second pass: sse - n mean^2 would cancel where values lie close about a large mean.
  for (const double x : values) spread += (x - s.mean) * (x - s.mean);
  if (n > ddof) s.std = std::sqrt(spread / (n - ddof));
  return s;
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  // Two order statistics, not a sort: medians of all corners' errors are taken often.
  const auto low = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(low);
  std::nth_element(values.begin(), at, values.end());
  // The neighbour above is the least of what nth_element() left behind.
  if (at + 1 != values.end()) std::iter_swap(at + 1, std::min_element(at + 1, values.end()));
  return quantileOfSorted(values, q);
}

ErrorStatistics summariseErrors(const std::vector<Eigen::Vector2d>& errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  const double n = static_cast<double>(errors.size());
  std::vector<double> norms;
  norms.reserve(errors.size());
  for (const Eigen::Vector2d& e : errors) {
    norms.push_back(e.norm());
    s.axis_mean_px += e / n;
  }
  Eigen::Vector2d axis_variance = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& e : errors) axis_variance += (e - s.axis_mean_px).cwiseAbs2() / n;
  s.axis_std_px = axis_variance.cwiseSqrt();
  const SampleStatistics of_norms = momentsOf(norms, 0);
  s.rmse_px = of_norms.rmse;
  s.mean_px = of_norms.mean;
  s.std_px = of_norms.std;
  s.median_px = median(std::move(norms));
  return s;
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

SampleStatistics sampleStatistics(std::vector<double> values, int ddof) {
  assert(ddof == 0 || ddof == 1);
  SampleStatistics s = momentsOf(values, ddof);
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  s.min = values.front();
  s.max = values.back();
  s.median = quantileOfSorted(values, 0.5);
  for (std::size_t i = 0; i < kPercents.size(); ++i) {
    s.percentiles[i] = quantileOfSorted(values, kPercents[i] / 100);
  }
  return s;
}

EstimatedVariance sumOf(const EstimatedVariance& a, const EstimatedVariance& b) {
  const double v = a.value + b.value;
  if (v == 0) return {};  // it is known that neither varies
  return {v, v * v / (a.value * a.value / a.dof + b.value * b.value / b.dof)};
}

double halfWidth90(double std, double dof) {
  // Said here, for the quantile of no degrees of freedom would throw.
  if (std::isnan(std) || !(dof > 0)) return std::numeric_limits<double>::quiet_NaN();
  // Two-sided: 5 % are left at either end.
  constexpr double kUpper = 0.95;
  return std * (std::isinf(dof) ? normalQuantile(kUpper) : studentsQuantile(dof, kUpper));
}

std::optional<VectorXd> halfWidths90(const std::optional<VectorXd>& std,
                                     const std::optional<VectorXd>& dof) {
  if (!std || !dof || std->size() != dof->size()) return std::nullopt;
  return std->binaryExpr(*dof, &halfWidth90);
}

double ClusterDegrees::of(const VectorXd& combination) const {
  const auto blocks = static_cast<Index>(adjustment.size());
  MatrixXd a(combination.size(), blocks), Ga(combination.size(), blocks);
  for (Index b = 0; b < blocks; ++b) {
    const auto at = static_cast<std::size_t>(b);
    a.col(b) = adjustment[at] * combination;
    Ga.col(b) = leverage[at] * a.col(b);
  }
  // W_bc = [b = c] a_b' G_b a_b - a_b' G_b G_c a_c.
  MatrixXd W = -(Ga.transpose() * Ga);
  W.diagonal() += a.cwiseProduct(Ga).colwise().sum();
  // W is symmetric: tr(W^2) is the sum of the squares of its entries.
  const double trace = W.trace();
  return trace * trace / W.squaredNorm();
}

EstimatedVariance RobustCovariance::variance(const VectorXd& combination) const {
  const auto along = [&](const MatrixXd& C) { return combination.dot(C * combination); };
  const double certain = known.size() > 0 ? along(known) : 0;
  // The known part has infinitely many degrees of freedom.
  return sumOf({along(matrix) - certain, degrees.of(combination)}, {certain});
}

RobustCovariance RobustCovariance::withoutCommon() const {
  RobustCovariance out = *this;
  if (common.size() == 0) return out;
  out.matrix -= common;
  out.known -= common;
  out.common = {};
  return out;
}

RobustDeviations RobustCovariance::deviations(Index count) const {
  RobustDeviations out{matrix.diagonal().head(count).cwiseSqrt(), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    out.dof(k) = variance(VectorXd::Unit(matrix.rows(), k)).dof;
  }
  return out;
}

}  // namespace plumbline

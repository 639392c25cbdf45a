// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/half_width.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrator/base/statistics/distributions.h"

namespace plumbline {

double halfWidth95(double std, double dof) {
  if (std::isnan(std) || !(dof > 0)) return std::numeric_limits<double>::quiet_NaN();
  constexpr double kUpper = 0.975;
  return std * (std::isinf(dof) ? normalQuantile(kUpper) : studentsQuantile(dof, kUpper));
}

double normalDeviate(double difference, const EstimatedVariance& variance) {
  const double t = std::abs(difference) / std::sqrt(variance.value), dof = variance.dof;
  if (std::isnan(t) || !(dof > 0)) return std::numeric_limits<double>::quiet_NaN();
  if (std::isinf(dof)) return t;
  const double beyond = studentsTail(dof, t);
  return normalTailQuantile(std::max(beyond, std::numeric_limits<double>::min()));
}

double standardError(const std::vector<double>& values) {
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  return sampleStatistics(values, 1).std / std::sqrt(static_cast<double>(values.size()));
}

}  // namespace plumbline

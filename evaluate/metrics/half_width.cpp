// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/half_width.h"

#include <cmath>
#include <limits>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

double halfWidth95(double std, double dof) {
  if (std::isnan(std) || !(dof > 0)) return std::numeric_limits<double>::quiet_NaN();
  constexpr double kUpper = 0.975;
  return std * (std::isinf(dof) ? boost::math::quantile(boost::math::normal(), kUpper)
                                : boost::math::quantile(boost::math::students_t(dof), kUpper));
}

double standardError(const std::vector<double>& values) {
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  return sampleStatistics(values, 1).std / std::sqrt(static_cast<double>(values.size()));
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/statistics/distributions.h"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace plumbline {

namespace bm = boost::math;

double normalShare(double x) { return bm::cdf(bm::normal(), x); }
double normalTail(double x) { return bm::cdf(bm::complement(bm::normal(), x)); }
double normalQuantile(double share) { return bm::quantile(bm::normal(), share); }
double normalTailQuantile(double tail) { return bm::quantile(bm::complement(bm::normal(), tail)); }

double studentsTail(double dof, double t) {
  return bm::cdf(bm::complement(bm::students_t(dof), t));
}
double studentsQuantile(double dof, double share) {
  return bm::quantile(bm::students_t(dof), share);
}

double chiSquaredQuantile(double dof, double share) {
  return bm::quantile(bm::chi_squared(dof), share);
}
double chiSquaredTailQuantile(double dof, double tail) {
  return bm::quantile(bm::complement(bm::chi_squared(dof), tail));
}

double fisherTail(double dof1, double dof2, double f) {
  return bm::cdf(bm::complement(bm::fisher_f(dof1, dof2), f));
}
double fisherTailQuantile(double dof1, double dof2, double tail) {
  return bm::quantile(bm::complement(bm::fisher_f(dof1, dof2), tail));
}

double coinShare(double n, double successes) { return bm::cdf(bm::binomial(n, 0.5), successes); }

}  // namespace plumbline

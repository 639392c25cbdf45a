// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/chi_square.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/SpecialFunctions>

namespace plumbline {
namespace {

constexpr double kManyDegrees = 200;
constexpr int kHalvings = 60;

// Where `cumulative`, which grows, is p; between low and high.
template <class Function>
double inverse(Function cumulative, double p, double low, double high) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (cumulative(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double normalQuantile(double p) {
  return inverse([](double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }, p, -9, 9);
}

}  // namespace

double chiSquareQuantile(double dof, double p) {
  assert(dof > 0 && p > 0 && p < 1);
  if (dof > kManyDegrees) {
    const double a = 2 / (9 * dof);
    return dof * std::pow(1 - a + normalQuantile(p) * std::sqrt(a), 3);
  }
  const auto cumulative = [&](double x) { return Eigen::numext::igamma(dof / 2, x / 2); };
  return inverse(cumulative, p, 0, dof + 40 + 20 * std::sqrt(dof));
}

}  // namespace plumbline

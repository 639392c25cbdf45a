// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <utility>

#include "calibrator/linear/levenberg_marquardt.h"

namespace plumbline {

/// A few parameters in least squares as minimise() wants them. `sums_at(point)` gives H, b and
/// cost, the sum of squares (infinite outside the domain); `moved(point, x)` the point after a
/// step.
template <class Point, class SumsAt, class Moved>
class DenseSteps {
 public:
  /// `regular`: share of the diagonal of H that is added to it, where parameters may be free.
  DenseSteps(Point start, SumsAt sums_at, Moved moved, double regular = 0)
      : sums_at_(std::move(sums_at)),
        moved_(std::move(moved)),
        regular_(regular),
        point_(std::move(start)),
        now_(sums_at_(point_)) {}

  const Point& point() const { return point_; }
  const auto& sums() const { return now_; }
  double cost() const { return 0.5 * now_.cost; }

  std::optional<double> solve(double damping) {
    auto A = now_.H;
    // Marquardt's scaling: parameters differ in their units and sizes.
    A.diagonal() *= 1 + damping + regular_;
    const Eigen::LLT<decltype(A)> llt(A);
    if (llt.info() != Eigen::Success) return std::nullopt;
    // The decrement b' A^-1 b of minimise() is -x' b.
    x_ = -llt.solve(now_.b);
    return -x_.dot(now_.b);
  }

  Trial attempt() {
    next_point_ = moved_(point_, x_);
    next_ = sums_at_(next_point_);
    return {.cost = 0.5 * next_.cost};
  }

  void accept() {
    point_ = next_point_;
    now_ = next_;
  }

  static bool refuse() { return false; }

 private:
  using Sums = decltype(std::declval<SumsAt>()(std::declval<const Point&>()));

  SumsAt sums_at_;
  Moved moved_;
  double regular_;
  Point point_, next_point_;
  Sums now_, next_;
  decltype(Sums::b) x_;
};

}  // namespace plumbline

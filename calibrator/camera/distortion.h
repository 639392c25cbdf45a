// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace plumbline {

/// Distorted plane coordinates with derivatives. A distortion is a type without state: distort()
/// gives this; radial() is the radius after its radial part; squaredRadiusLimit() the square of the
/// radius at which that stops growing (infinite where it never does). Where the limit must be
/// searched for, surelyGrows() may spare that: true only if the radius grows all the way to r^2.
template <class T, int kCoefficients>
struct Distorted {
  T x, y;                                           ///< [-]
  T J_xx, J_xy, J_yx, J_yy;                         ///< J_ab = d distorted a / d undistorted b
  T J_k[2][kCoefficients > 0 ? kCoefficients : 1];  ///< d (x, y) / d coefficients
};

/// Whether r^2 is below the limit of the radius.
template <class Distortion>
bool isBelowLimit(const double* k, double r2) {
  if constexpr (requires { Distortion::surelyGrows(k, r2); }) {
    if (Distortion::surelyGrows(k, r2)) return true;
  }
  return r2 < Distortion::squaredRadiusLimit(k);
}

/// The undistorted radius whose radial distortion is `target`, by bisection: a start for Newton
/// that is on the right side of the fold.
template <class Distortion>
double startRadius(const double* k, double target) {
  constexpr double kWidest = 1e4;
  constexpr int kSteps = 50;
  double low = 0;
  double high = std::min(kWidest, std::sqrt(Distortion::squaredRadiusLimit(k)));
  if (Distortion::radial(k, high) <= target) return high * (1 - 1e-6);
  for (int i = 0; i < kSteps; ++i) {
    const double middle = 0.5 * (low + high);
    (Distortion::radial(k, middle) < target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Newton's method for distort(x, y) = (m_x, m_y) from `start`, to 1e-12; empty where it does not
/// get there within `most_steps` or ends beyond the limit of the radius.
template <class Distortion>
std::optional<std::array<double, 2>> undistortedFrom(std::array<double, 2> start, const double* k,
                                                     double m_x, double m_y, int most_steps) {
  const double scale = 1 + std::sqrt(m_x * m_x + m_y * m_y);
  auto [x, y] = start;
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_steps; ++i) {
    const auto d = Distortion::distort(k, x, y);
    const double miss_x = d.x - m_x;
    const double miss_y = d.y - m_y;
    const double miss = std::sqrt(miss_x * miss_x + miss_y * miss_y);
    // Done at rounding, or where it no longer improves.
    if (miss <= 4e-15 * scale || (miss < 1e-12 && miss >= last)) {
      if (isBelowLimit<Distortion>(k, x * x + y * y)) return std::array<double, 2>{x, y};
      return std::nullopt;
    }
    last = miss;
    const double determinant = d.J_xx * d.J_yy - d.J_xy * d.J_yx;
    x -= (d.J_yy * miss_x - d.J_xy * miss_y) / determinant;
    y -= (d.J_xx * miss_y - d.J_yx * miss_x) / determinant;
    if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
  }
  return std::nullopt;
}

/// The plane point (x, y) with distort(x, y) = (m_x, m_y), to 1e-12; empty where there is none
/// below the limit of the radius. The distorted point itself is a good start nearly everywhere.
template <class Distortion>
std::optional<std::array<double, 2>> undistorted(const double* k, double m_x, double m_y) {
  constexpr int kFewSteps = 8;
  constexpr int kMostSteps = 50;
  const double radius = std::hypot(m_x, m_y);
  if (!std::isfinite(radius)) return std::nullopt;
  const auto near = undistortedFrom<Distortion>({m_x, m_y}, k, m_x, m_y, kFewSteps);
  if (near || radius == 0) return near;
  const double scale = startRadius<Distortion>(k, radius) / radius;
  return undistortedFrom<Distortion>({scale * m_x, scale * m_y}, k, m_x, m_y, kMostSteps);
}

}  // namespace plumbline

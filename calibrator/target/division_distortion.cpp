// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/division_distortion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

struct LinePoint {
  Eigen::Vector2d d;                 ///< relative to the centre, in units of the radius
  std::array<std::size_t, 2> lines;  ///< along x and along y, that the corner lies on
};

/// Every row of tags has two lines, along the bottoms and the tops of its tags; behind those every
/// column has two, along their left and right edges.
std::vector<LinePoint> linePoints(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                  const DivisionDistortion& distortion) {
  std::vector<LinePoint> points;
  for (const TagImage& tag : tags) {
    const std::size_t row = tag.id / grid.cols, col = grid.rows + tag.id % grid.cols;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tag.located[k]) continue;
      points.push_back({(tag.uv[k] - distortion.centre) / distortion.radius,
                        {2 * row + (k >= 2 ? 1 : 0), 2 * col + (k == 1 || k == 2 ? 1 : 0)}});
    }
  }
  return points;
}

/// See estimateDistortion(): the share of the squared lengths that lies across the lines; infinite
/// where no line counts or a point lies beyond the model.
double bending(const AprilGrid& grid, const std::vector<LinePoint>& points,
               const Eigen::Vector3d& terms) {
  std::vector<Moments> lines(2 * (grid.rows + grid.cols), Moments::Zero());
  for (const LinePoint& point : points) {
    const double by = divisor(terms, point.d.squaredNorm());
    if (!(by > 0)) return HUGE_VAL;
    const Moments m = moments(point.d / by);
    for (const std::size_t line : point.lines) lines[line] += m;
  }
  double across = 0, along = 0;
  for (const Moments& m : lines) {
    if (m[0] < 4) continue;  // two tags: their four points
    const double xx = m[3] - m[1] * m[1] / m[0];
    const double xy = m[4] - m[1] * m[2] / m[0];
    const double yy = m[5] - m[2] * m[2] / m[0];
    // The eigenvalues of the scatter are (xx + yy -+ spread) / 2: least squares across and along.
    const double spread = std::hypot(xx - yy, 2 * xy);
    across += std::max(0.0, 0.5 * (xx + yy - spread));
    along += 0.5 * (xx + yy + spread);
  }
  return along > 0 ? across / along : HUGE_VAL;
}

}  // namespace

Eigen::Vector2d DivisionDistortion::straighten(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d d = (uv - centre) / radius;
  return centre + radius / divisor(terms, d.squaredNorm()) * d;
}

Eigen::Matrix2d DivisionDistortion::jacobian(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d d = (uv - centre) / radius;
  const double square = d.squaredNorm();
  const double g = 1 / divisor(terms, square);
  // Of the divisor by d: slope * d.
  const double slope = 2 * terms[0] + square * (4 * terms[1] + square * 6 * terms[2]);
  return g * (Eigen::Matrix2d::Identity() - g * slope * d * d.transpose());
}

Eigen::Vector2d DivisionDistortion::distort(const Eigen::Vector2d& straight) const {
  // With s and d the lengths before and after: l1 s d^2 - d + s = 0; the root that is s at 0.
  const Eigen::Vector2d s = (straight - centre) / radius;
  // Written as 2 s / (1 + root), which does not cancel for a small l1. Beyond the largest s
  // that the model reaches the root is taken as 0.
  const double root = std::sqrt(std::max(0.0, 1 - 4 * terms[0] * s.squaredNorm()));
  return centre + radius * 2 / (1 + root) * s;
}

DivisionDistortion estimateDistortion(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                      const Resolution& resolution, std::size_t min_tags) {
  DivisionDistortion distortion;
  distortion.centre = {0.5 * (resolution.width - 1), 0.5 * (resolution.height - 1)};
  distortion.radius = 0.5 * std::hypot(resolution.width, resolution.height);
  if (tags.size() < min_tags) return distortion;
  const std::vector<LinePoint> points = linePoints(grid, tags, distortion);
  double furthest = 1e-3;
  for (const LinePoint& p : points) furthest = std::max(furthest, p.d.squaredNorm());
  // The model needs 1 + l1 |d|^2 > 0; pincushion beyond 0.5 does not occur.
  double low = std::max(-4.0, -0.9 / furthest);
  double high = 0.5;
  constexpr int kSamples = 9;  // each round keeps the two intervals around the best sample
  for (int round = 0; round < 5; ++round) {
    const double step = (high - low) / (kSamples - 1);
    int best = 0;
    double least = HUGE_VAL;
    for (int i = 0; i < kSamples; ++i) {
      const double value = bending(grid, points, {low + i * step, 0, 0});
      if (value < least) {
        least = value;
        best = i;
      }
    }
    if (!(least < HUGE_VAL)) return distortion;
    const double middle = low + best * step;
    low = std::max(-0.99 / furthest, middle - step);  // nearer to the pole, but not beyond it
    high = middle + step;
  }
  distortion.terms[0] = 0.5 * (low + high);
  return distortion;
}

DivisionDistortion refineDistortion(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                    const DivisionDistortion& start) {
  if (start.terms.isZero()) return start;
  constexpr double kStep = 1e-3;  // of differences: tenths of a pixel where a grid fills the image
  constexpr int kIterations = 4;
  const std::vector<LinePoint> points = linePoints(grid, tags, start);
  const auto at = [&](const Eigen::Vector3d& terms) { return bending(grid, points, terms); };
  const Eigen::Matrix3d steps = kStep * Eigen::Matrix3d::Identity();
  DivisionDistortion refined = start;
  double least = at(start.terms);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Vector3d up, gradient;
    Eigen::Matrix3d hessian;
    for (int i = 0; i < 3; ++i) {
      up[i] = at(refined.terms + steps.col(i));
      const double down = at(refined.terms - steps.col(i));
      gradient[i] = 0.5 * (up[i] - down);
      hessian(i, i) = up[i] - 2 * least + down;
      for (int j = 0; j < i; ++j) {
        const double both = at(refined.terms + steps.col(i) + steps.col(j));
        hessian(i, j) = hessian(j, i) = both - up[i] - up[j] + least;
      }
    }
    const SymmetricFactor factor(hessian);
    if (!factor.isPositive()) break;
    const Eigen::Vector3d next = refined.terms - kStep * factor.solve(gradient).col(0);
    const double value = at(next);
    if (!(value < least)) break;
    refined.terms = next;
    least = value;
  }
  return refined;
}

}  // namespace plumbline

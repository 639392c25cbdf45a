// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/division_distortion.h"

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

/// First and second moments of points, from which a line is fitted.
struct LineMoments {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  void add(const Eigen::Vector2d& p) {
    n += 1;
    x += p.x();
    y += p.y();
    xx += p.x() * p.x();
    xy += p.x() * p.y();
    yy += p.y() * p.y();
  }
};

/// Sums over lines: squared distances across and along them.
struct Straightness {
  double across = 0;
  double along = 0;

  void add(const LineMoments& m) {
    if (m.n < 4) return;  // two tags: their four points
    const double xx = m.xx - m.x * m.x / m.n;
    const double xy = m.xy - m.x * m.y / m.n;
    const double yy = m.yy - m.y * m.y / m.n;
    const double spread = std::hypot(xx - yy, 2 * xy);
    across += std::max(0.0, 0.5 * (xx + yy - spread));
    along += 0.5 * (xx + yy + spread);
  }
};

struct LinePoint {
  Eigen::Vector2d d;     ///< relative to the centre, in units of the radius
  std::size_t row_line;  ///< line along x that the corner lies on
  std::size_t column_line;
};

std::vector<LinePoint> linePoints(const AprilGrid& grid, const std::vector<TagImage>& tags,
                                  const DivisionDistortion& distortion) {
  std::vector<LinePoint> points;
  for (const TagImage& tag : tags) {
    const auto row = static_cast<std::size_t>(tag.id / grid.cols);
    const auto col = static_cast<std::size_t>(tag.id % grid.cols);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tag.located[k]) continue;
      points.push_back({(tag.uv[k] - distortion.centre) / distortion.radius,
                        2 * row + (k >= 2 ? 1 : 0), 2 * col + (k == 1 || k == 2 ? 1 : 0)});
    }
  }
  return points;
}

double bending(const AprilGrid& grid, const std::vector<LinePoint>& points, double lambda) {
  std::vector<LineMoments> rows(2 * static_cast<std::size_t>(grid.rows));
  std::vector<LineMoments> columns(2 * static_cast<std::size_t>(grid.cols));
  for (const LinePoint& point : points) {
    const Eigen::Vector2d straight = point.d / (1 + lambda * point.d.squaredNorm());
    rows[point.row_line].add(straight);
    columns[point.column_line].add(straight);
  }
  Straightness sum;
  for (const LineMoments& line : rows) sum.add(line);
  for (const LineMoments& line : columns) sum.add(line);
  return sum.along > 0 ? sum.across / sum.along : 0;
}

}  // namespace

Eigen::Vector2d DivisionDistortion::straighten(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d d = (uv - centre) / radius;
  return centre + radius / (1 + lambda * d.squaredNorm()) * d;
}

Eigen::Vector2d DivisionDistortion::distort(const Eigen::Vector2d& straight) const {
  // With s and d the lengths before and after: lambda s d^2 - d + s = 0; the root that is s at 0.
  const Eigen::Vector2d s = (straight - centre) / radius;
  const double root = std::sqrt(std::max(0.0, 1 - 4 * lambda * s.squaredNorm()));
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
  // The model needs 1 + lambda |d|^2 > 0; pincushion beyond 0.5 does not occur.
  double low = std::max(-4.0, -0.9 / furthest);
  double high = 0.5;
  constexpr int kSamples = 9;  // each round keeps the two intervals around the best sample
  for (int round = 0; round < 5; ++round) {
    const double step = (high - low) / (kSamples - 1);
    int best = 0;
    double least = HUGE_VAL;
    for (int i = 0; i < kSamples; ++i) {
      const double value = bending(grid, points, low + i * step);
      if (value < least) {
        least = value;
        best = i;
      }
    }
    const double middle = low + best * step;
    low = middle - step;
    high = middle + step;
  }
  distortion.lambda = 0.5 * (low + high);
  return distortion;
}

}  // namespace plumbline

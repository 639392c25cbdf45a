// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <bit>
#include <vector>

#include "calibrator/target/tag_image.h"

namespace plumbline {
namespace {

/// A grey value that varies linearly over the tag: c0 + c1 x + c2 y, least squares.
class GrayPlane {
 public:
  void add(double x, double y, double gray) {
    const Eigen::Vector3d row(1, x, y);
    normal_ += row * row.transpose();
    right_ += row * gray;
  }
  Eigen::Vector3d solve() const { return normal_.ldlt().solve(right_); }

 private:
  // So that a plane without samples is zero, and fails by its contrast.
  Eigen::Matrix3d normal_ = 1e-6 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
};

/// Mean grey of the middle of each cell of the tag, row by row from the bottom-left.
using CellGrays = std::vector<double>;

CellGrays sampleCells(const GrayImageView& image, const Eigen::Matrix3d& H, int cells) {
  CellGrays grays;
  grays.reserve(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  constexpr double kOffsets[] = {-0.2, 0.2};
  for (int row = 0; row < cells; ++row) {
    for (int col = 0; col < cells; ++col) {
      double sum = 0;
      for (const double dy : kOffsets) {
        for (const double dx : kOffsets) {
          sum += sampleBilinear(image,
                                mapPoint(H, (col + 0.5 + dx) / cells, (row + 0.5 + dy) / cells));
        }
      }
      grays.push_back(sum / 4);
    }
  }
  return grays;
}

/// Undoes part of the blur: v + strength * (4 v - its four neighbours), for the payload's cells.
double sharpened(const CellGrays& grays, int cells, int col, int row, double strength) {
  const auto at = [&](int x, int y) { return grays[y * cells + x]; };
  const double v = at(col, row);
  const double around = at(col - 1, row) + at(col + 1, row) + at(col, row - 1) + at(col, row + 1);
  return v + strength * (4 * v - around);
}

/// By the outermost cells of the border.
Eigen::Vector3d blackPlane(const CellGrays& grays, int cells) {
  GrayPlane plane;
  for (int i = 0; i < cells; ++i) {
    for (const auto& [x, y] : {std::pair{i, 0}, {i, cells - 1}, {0, i}, {cells - 1, i}}) {
      plane.add((x + 0.5) / cells, (y + 0.5) / cells, grays[y * cells + x]);
    }
  }
  return plane.solve();
}

/// The paper beside the four edges, clear of the small squares at the corners.
Eigen::Vector3d whitePlane(const GrayImageView& image, const Eigen::Matrix3d& H, int cells) {
  GrayPlane plane;
  const double out = 0.9 / cells;
  for (double along = 0.15; along < 0.9; along += 0.1) {
    for (const auto& [x, y] :
         {std::pair{along, -out}, {along, 1 + out}, {-out, along}, {1 + out, along}}) {
      const Eigen::Vector2d at = mapPoint(H, x, y);
      if (isInside(at, {image.width, image.height})) plane.add(x, y, sampleBilinear(image, at));
    }
  }
  return plane.solve();
}

/// The corners of the area that is sampled: `margin` of the edge inside the tag's own, on all
/// sides.
bool payloadInside(const GrayImageView& image, const Eigen::Matrix3d& H, double margin) {
  for (const double x : {margin, 1 - margin}) {
    for (const double y : {margin, 1 - margin}) {
      if (!isInside(mapPoint(H, x, y), {image.width, image.height})) return false;
    }
  }
  return true;
}

}  // namespace

Eigen::Matrix3d squareToQuad(const TagCorners& uv) {
  const Eigen::Vector2d d1 = uv[1] - uv[2];
  const Eigen::Vector2d d2 = uv[3] - uv[2];
  const Eigen::Vector2d s = uv[0] - uv[1] + uv[2] - uv[3];
  Eigen::Matrix2d A;
  A << d1, d2;
  // Of H's last row (g, h, 1). Corners 1, 2, 3 in line make A singular; the caller sees an H that
  // is not finite.
  const Eigen::Vector2d gh = A.inverse() * s;
  Eigen::Matrix3d H;
  H.col(0) << uv[1] - uv[0] + gh.x() * uv[1], gh.x();
  H.col(1) << uv[3] - uv[0] + gh.y() * uv[3], gh.y();
  H.col(2) << uv[0], 1;
  return H;
}

double sampleBilinear(const GrayImageView& image, const Eigen::Vector2d& at) {
  const double x = std::clamp(at.x(), 0.0, image.width - 1.0);
  const double y = std::clamp(at.y(), 0.0, image.height - 1.0);
  const int x0 = std::min(static_cast<int>(x), std::max(image.width - 2, 0));
  const int y0 = std::min(static_cast<int>(y), std::max(image.height - 2, 0));
  const int right = image.width > 1 ? 1 : 0;
  const std::uint8_t* upper = image.row(y0) + x0;
  const std::uint8_t* lower = image.row(image.height > 1 ? y0 + 1 : y0) + x0;
  const double fx = x - x0;
  const double fy = y - y0;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[right]) +
         fy * ((1 - fx) * lower[0] + fx * lower[right]);
}

std::optional<int> payloadDistance(const GrayImageView& image, const TagImage& tag, int border_bits,
                                   double min_contrast) {
  const int cells = tagCells(border_bits);
  const Eigen::Matrix3d H = squareToQuad(tag.uv);
  if (!H.allFinite() ||
      !payloadInside(image, H, (border_bits + 0.3) / static_cast<double>(cells))) {
    return std::nullopt;
  }
  const CellGrays grays = sampleCells(image, H, cells);
  const Eigen::Vector3d black = blackPlane(grays, cells);
  const Eigen::Vector3d white = whitePlane(image, H, cells);
  const Eigen::Vector3d contrast = white - black;
  // In the middle of the tag.
  if (!(contrast.x() + 0.5 * contrast.y() + 0.5 * contrast.z() >= min_contrast)) {
    return std::nullopt;
  }
  // Half way between two planes, not two levels: light may fall off over the tag.
  const Eigen::Vector3d threshold = 0.5 * (black + white);
  const double cell_px = shortestEdge(tag.uv) / cells;
  // Full below cells of 1.5 px, none from 4.5 px on.
  const double strength = std::clamp(0.45 - 0.1 * cell_px, 0.0, 0.3);
  std::uint64_t payload = 0;
  for (int row = 0; row < kPayloadCells; ++row) {
    for (int col = 0; col < kPayloadCells; ++col) {
      const int x = col + border_bits;
      const int y = row + border_bits;
      const double limit = threshold.dot(Eigen::Vector3d(1, (x + 0.5) / cells, (y + 0.5) / cells));
      const bool is_white = sharpened(grays, cells, x, y, strength) > limit;
      payload |= std::uint64_t{is_white} << (kPayloadCells * row + col);
    }
  }
  return std::popcount(payload ^ tagPayload(tag.id));
}

}  // namespace plumbline

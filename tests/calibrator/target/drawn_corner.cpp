// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/target/drawn_corner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace plumbline::test {
namespace {

constexpr int kFine = 8;

/// Every row blurred, then transposed.
std::vector<double> blurredAcross(const std::vector<double>& in, int width, int height,
                                  double sigma) {
  const int radius = static_cast<int>(4 * sigma);
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    sum += kernel.emplace_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  }
  std::vector<double> out(in.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double value = 0;
      for (int i = -radius; i <= radius; ++i) {
        value += kernel[i + radius] * in[y * width + std::clamp(x + i, 0, width - 1)];
      }
      out[x * height + y] = value / sum;
    }
  }
  return out;
}

}  // namespace

GrayImage drawCorner(const Eigen::Vector2d& p, const Eigen::Matrix2d& axes,
                     const CornerLook& look) {
  const Eigen::Matrix2d inverse = (look.lens.jacobian(p) * axes).inverse();
  const Eigen::Vector2d origin = look.lens.straighten(p);
  const Eigen::Vector2d scale = inverse.rowwise().norm().cwiseInverse();
  constexpr int kW = kDrawnWidth * kFine, kH = kDrawnHeight * kFine;
  std::vector<double> canvas(kW * kH);
  for (int y = 0; y < kH; ++y) {
    for (int x = 0; x < kW; ++x) {
      const Eigen::Vector2d at((x + 0.5) / kFine - 0.5, (y + 0.5) / kFine - 0.5);
      const Eigen::Vector2d q = inverse * (look.lens.straighten(at) - origin);
      // Distances from the edges, in pixels; q is in units of the axes.
      const double a = q.x() * scale.x(), b = q.y() * scale.y();
      const bool inked = a * b > 0 || std::min(std::abs(a), std::abs(b)) < look.ink_px;
      const bool covered = (at - p).dot(Eigen::Vector2d(0.6, -0.8)) > look.cover_px;
      canvas[y * kW + x] = (covered ? 120 : inked ? 40 : 200) * (1 + look.light.dot(at - p));
    }
  }
  canvas = blurredAcross(canvas, kW, kH, look.blur_px * kFine);
  canvas = blurredAcross(canvas, kH, kW, look.blur_px * kFine);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  GrayImage image(kDrawnWidth, kDrawnHeight);
  for (int y = 0; y < kDrawnHeight; ++y) {
    for (int x = 0; x < kDrawnWidth; ++x) {
      double sum = 0;
      for (int i = 0; i < kFine * kFine; ++i) {
        sum += canvas[(y * kFine + i / kFine) * kW + x * kFine + i % kFine];
      }
      const double gray = sum / (kFine * kFine) + look.noise_gray * noise(random);
      image.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(gray), 0L, 255L));
    }
  }
  return image;
}

}  // namespace plumbline::test

// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/target/rendered_grid.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "calibrator/target/tag_family.h"

namespace plumbline::test {
namespace {

/// Grey values before rounding.
struct Canvas {
  int width, height;
  std::vector<double> gray;
  Canvas(int w, int h, double value)
      : width(w),
        height(h),
        gray(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  double& at(int x, int y) {
    return gray[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x)];
  }
};

int uniform(std::mt19937& random, int below) {
  return static_cast<int>(random() % static_cast<std::uint32_t>(below));
}

Canvas rectangles(int width, int height, const RenderOptions& options) {
  std::mt19937 random(options.seed);
  Canvas canvas(width, height, 0.5 * (options.white + options.black));
  for (int i = 0; i < 150; ++i) {
    const int x0 = uniform(random, width), y0 = uniform(random, height);
    const int x1 = std::min(width, x0 + 5 + uniform(random, 80));
    const int y1 = std::min(height, y0 + 5 + uniform(random, 80));
    const double gray =
        options.black + uniform(random, static_cast<int>(options.white - options.black));
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) canvas.at(x, y) = gray;
    }
  }
  return canvas;
}

void blurRows(Canvas& canvas, const std::vector<double>& kernel) {
  const int radius = static_cast<int>(kernel.size()) / 2;
  std::vector<double> line(static_cast<std::size_t>(canvas.width));
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      double sum = 0;
      for (int i = -radius; i <= radius; ++i) {
        sum += kernel[static_cast<std::size_t>(i + radius)] *
               canvas.at(std::clamp(x + i, 0, canvas.width - 1), y);
      }
      line[static_cast<std::size_t>(x)] = sum;
    }
    std::copy(line.begin(), line.end(), &canvas.at(0, y));
  }
}

Canvas transposed(Canvas& canvas) {
  Canvas out(canvas.height, canvas.width, 0);
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) out.at(y, x) = canvas.at(x, y);
  }
  return out;
}

Canvas blurred(Canvas canvas, double sigma) {
  if (sigma <= 0) return canvas;
  const int radius = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += kernel.back();
  }
  for (double& k : kernel) k /= sum;
  blurRows(canvas, kernel);
  Canvas turned = transposed(canvas);
  blurRows(turned, kernel);
  return transposed(turned);
}

GrayImage develop(Canvas canvas, const RenderOptions& options) {
  canvas = blurred(std::move(canvas), options.blur_px);
  std::mt19937 random(options.seed + 1000);
  std::normal_distribution<double> noise(0, 1);
  GrayImage image(canvas.width, canvas.height);
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      const double gray = canvas.at(x, y) + options.noise_gray * noise(random);
      image.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(gray), 0L, 255L));
    }
  }
  return image;
}

/// Rays through a pixel: a Fibonacci lattice, so that edges of any direction, rows and columns too,
/// sweep over the rays one after the other.
constexpr int kRays = 21;
double rayOffset(int i) { return (i % kRays + 0.5) / kRays - 0.5; }

/// Target plane to normalised image coordinates and back.
Eigen::Matrix3d planeHomography(const TestCamera& camera) {
  Eigen::Matrix3d H;
  H << camera.R.col(0), camera.R.col(1), camera.t;
  return H;
}

bool onPaper(const AprilGrid& grid, const Eigen::Vector2d& p_F) {
  const double margin = 1.6 * grid.spacing * grid.tag_size;
  return p_F.x() > -margin && p_F.y() > -margin && p_F.x() < grid.width() + margin &&
         p_F.y() < grid.height() + margin;
}

}  // namespace

std::optional<Eigen::Vector2d> TestCamera::project(const Eigen::Vector2d& p_F) const {
  const Eigen::Vector3d p = R * Eigen::Vector3d(p_F.x(), p_F.y(), 0) + t;
  if (p.z() <= 0) return std::nullopt;
  const Eigen::Vector2d n = p.head<2>() / p.z();
  const double r2 = n.squaredNorm();
  if (1 + 3 * k1 * r2 + 5 * k2 * r2 * r2 <= 0.05) return std::nullopt;
  const Eigen::Vector2d d = n * (1 + k1 * r2 + k2 * r2 * r2);
  return Eigen::Vector2d(focal * d + Eigen::Vector2d(0.5 * (width - 1), 0.5 * (height - 1)));
}

Eigen::Vector2d TestCamera::undistort(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d d = (uv - Eigen::Vector2d(0.5 * (width - 1), 0.5 * (height - 1))) / focal;
  const double wanted = d.norm();
  double r = wanted;
  for (int i = 0; i < 6; ++i) {
    const double r2 = r * r;
    r -= (r * (1 + k1 * r2 + k2 * r2 * r2) - wanted) / (1 + 3 * k1 * r2 + 5 * k2 * r2 * r2);
  }
  return wanted > 0 ? Eigen::Vector2d(d * (r / wanted)) : d;
}

TestCamera lookAt(const Eigen::Vector2d& at_F, double distance, double tilt_x, double tilt_y,
                  double roll) {
  using Eigen::AngleAxisd;
  TestCamera camera;
  const Eigen::Matrix3d facing = camera.R;
  camera.R =
      AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * facing *
      (AngleAxisd(tilt_x, Eigen::Vector3d::UnitX()) * AngleAxisd(tilt_y, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  camera.t = Eigen::Vector3d(0, 0, distance) - camera.R * Eigen::Vector3d(at_F.x(), at_F.y(), 0);
  return camera;
}

GrayImage renderGrid(const AprilGrid& grid, const TestCamera& camera,
                     const RenderOptions& options) {
  const Eigen::Matrix3d plane_from_ray = planeHomography(camera).inverse();
  Canvas canvas = rectangles(camera.width, camera.height, options);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double background = canvas.at(x, y);
      const Eigen::Vector2d centre = camera.undistort({x, y});
      const Eigen::Vector2d across =
          camera.undistort({x + 0.5, y}) - camera.undistort({x - 0.5, y});
      const Eigen::Vector2d down = camera.undistort({x, y + 0.5}) - camera.undistort({x, y - 0.5});
      double sum = 0;
      for (int i = 0; i < kRays; ++i) {
        const Eigen::Vector2d ray = centre + rayOffset(i) * across + rayOffset(13 * i) * down;
        const Eigen::Vector3d p = plane_from_ray * Eigen::Vector3d(ray.x(), ray.y(), 1);
        const Eigen::Vector2d p_F = p.head<2>() / p.z();
        const bool seen = p.z() > 0 && onPaper(grid, p_F);
        const double paper =
            seen && gridIsBlack(grid, p_F, options.border_bits) ? options.black : options.white;
        sum += seen ? paper : background;
      }
      canvas.at(x, y) = sum / kRays;
    }
  }
  return develop(std::move(canvas), options);
}

GrayImage renderClutter(int width, int height, const RenderOptions& options) {
  return develop(rectangles(width, height, options), options);
}

}  // namespace plumbline::test

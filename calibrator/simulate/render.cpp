// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/render.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/simulate/image_formation.h"
#include "calibrator/target/tag_family.h"

namespace plumbline {
namespace {

constexpr int kSamples = 64;
/// Steps towards a board that is not flat, see cast().
constexpr int kBoardSteps = 3;
constexpr float kFarAway = 1e6F;  // of rays along the wall: no target there

/// Hammersley's set in the pixel's square, (0, 1) along both sides: any edge parallel to a side is
/// resolved to 1/64 of a pixel.
std::array<Eigen::Vector2f, kSamples> hammersley() {
  std::array<Eigen::Vector2f, kSamples> points;
  for (int i = 0; i < kSamples; ++i) {
    int reversed = 0;
    for (int bit = 0; bit < 6; ++bit) reversed |= ((i >> bit) & 1) << (5 - bit);
    points[i] = {(static_cast<float>(i) + 0.5F) / kSamples,
                 (static_cast<float>(reversed) + 0.5F) / kSamples};
  }
  return points;
}

void checkTarget(const AprilGrid& target) {
  if (target.tagCount() <= kFamilySize) return;
  throw InputError(fmt::format("a target of {} x {} tags cannot be rendered; tag36h11 has {}",
                               target.rows, target.cols, kFamilySize));
}

}  // namespace

void RenderOptions::check() const {
  requireWithin(0, 255, "render.black_level", black_level);
  requireWithin(0, 255, "render.white_level", white_level);
  requireWithin(0, 255, "render.wall_level", wall_level);
  requireWithin(0, 1, "render.shading", shading);
  requireWithin(0, 1, "render.vignetting", vignetting);
  requireWithin(0, 20, "render.blur_sigma_px", blur_sigma_px);
  requireWithin(0, 100, "render.noise_sigma", noise_sigma);
  requireWithin(0, 100, "render.margin_ratio", margin_ratio);
}

TargetRenderer::TargetRenderer(const Intrinsics& camera, const AprilGrid& target,
                               const RenderOptions& options)
    : width_(camera.resolution.width),
      height_(camera.resolution.height),
      target_(target),
      options_((checkTarget(target), options.check(), options)),
      pattern_(target, options.margin_ratio * target.tag_size),
      surface_(target),
      is_flat_(surface_.isFlat()),
      rays_(cornerRays(camera)),
      gain_(vignettingGain(camera.resolution, options.vignetting)) {}

TargetRenderer::Hit TargetRenderer::cast(const View& view, const Eigen::Vector3f& n) const {
  // (A default Hit lies in the wall, cell (0, 0).)
  if (!(n.z() < 0)) return {};  // away from the plane, or no ray: the wall far out
  const float range = -view.c_F.z() / n.z();
  if (!(range < kFarAway)) return {};
  Eigen::Vector2f p = view.c_F.head<2>() + range * n.head<2>();
  // Boards slope by hundredths: each step leaves a few hundredths of the error of the one before.
  for (int step = 0; step < kBoardSteps && !is_flat_; ++step) {
    const Eigen::Vector3f d = surface_.displacement(p);
    const float to_board = (d.z() - view.c_F.z()) / n.z();
    p = view.c_F.head<2>() + to_board * n.head<2>() - d.head<2>();
  }
  return {p.x(), p.y(), pattern_.cellAt(p.x(), p.y())};
}

std::vector<TargetRenderer::Hit> TargetRenderer::castRow(const View& view, int lattice_row) const {
  std::vector<Hit> row(static_cast<std::size_t>(width_ + 1));
  for (int x = 0; x <= width_; ++x) {
    row[x] = cast(view, view.R_FC * ray(x, lattice_row));
  }
  return row;
}

float TargetRenderer::pixelLight(const View& view, int x, int y, const Hit* above,
                                 const Hit* below) const {
  const auto [col_low, col_high] =
      std::minmax({above[0].cell.col, above[1].cell.col, below[0].cell.col, below[1].cell.col});
  const auto [row_low, row_high] =
      std::minmax({above[0].cell.row, above[1].cell.row, below[0].cell.row, below[1].cell.row});
  // Where all cells between those of the pixel's corners are of one surface, the pixel is. The
  // illumination changes linearly over the target and stays constant beyond.
  // By one of its corners: over a pixel it hardly changes.
  const float across = above[0].x / static_cast<float>(target_.width()) - 0.5F;
  const float upward = above[0].y / static_cast<float>(target_.height()) - 0.5F;
  const float slope = std::clamp(across + 0.5F * upward, -1.0F, 1.0F);
  const float light = 1 + static_cast<float>(options_.shading) * slope;
  const auto uniform = pattern_.uniformSurface({col_low, row_low}, {col_high, row_high});
  if (!uniform) return mixedLight(view, x, y, light);
  // In the order of Surface.
  const double levels[] = {options_.wall_level, options_.white_level, options_.black_level};
  return light * static_cast<float>(levels[static_cast<std::size_t>(*uniform)]);
}

float TargetRenderer::mixedLight(const View& view, int x, int y, float light) const {
  static const auto points = hammersley();
  const Eigen::Vector3f n = view.R_FC * ray(x, y);
  const Eigen::Vector3f right = view.R_FC * ray(x + 1, y) - n;
  const Eigen::Vector3f down = view.R_FC * ray(x, y + 1) - n;
  const Eigen::Vector3f twist = view.R_FC * ray(x + 1, y + 1) - n - right - down;
  std::array<int, 3> count{};
  for (const Eigen::Vector2f& s : points) {
    // Bilinear between the rays of the pixel's four corners.
    const Hit hit = cast(view, n + s.x() * right + s.y() * (down + s.x() * twist));
    ++count[static_cast<std::size_t>(pattern_.surface(hit.cell))];
  }
  // In the order of Surface.
  const double sum = count[0] * options_.wall_level + count[1] * options_.white_level +
                     count[2] * options_.black_level;
  return light * static_cast<float>(sum / kSamples);
}

std::vector<float> TargetRenderer::illuminate(const Transform& T_FC) const {
  std::vector<float> light = gain_;
  if (T_FC.t.z() <= 0) {  // behind the wall
    for (float& pixel : light) pixel *= static_cast<float>(options_.wall_level);
    return light;
  }
  const View view{T_FC.R.cast<float>(), T_FC.t.cast<float>()};
  std::vector<Hit> above = castRow(view, 0);
  auto pixel = light.begin();
  for (int y = 0; y < height_; ++y) {
    // Each lattice row serves two rows of pixels, and is cast once.
    std::vector<Hit> below = castRow(view, y + 1);
    for (int x = 0; x < width_; ++x, ++pixel) {
      *pixel *= pixelLight(view, x, y, &above[x], &below[x]);
    }
    above = std::move(below);
  }
  return light;
}

GrayImage TargetRenderer::render(const Transform& T_FC, std::uint64_t image) const {
  const std::vector<float> sharp = illuminate(T_FC);
  const std::vector<float> light = gaussianBlur(sharp, width_, height_, options_.blur_sigma_px);
  return exposeSensor(light, width_, height_, options_.noise_sigma, options_.seed, image);
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/render.h"

#include <Eigen/QR>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/target/tag_family.h"

namespace plumbline {

// The corners' displacements are a quadratic's values, so that least squares finds it exactly. A
// grid too small to tell some of its terms (one tag) has none of them: the shortest solution.
BoardSurface::BoardSurface(const AprilGrid& board)
    : centre_(static_cast<float>(0.5 * board.width()), static_cast<float>(0.5 * board.height())),
      unit_(centre_.norm()) {
  AprilGrid printed = board;
  // Only what is printed: tag_edge is how a detector errs.
  printed.shape.terms[kTargetTerms - 1] = 0;
  printed.shape.higher.reset();
  printed.shape.corners.reset();  // of a detector, not printed
  const std::vector<Eigen::Vector3d> points = cornerPoints(printed);
  const Eigen::Vector2d centre(0.5 * board.width(), 0.5 * board.height());
  Eigen::MatrixXd monomials(board.cornerCount(), 6), displacements(board.cornerCount(), 3);
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d p = board.corner(id), at = (p - centre) / centre.norm();
    monomials.row(id) << 1, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y();
    displacements.row(id) = points[id].transpose();
    displacements.row(id).head<2>() -= p.transpose();
  }
  const auto fitted = [&](const Eigen::MatrixXd& terms) {
    const Eigen::MatrixXd found = terms.completeOrthogonalDecomposition().solve(displacements);
    return Eigen::MatrixXf(found.transpose().cast<float>());
  };
  polynomial_ = fitted(monomials);
  if (!board.shape.higher) return;
  // Of degree 4 and less, so that this fit is exact as well.
  const HigherBasis basis(board);
  Eigen::MatrixXd quartics(board.cornerCount(), 15);
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d at = (board.corner(id) - centre) / centre.norm();
    quartics.row(id) = quartic(at.cast<float>()).cast<double>().transpose();
    displacements.row(id) = basis.displacement(id, *board.shape.higher).transpose();
  }
  higher_ = fitted(quartics);
}

GridPattern::GridPattern(const AprilGrid& grid, double margin_m)
    : tag_size_(grid.tag_size),
      pitch_(grid.pitch()),
      gap_(grid.spacing * grid.tag_size),
      margin_(margin_m),
      tags_per_m_(1 / grid.pitch()),
      cells_per_m_(kCells / grid.tag_size),
      cols_(grid.cols),
      rows_(grid.rows) {
  static_assert(kCells == tagCells(kKalibrBorderBits));
  const int row_count = 5 + kSteps * rows_;
  surfaces_.assign(static_cast<std::size_t>(colCount()) * static_cast<std::size_t>(row_count),
                   Surface::kWall);
  auto surface = surfaces_.begin();
  for (int row = 0; row < row_count; ++row) {
    for (int col = 0; col < colCount(); ++col, ++surface) {
      if (row == 0 || col == 0 || row == row_count - 1 || col == colCount() - 1) continue;
      // One place tells: a cell is of one surface by construction.
      const Eigen::Vector2d p(middleOf(col, cols_), middleOf(row, rows_));
      *surface = gridIsBlack(grid, p) ? Surface::kBlack : Surface::kWhite;
    }
  }
}

double GridPattern::middleOf(int index, int tags) const {
  // Index 1, the paper; the wall is passed over by the constructor.
  if (index <= 1) return -gap_ - 0.5 * margin_;
  if (index >= 3 + kSteps * tags) return pitch_ * tags + 0.5 * margin_;
  const int step = index - 3 + kSteps;  // counted from the cells of a tag -1
  const int tag = step / kSteps - 1;
  const int cell = step % kSteps;
  const double within = cell == kCells ? tag_size_ + 0.5 * gap_ : (cell + 0.5) / cells_per_m_;
  return tag * pitch_ + within;
}

std::optional<Surface> GridPattern::uniformSurface(Cell low, Cell high) const {
  const Surface first = surface(low);
  // Not worth 16 look-ups and more: a pixel that large is sampled anyway.
  if (high.col - low.col > 3 || high.row - low.row > 3) return std::nullopt;
  for (int row = low.row; row <= high.row; ++row) {
    for (int col = low.col; col <= high.col; ++col) {
      if (surface({col, row}) != first) return std::nullopt;
    }
  }
  return first;
}

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

std::size_t area(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

std::vector<Eigen::Vector3f> cornerRays(const Intrinsics& camera) {
  std::vector<Eigen::Vector3f> rays;
  const Resolution& size = camera.resolution;
  rays.reserve(area(size.width + 1, size.height + 1));
  for (int y = 0; y <= size.height; ++y) {
    for (int x = 0; x <= size.width; ++x) {
      // Pixels are squares about their integer coordinates, so that their corners lie half a pixel
      // off.
      const auto ray = unproject(camera, Eigen::Vector2d(x - 0.5, y - 0.5));
      rays.push_back(ray ? Eigen::Vector3f(ray->cast<float>()) : Eigen::Vector3f::Zero());
    }
  }
  return rays;
}

std::vector<float> vignettingGain(const Resolution& size, double vignetting) {
  std::vector<float> gain;
  gain.reserve(area(size.width, size.height));
  const Eigen::Vector2d centre(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double r2 = (Eigen::Vector2d(x, y) - centre).squaredNorm() / centre.squaredNorm();
      gain.push_back(static_cast<float>(1 - vignetting * r2));
    }
  }
  return gain;
}

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

namespace {

std::vector<float> gaussianKernel(double sigma_px) {
  // Beyond four deviations lie 6e-5 of the weight.
  const int radius = static_cast<int>(std::ceil(4 * sigma_px));
  std::vector<float> kernel;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double value = std::exp(-0.5 * i * i / (sigma_px * sigma_px));
    kernel.push_back(static_cast<float>(value));
    sum += value;
  }
  for (float& k : kernel) k = static_cast<float>(k / sum);
  return kernel;
}

/// out[i] = sum_j kernel[j] * padded[i + j], for i < count.
void convolveRow(const float* padded, const std::vector<float>& kernel, int count, float* out) {
  std::fill(out, out + count, 0.0F);
  for (std::size_t j = 0; j < kernel.size(); ++j) {
    const float k = kernel[j];
    const float* in = padded + j;
    for (int i = 0; i < count; ++i) out[i] += k * in[i];
  }
}

constexpr int kDrawBits = 12;  // that choose one of the table's draws
using NormalTable = std::array<float, 1 << kDrawBits>;

/// 4096 draws from a standard normal, shifted and scaled to mean 0 and variance 1: with it a
/// pixel's noise costs a look-up.
NormalTable normalTable() {
  RandomStream random(0, RandomPurpose::kImageNoise);
  double sum = 0, sum2 = 0;
  std::array<double, 1 << kDrawBits> draws{};
  for (double& x : draws) {
    x = random.normal();
    sum += x;
    sum2 += x * x;
  }
  const double mean = sum / draws.size();
  // Exact moments: a bias of the table would be one of every image.
  const double scale = 1 / std::sqrt(sum2 / draws.size() - mean * mean);
  NormalTable table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>((draws[i] - mean) * scale);
  }
  return table;
}

}  // namespace

std::vector<float> gaussianBlur(const std::vector<float>& light, int width, int height,
                                double sigma_px) {
  if (sigma_px <= 0) return light;
  const std::vector<float> kernel = gaussianKernel(sigma_px);
  const int radius = static_cast<int>(kernel.size() / 2);
  const auto w = static_cast<std::size_t>(width);
  std::vector<float> across(light.size());
  std::vector<float> padded(w + kernel.size());
  for (int y = 0; y < height; ++y) {
    const float* row = light.data() + static_cast<std::size_t>(y) * w;
    // Zeros beyond the border would darken it.
    std::fill(padded.begin(), padded.begin() + radius, row[0]);
    std::copy(row, row + width, padded.begin() + radius);
    std::fill(padded.begin() + radius + width, padded.end(), row[width - 1]);
    convolveRow(padded.data(), kernel, width, across.data() + static_cast<std::size_t>(y) * w);
  }
  std::vector<float> out(light.size(), 0.0F);
  // Down the columns, but row by row, so that the inner loop runs along memory.
  for (int y = 0; y < height; ++y) {
    float* row = out.data() + static_cast<std::size_t>(y) * w;
    for (std::size_t j = 0; j < kernel.size(); ++j) {
      const int source = std::clamp(y + static_cast<int>(j) - radius, 0, height - 1);
      const float* in = across.data() + static_cast<std::size_t>(source) * w;
      for (int x = 0; x < width; ++x) row[x] += kernel[j] * in[x];
    }
  }
  return out;
}

GrayImage exposeSensor(const std::vector<float>& light, int width, int height, double noise_sigma,
                       std::uint64_t seed, std::uint64_t image) {
  static const NormalTable table = normalTable();
  constexpr int kDrawsPerOutput = 64 / kDrawBits;  // five of 12 bits
  RandomStream random(seed, RandomPurpose::kImageNoise, {image});
  const auto sigma = static_cast<float>(noise_sigma);
  GrayImage out(width, height);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    if (i % kDrawsPerOutput == 0) bits = random.bits();
    const float value = light[i] + sigma * table[bits % table.size()];
    bits >>= kDrawBits;
    // Rounds: what is cast is not negative.
    out.data()[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
  }
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/patch_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

constexpr int kSmallest = 16;  // [px]: below it a patch no longer fits

/// Pixel (x, y) is centred on (2x, 2y): between levels coordinates are halved without an offset,
/// which averages of 2 x 2 pixels would bring in.
GrayImage halved(const GrayImageView& from) {
  const int width = (from.width + 1) / 2, height = (from.height + 1) / 2;
  GrayImage to(width, height);
  // One smoothed row of the full width, padded by two on either side.
  std::vector<int> row(static_cast<std::size_t>(from.width) + 4);
  for (int y = 0; y < height; ++y) {
    const auto at = [&](int dy) { return from.row(std::clamp(2 * y + dy, 0, from.height - 1)); };
    const std::uint8_t *a = at(-2), *b = at(-1), *c = at(0), *d = at(1), *e = at(2);
    int* const mid = row.data() + 2;
    for (int x = 0; x < from.width; ++x) mid[x] = a[x] + e[x] + 4 * (b[x] + d[x]) + 6 * c[x];
    mid[-1] = mid[-2] = mid[0];
    mid[from.width] = mid[from.width + 1] = mid[from.width - 1];
    std::uint8_t* out = to.row(y);
    for (int x = 0; x < width; ++x) {
      const int* m = mid + 2 * x;
      // The weights of both axes add up to 16 * 16; + 128 rounds.
      out[x] = static_cast<std::uint8_t>((m[-2] + m[2] + 4 * (m[-1] + m[1]) + 6 * m[0] + 128) >> 8);
    }
  }
  return to;
}

}  // namespace

ImagePyramid::ImagePyramid(const GrayImageView& image, int levels) {
  GrayImage base(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(base.row(y), image.row(y), static_cast<std::size_t>(image.width));
  }
  levels_.push_back(std::move(base));
  while (static_cast<int>(levels_.size()) < levels &&
         std::min(levels_.back().width(), levels_.back().height()) >= 2 * kSmallest) {
    levels_.push_back(halved(levels_.back().view()));
  }
}

namespace {

constexpr int kRadius = 7;
constexpr int kSide = 2 * kRadius + 1;
constexpr int kPixels = kSide * kSide;
constexpr float kContrast = 2;    // of two images of the same, at most
constexpr int kWide = kSide + 2;  // with a border, for the gradients

/// Samples a square of `side` pixels whose first one is at (x, y), bilinearly; false where it does
/// not lie within the image.
template <int side>
bool sample(const GrayImageView& image, float x, float y, float* out) {
  const float fx = std::floor(x), fy = std::floor(y);
  // Written so that NaN is refused.
  if (!(fx >= 0 && fy >= 0 && fx + side < static_cast<float>(image.width) &&
        fy + side < static_cast<float>(image.height))) {
    return false;
  }
  const float ax = x - fx, ay = y - fy;
  const float w00 = (1 - ax) * (1 - ay), w01 = ax * (1 - ay), w10 = (1 - ax) * ay, w11 = ax * ay;
  const int x0 = static_cast<int>(fx), y0 = static_cast<int>(fy);
  for (int row = 0; row < side; ++row) {
    const std::uint8_t* a = image.row(y0 + row) + x0;
    const std::uint8_t* b = image.row(y0 + row + 1) + x0;
    float* o = out + row * side;
    for (int column = 0; column < side; ++column) {
      o[column] = w00 * static_cast<float>(a[column]) + w01 * static_cast<float>(a[column + 1]) +
                  w10 * static_cast<float>(b[column]) + w11 * static_cast<float>(b[column + 1]);
    }
  }
  return true;
}

/// What is to be found: grey levels and their gradient, all without their mean.
struct Template {
  std::array<float, kPixels> level, dx, dy;
  float norm = 0;  // of level
  Eigen::Matrix2f inverse;
};

using Patch = std::array<float, kPixels>;

/// Sum in eight strands, so that it is vectorised without reordering.
template <class Term>
float sumOf(const Term& term) {
  std::array<float, 8> strands{};
  int i = 0;
  for (; i + 8 <= kPixels; i += 8) {
    for (int k = 0; k < 8; ++k) strands[k] += term(i + k);
  }
  float sum = 0;
  for (; i < kPixels; ++i) sum += term(i);
  for (const float s : strands) sum += s;
  return sum;
}

void removeMean(Patch& values) {
  const float mean = sumOf([&](int i) { return values[i]; }) / kPixels;
  for (float& v : values) v -= mean;
}

std::optional<Template> templateAt(const GrayImageView& image, const Eigen::Vector2f& at,
                                   float min_eigenvalue) {
  std::array<float, kWide * kWide> wide;
  const float reach = kRadius + 1;
  if (!sample<kWide>(image, at.x() - reach, at.y() - reach, wide.data())) return std::nullopt;
  Template t;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const int w = (y + 1) * kWide + x + 1, i = y * kSide + x;
      t.level[i] = wide[w];
      t.dx[i] = 0.5F * (wide[w + 1] - wide[w - 1]);
      t.dy[i] = 0.5F * (wide[w + kWide] - wide[w - kWide]);
    }
  }
  removeMean(t.level);
  // A free offset of the grey levels takes the mean out of everything that is compared with them.
  removeMean(t.dx);
  removeMean(t.dy);
  t.norm = std::sqrt(sumOf([&](int i) { return t.level[i] * t.level[i]; }));
  const float xx = sumOf([&](int i) { return t.dx[i] * t.dx[i]; });
  const float xy = sumOf([&](int i) { return t.dx[i] * t.dy[i]; });
  const float yy = sumOf([&](int i) { return t.dy[i] * t.dy[i]; });
  const float half = 0.5F * (xx + yy);
  const float least = half - std::hypot(0.5F * (xx - yy), xy);
  if (!(least > min_eigenvalue * kPixels)) return std::nullopt;
  Eigen::Matrix2f H;
  H << xx, xy, xy, yy;
  t.inverse = H.inverse();
  return t;
}

/// The difference to the template against its gradient, with the image's mean and contrast made
/// those of the template.
struct Comparison {
  Eigen::Vector2f gradient;
  float correlation = 0;
};

Comparison compare(const Template& t, Patch& seen) {
  removeMean(seen);
  // A plain patch has no contrast: the small number keeps the gain finite, and the correlation at
  // 0.
  const float norm = std::sqrt(sumOf([&](int i) { return seen[i] * seen[i]; })) + 1e-6F;
  const float inner = sumOf([&](int i) { return seen[i] * t.level[i]; });
  // Contrast is limited, so that plain noise is not blown up to the template.
  const float gain = std::clamp(t.norm / norm, 1 / kContrast, kContrast);
  for (int i = 0; i < kPixels; ++i) seen[i] = gain * seen[i] - t.level[i];
  return {{sumOf([&](int i) { return seen[i] * t.dx[i]; }),
           sumOf([&](int i) { return seen[i] * t.dy[i]; })},
          inner / (norm * (t.norm + 1e-6F))};
}

struct LevelResult {
  Eigen::Vector2f place;
  float correlation = 0;
};

/// Inverse compositional steps (Baker and Matthews): with H the template's, the template would have
/// to move by H^-1 sum grad (seen - template), so the place moves by as much the other way. The
/// correlation is that before the last step, of less than step_px unless the iterations have run
/// out.
std::optional<LevelResult> refine(const Template& t, const GrayImageView& image,
                                  Eigen::Vector2f place, const PatchTrackerOptions& options) {
  Patch seen;
  float correlation = 0;
  for (int i = 0; i < options.iterations; ++i) {
    if (!sample<kSide>(image, place.x() - kRadius, place.y() - kRadius, seen.data())) {
      return std::nullopt;
    }
    const Comparison c = compare(t, seen);
    correlation = c.correlation;
    const Eigen::Vector2f step = -(t.inverse * c.gradient);
    place += step;
    if (step.squaredNorm() < options.step_px * options.step_px) break;
  }
  return LevelResult{place, correlation};
}

}  // namespace

void PatchTrackerOptions::check() const {
  requireOption(iterations >= 1, "iterations", iterations, "1 or more");
  requirePositive("step_px", step_px);
  requirePositive("min_eigenvalue", min_eigenvalue);
  requireWithin(0, 1, "min_correlation", min_correlation);
  requirePositive("round_trip_px", round_trip_px);
  requireOption(round_trip_levels >= 1, "round_trip_levels", round_trip_levels, "1 or more");
}

std::optional<Eigen::Vector2f> trackPatch(const ImagePyramid& from, const ImagePyramid& to,
                                          const Eigen::Vector2f& at, const Eigen::Vector2f& guess,
                                          int levels, const PatchTrackerOptions& options) {
  Eigen::Vector2f place = guess;
  float correlation = 0;
  for (int k = std::min({levels, from.levels(), to.levels()}) - 1; k >= 0; --k) {
    const float scale = 1.0F / static_cast<float>(1 << k);
    // Coarse levels only bring it near: a patch that leaves them, or is smooth there, skips them.
    const auto t = templateAt(from.level(k), at * scale, k > 0 ? 0.1F : options.min_eigenvalue);
    const auto found = t ? refine(*t, to.level(k), place * scale, options) : std::nullopt;
    if (found) place = found->place / scale;
    if (found) correlation = found->correlation;
    if (k == 0 && !found) return std::nullopt;
  }
  if (!(correlation > options.min_correlation) || !place.allFinite()) return std::nullopt;
  return place;
}

float patchCorrelation(const ImagePyramid& from, const ImagePyramid& to, const Eigen::Vector2f& at,
                       const Eigen::Vector2f& place, int level) {
  if (level >= std::min(from.levels(), to.levels())) return -1;
  const Eigen::Vector2f corner = Eigen::Vector2f::Constant(kRadius);
  const float scale = 1.0F / static_cast<float>(1 << level);
  const Eigen::Vector2f a = at * scale - corner, b = place * scale - corner;
  Patch first, second;
  if (!sample<kSide>(from.level(level), a.x(), a.y(), first.data()) ||
      !sample<kSide>(to.level(level), b.x(), b.y(), second.data())) {
    return -1;
  }
  removeMean(first);
  removeMean(second);
  const float aa = sumOf([&](int i) { return first[i] * first[i]; });
  const float bb = sumOf([&](int i) { return second[i] * second[i]; });
  const float ab = sumOf([&](int i) { return first[i] * second[i]; });
  return ab / (std::sqrt(aa * bb) + 1e-6F);
}

std::optional<Eigen::Vector2f> trackThereAndBack(const ImagePyramid& from, const ImagePyramid& to,
                                                 const Eigen::Vector2f& at,
                                                 const Eigen::Vector2f& guess, int levels,
                                                 const PatchTrackerOptions& options) {
  const auto there = trackPatch(from, to, at, guess, levels, options);
  if (!there) return std::nullopt;
  // From where it should end, on the fine levels alone: the way back only confirms.
  const auto back = trackPatch(to, from, *there, at, options.round_trip_levels, options);
  if (!back || !((*back - at).norm() < options.round_trip_px)) return std::nullopt;
  return there;
}

}  // namespace plumbline

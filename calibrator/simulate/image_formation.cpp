// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/image_formation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
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

std::vector<Eigen::Vector3f> cornerRays(const Intrinsics& camera) {
  std::vector<Eigen::Vector3f> rays;
  const Resolution& size = camera.resolution;
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
  const Eigen::Vector2d centre(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double r2 = (Eigen::Vector2d(x, y) - centre).squaredNorm() / centre.squaredNorm();
      gain.push_back(static_cast<float>(1 - vignetting * r2));
    }
  }
  return gain;
}

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

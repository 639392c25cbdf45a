// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/render_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

std::vector<float> gaussianKernel(double sigma_px) {
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

/// 4096 draws from a standard normal, shifted and scaled to mean 0 and variance 1: with it a
/// pixel's noise costs a look-up.
class NormalTable {
 public:
  NormalTable() {
    RandomStream random(0, RandomPurpose::kImageNoise);
    double sum = 0;
    double sum2 = 0;
    std::array<double, kSize> draws{};
    for (double& x : draws) {
      x = random.normal();
      sum += x;
      sum2 += x * x;
    }
    const double mean = sum / kSize;
    const double scale = 1 / std::sqrt(sum2 / kSize - mean * mean);
    for (std::size_t i = 0; i < kSize; ++i) {
      values_[i] = static_cast<float>((draws[i] - mean) * scale);
    }
  }
  float at(std::uint64_t bits) const { return values_[bits % kSize]; }

  static constexpr int kBits = 12;

 private:
  static constexpr std::size_t kSize = std::size_t{1} << kBits;
  std::array<float, kSize> values_{};
};

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
    std::fill(padded.begin(), padded.begin() + radius, row[0]);
    std::copy(row, row + width, padded.begin() + radius);
    std::fill(padded.begin() + radius + width, padded.end(), row[width - 1]);
    convolveRow(padded.data(), kernel, width, across.data() + static_cast<std::size_t>(y) * w);
  }
  std::vector<float> out(light.size(), 0.0F);
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
  static const NormalTable table;
  constexpr int kDrawsPerOutput = 64 / NormalTable::kBits;
  RandomStream random(seed, RandomPurpose::kImageNoise, {image});
  const auto sigma = static_cast<float>(noise_sigma);
  GrayImage out(width, height);
  std::uint64_t bits = 0;
  int left = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    if (left == 0) {
      bits = random.bits();
      left = kDrawsPerOutput;
    }
    const float value = light[i] + sigma * table.at(bits);
    bits >>= NormalTable::kBits;
    --left;
    out.data()[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
  }
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/random_stream.h"

#include <cmath>
#include <numbers>

namespace plumbline {
namespace {

/// One step of SplitMix64 (Steele, Lea, Flood 2014): a bijection that scatters neighbouring words.
std::uint64_t scatter(std::uint64_t word) {
  word += 0x9e3779b97f4a7c15ULL;
  word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9ULL;
  word = (word ^ (word >> 27)) * 0x94d049bb133111ebULL;
  return word ^ (word >> 31);
}

/// A chain, so that the order of the indices counts; neighbouring ones have unrelated streams.
std::uint64_t streamKey(std::uint64_t seed, RandomPurpose purpose,
                        std::initializer_list<std::uint64_t> indices) {
  std::uint64_t key = scatter(scatter(seed) ^ static_cast<std::uint64_t>(purpose));
  for (const std::uint64_t index : indices) key = scatter(key ^ scatter(index));
  return key;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, RandomPurpose purpose,
                           std::initializer_list<std::uint64_t> indices)
    : engine_(streamKey(seed, purpose, indices)) {}

double RandomStream::uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

double RandomStream::normal() {
  const double radius = std::sqrt(-2 * std::log(1 - uniform()));  // 1 - u is in (0, 1]
  return radius * std::cos(2 * std::numbers::pi * uniform());
}

Eigen::Vector3d RandomStream::normalVector() {
  // In statements of their own: the order in which arguments are evaluated is not fixed.
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

}  // namespace plumbline

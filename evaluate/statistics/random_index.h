// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

namespace plumbline {

/// Uniform indices whose sequence is the same with every standard library: mt19937_64 is fixed by
/// the standard, <random>'s distributions are not.
class RandomIndex {
 public:
  explicit RandomIndex(std::uint64_t seed) : engine_(seed) {}

  /// In [0, below), below < 2^32. The upper 32 bits scaled (Lemire): its bias, below / 2^32, is
  /// under any that a few hundred participants could show.
  std::size_t operator()(std::size_t below) {
    return static_cast<std::size_t>((engine_() >> 32U) * static_cast<std::uint64_t>(below) >> 32U);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "calibrator/base/transform.h"

namespace plumbline {

/// Writes `t[s] x y z qx qy qz qw` rows: stamps with nine decimals, exact from the int64, and
/// values with 17 significant digits, so that reading the file gives the same bits.
inline void writeTum(const std::filesystem::path& path, const Trajectory& trajectory) {
  std::ofstream out(path, std::ios::binary);
  out << "# timestamp [s] tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory.poses) {
    constexpr std::uint64_t kPerSecond = 1'000'000'000;
    const auto magnitude =
        pose.t < 0 ? 0 - static_cast<std::uint64_t>(pose.t) : static_cast<std::uint64_t>(pose.t);
    out << fmt::format("{}{}.{:09} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n",
                       pose.t < 0 ? "-" : "", magnitude / kPerSecond, magnitude % kPerSecond,
                       pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(),
                       pose.q.w());
  }
}

}  // namespace plumbline

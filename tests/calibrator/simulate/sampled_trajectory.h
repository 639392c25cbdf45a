// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {

/// How a simulated motion is sampled as a trajectory T_WB = T_WF T_FS T_SB.
struct SamplingOptions {
  double from_s = 0, to_s = 60;  ///< of the motion
  double rate_hz = 20;
  double clock_s = 0;  ///< stamp = 1.4e9 s + instant + clock_s
  Transform T_WF, T_SB;
  double sigma_m = 0, sigma_rad = 0;  ///< white noise of each pose, left tangent (dt, da)
  std::uint64_t seed = 1;
};

inline Trajectory sampled(const AnalyticTrajectory& motion, const SamplingOptions& o) {
  Trajectory trajectory;
  RandomStream random(o.seed, RandomPurpose::kTrajectory, {std::uint64_t(o.rate_hz * 1000)});
  const auto count = static_cast<int>(std::floor((o.to_s - o.from_s) * o.rate_hz));
  for (int i = 0; i <= count; ++i) {
    const double t_s = o.from_s + i / o.rate_hz;
    Vector6d noise;
    for (int k = 0; k < 6; ++k) noise[k] = (k < 3 ? o.sigma_m : o.sigma_rad) * random.normal();
    const Transform T = boxplus(o.T_WF * motion.at(t_s).T_FB * o.T_SB, noise);
    trajectory.poses.push_back(
        {1'400'000'000'000'000'000 + toNanoseconds(t_s + o.clock_s), T.t, T.quaternion()});
  }
  return trajectory;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "tests/evaluate/replay/simulated_pools.h"

#include "calibrator/base/frames.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline::test {
namespace {

constexpr TimeNs kPause = 1'000'000'000'000;  // from the recording to the held-out frames

std::string rigName(int index) {
  const std::vector<std::string> names = simulatedRigNames();
  return names[static_cast<std::size_t>(index) % names.size()];
}

/// The fisheye's image reaches to 90 degrees off its axis, where pinhole-equidistant ends and a
/// corner's noise may push it out of the model's domain; so much of its border is left out.
constexpr double kFisheyeBorder_px = 60;  // leaves 83 degrees

SimulationOptions recordingOptions(int index, const SimulatedPoolOptions& options) {
  const auto number = static_cast<std::uint64_t>(index);
  SimulationOptions o;
  o.seed = 1 + number;
  o.trajectory.seed = 100 + number;
  o.duration_s = options.duration_s;
  o.camera_rate_hz = options.frames / options.duration_s;
  o.imu_rate_hz = 10;  // not used
  if (rigName(index) == "tumvi") o.border_px = kFisheyeBorder_px;
  o.corner_sigma_px = options.sigma_px;
  return o;
}

SimulationOptions heldOutOptions(int index, const SimulatedPoolOptions& options) {
  SimulationOptions o = recordingOptions(index, options);
  o.seed += 1000;
  o.trajectory.seed += 5000;
  o.start_ns += kPause;
  o.duration_s = 60;
  o.camera_rate_hz = options.held_out_frames / o.duration_s;
  o.corner_sigma_px = options.held_out_sigma;
  return o;
}

}  // namespace

SimulatedPool simulatedPool(int index, const SimulatedPoolOptions& options) {
  SimulatedPool pool;
  pool.rig = rigName(index);
  const SimulatedRig rig = simulatedRig(pool.rig);
  SimulationOptions recording = recordingOptions(index, options);
  pool.distance_ratio =
      RandomStream(1000 + static_cast<std::uint64_t>(index), RandomPurpose::kTrajectory)
          .uniform(0.8, 1.6);
  recording.trajectory.distance_ratio = pool.distance_ratio;
  pool.session = simulateSession(rig, recording).session;
  pool.session.imu.reset();
  const SimulationOptions held_out = heldOutOptions(index, options);
  const Session unseen = simulateSession(rig, held_out).session;
  for (std::size_t c = 0; c < unseen.cameras.size(); ++c) {
    std::vector<ImageView>& views = pool.session.cameras[c].views;
    views.insert(views.end(), unseen.cameras[c].views.begin(), unseen.cameras[c].views.end());
  }
  const std::vector<Frame> frames = pairFrames(pool.session.cameras);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const bool is_pool = frames[f].t < held_out.start_ns;
    (is_pool ? pool.split.pool : pool.split.held_out).push_back(static_cast<int>(f));
  }
  return pool;
}

ViewsTo viewsTo(const CounterfactualCurve& curve, double target_px) {
  ViewsTo to;
  for (std::size_t i = 0; i < curve.views.size(); ++i) {
    const bool reached = curve.held_out_px[i] && *curve.held_out_px[i] <= target_px;
    if (reached && !to.first) to.first = curve.views[i];
    if (reached && !to.for_good) to.for_good = curve.views[i];
    if (!reached) to.for_good.reset();
  }
  return to;
}

}  // namespace plumbline::test

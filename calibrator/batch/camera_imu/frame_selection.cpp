// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/frame_selection.h"

#include <algorithm>

#include "calibrator/initialise/angular_rates.h"

namespace plumbline {
namespace {

/// By the biases' walk where a gap overlaps [from - margin, to + margin] of the camera's clock.
FrameLink linkBetween(TimeNs from, TimeNs to, std::span<const ImuGap> gaps,
                      const FrameSelectionOptions& options) {
  const TimeNs offset = toNanoseconds(options.time_offset_s);
  const TimeNs margin = toNanoseconds(options.margin_s);
  const bool paused = std::ranges::any_of(gaps, [&](const ImuGap& gap) {
    // The gaps are on the IMU's clock, t_imu = t_cam + t_d.
    return gap.from < to + offset + margin && gap.to > from + offset - margin;
  });
  const bool joined = secondsBetween(from, to) <= options.max_interval_s && !paused;
  return joined ? FrameLink::kInertial : FrameLink::kBiasWalk;
}

}  // namespace

std::vector<ImuSample> shiftedSamples(const std::vector<ImuSample>& samples, TimeNs shift) {
  std::vector<ImuSample> out = samples;
  for (ImuSample& s : out) s.t += shift;
  return out;
}

std::vector<ImuGap> imuGaps(std::span<const ImuSample> samples, double max_intervals) {
  // Of the median: pauses, however many, hardly move it.
  const double longest = max_intervals * medianSampleInterval(samples);
  std::vector<ImuGap> gaps;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const ImuGap gap{samples[k].t, samples[k + 1].t};
    if (secondsBetween(gap.from, gap.to) > longest) gaps.push_back(gap);
  }
  return gaps;
}

FrameSelection selectFrames(std::span<const TimeNs> stamps, std::span<const ImuSample> samples,
                            std::span<const ImuGap> gaps, const FrameSelectionOptions& options) {
  FrameSelection out;
  if (samples.empty()) return out;
  std::vector<int> covered;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double after_first = secondsBetween(samples.front().t, stamps[i]) + options.time_offset_s;
    const double before_last = secondsBetween(stamps[i], samples.back().t) - options.time_offset_s;
    // The margin is for what the offset still moves in the solution.
    if (after_first < options.margin_s || before_last < options.margin_s) continue;
    covered.push_back(static_cast<int>(i));
  }
  out.covered = static_cast<int>(covered.size());
  const auto stamp = [&](int index) { return stamps[index]; };
  const auto isJoined = [&](std::size_t a, std::size_t b) {
    return linkBetween(stamp(covered[a]), stamp(covered[b]), gaps, options) == FrameLink::kInertial;
  };
  for (std::size_t k = 0; k < covered.size(); ++k) {
    const bool left = k > 0 && isJoined(k - 1, k);
    const bool right = k + 1 < covered.size() && isJoined(k, k + 1);
    // Without an inertial link nothing would determine a frame's velocity.
    if (left || right) out.chosen.push_back(covered[k]);
  }
  for (std::size_t k = 0; k + 1 < out.chosen.size(); ++k) {
    const TimeNs from = stamp(out.chosen[k]);
    const TimeNs to = stamp(out.chosen[k + 1]);
    out.links.push_back(linkBetween(from, to, gaps, options));
  }
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/frames.h"

#include <algorithm>

#include "calibrator/base/statistics.h"

namespace plumbline {
namespace {

/// Whether a gap overlaps [from - margin, to + margin] of the camera's clock.
bool gapBetween(TimeNs from, TimeNs to, std::span<const ImuGap> gaps,
                const FrameSelectionOptions& options) {
  const TimeNs offset = toNanoseconds(options.time_offset_s);
  const TimeNs margin = toNanoseconds(options.margin_s);
  return std::any_of(gaps.begin(), gaps.end(), [&](const ImuGap& gap) {
    return gap.from < to + offset + margin && gap.to > from + offset - margin;
  });
}

FrameLink linkBetween(TimeNs from, TimeNs to, std::span<const ImuGap> gaps,
                      const FrameSelectionOptions& options) {
  const bool joined =
      secondsBetween(from, to) <= options.max_interval_s && !gapBetween(from, to, gaps, options);
  return joined ? FrameLink::kInertial : FrameLink::kBiasWalk;
}

}  // namespace

std::vector<ImuSample> shiftedSamples(const std::vector<ImuSample>& samples, TimeNs shift) {
  std::vector<ImuSample> out = samples;
  for (ImuSample& s : out) s.t += shift;
  return out;
}

std::vector<ImuGap> imuGaps(std::span<const ImuSample> samples, double max_intervals) {
  if (samples.size() < 2) return {};
  std::vector<double> intervals;
  intervals.reserve(samples.size());
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    intervals.push_back(secondsBetween(samples[k].t, samples[k + 1].t));
  }
  const double longest = max_intervals * quantile(intervals, 0.5);
  std::vector<ImuGap> gaps;
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    if (intervals[k] > longest) gaps.push_back({samples[k].t, samples[k + 1].t});
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
    if (after_first < options.margin_s || before_last < options.margin_s) continue;
    covered.push_back(static_cast<int>(i));
  }
  const auto stamp = [&](int index) { return stamps[static_cast<std::size_t>(index)]; };
  const auto isJoined = [&](std::size_t a, std::size_t b) {
    return linkBetween(stamp(covered[a]), stamp(covered[b]), gaps, options) == FrameLink::kInertial;
  };
  for (std::size_t k = 0; k < covered.size(); ++k) {
    const bool left = k > 0 && isJoined(k - 1, k);
    const bool right = k + 1 < covered.size() && isJoined(k, k + 1);
    if (left || right) out.chosen.push_back(covered[k]);
  }
  for (std::size_t k = 0; k + 1 < out.chosen.size(); ++k) {
    const TimeNs from = stamp(out.chosen[k]);
    const TimeNs to = stamp(out.chosen[k + 1]);
    out.links.push_back(linkBetween(from, to, gaps, options));
    if (gapBetween(from, to, gaps, options)) ++out.gaps_used;
  }
  return out;
}

}  // namespace plumbline

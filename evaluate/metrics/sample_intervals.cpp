// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/sample_intervals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

constexpr double kGap = 1.5;         // times the median: half-way to one missing sample
constexpr std::size_t kRuns = 400;   // that a plot of some 900 pixels tells apart
constexpr std::size_t kBins = 61;    // odd, so that the median lies in mid-bin
constexpr double kTail = 0.002;      // of the intervals may lie beyond either end of it
constexpr double kMargin = 1.02;     // so that the quantiles themselves lie within
constexpr double kEvenShare = 0.01;  // of the median: half the histogram's width at least

/// Differences of neighbouring stamps [s], taken on integers.
std::vector<double> intervalsOf(const std::vector<TimeNs>& stamps) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    intervals.push_back(secondsBetween(stamps[i - 1], stamps[i]));
  }
  return intervals;
}

/// The longest gaps, in the order of time.
void keepLongest(std::vector<SampleGap>& gaps) {
  if (gaps.size() <= SampleIntervals::kMostGaps) return;
  std::stable_sort(gaps.begin(), gaps.end(), [](const SampleGap& a, const SampleGap& b) {
    return a.duration_s > b.duration_s;
  });
  gaps.resize(SampleIntervals::kMostGaps);
  std::sort(gaps.begin(), gaps.end(),
            [](const SampleGap& a, const SampleGap& b) { return a.t < b.t; });
}

/// Around the median, as wide as all but the tails need: a single gap would else squeeze the rest
/// into one bin.
IntervalHistogram histogramOf(const std::vector<double>& intervals, double middle) {
  const double reach = std::max({kEvenShare * middle, quantile(intervals, 1 - kTail) - middle,
                                 middle - quantile(intervals, kTail)});
  IntervalHistogram histogram;
  if (!(reach > 0)) return histogram;
  histogram.bin_s = 2 * kMargin * reach / kBins;
  histogram.first_s = middle - kMargin * reach;
  histogram.counts.assign(kBins, 0);
  for (const double interval : intervals) {
    // As a double: a gap of hours over bins of microseconds would not fit an int.
    const double place = std::floor((interval - histogram.first_s) / histogram.bin_s);
    if (place < 0) {
      ++histogram.below;
    } else if (place >= static_cast<double>(kBins)) {
      ++histogram.above;
    } else {
      ++histogram.counts[static_cast<std::size_t>(place)];
    }
  }
  return histogram;
}

/// The shortest and the longest interval of every run, in the order of time.
void addShown(int sensor, const std::vector<TimeNs>& stamps, std::vector<ShownInterval>& shown) {
  const std::vector<double> all = intervalsOf(stamps);
  const std::size_t run = std::max<std::size_t>(1, (all.size() + kRuns - 1) / kRuns);
  for (std::size_t from = 0; from < all.size(); from += run) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(from);
    const auto last = all.begin() + static_cast<std::ptrdiff_t>(std::min(from + run, all.size()));
    // Both ends, so that no gap and no burst is lost to the thinning.
    const auto [least, most] = std::minmax_element(first, last);
    std::vector<std::ptrdiff_t> places = {least - all.begin(), most - all.begin()};
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    for (const std::ptrdiff_t place : places) {
      const auto i = static_cast<std::size_t>(place);
      shown.push_back({sensor, stamps[i + 1], all[i]});
    }
  }
}

}  // namespace

SampleIntervals sampleIntervals(const std::string& sensor, const std::vector<TimeNs>& stamps) {
  SampleIntervals result;
  result.sensor = sensor;
  result.samples = stamps.size();
  const std::vector<double> intervals = intervalsOf(stamps);
  if (intervals.empty()) return result;
  const auto [least, most] = std::minmax_element(intervals.begin(), intervals.end());
  result.min_s = *least;
  result.max_s = *most;
  result.median_s = median(intervals);
  // Without the longest and shortest hundredth, which are the gaps' and not the sensor's jitter.
  result.spread_s = quantile(intervals, 0.99) - quantile(intervals, 0.01);
  result.histogram = histogramOf(intervals, result.median_s);
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (!(intervals[i] > kGap * result.median_s)) continue;
    // From a first stamp of 0 to the epoch's there would be more than an int holds.
    constexpr double kMost = std::numeric_limits<int>::max();
    const auto missing =
        static_cast<int>(std::clamp(std::round(intervals[i] / result.median_s) - 1, 1.0, kMost));
    result.gaps.push_back({stamps[i], intervals[i], missing});
    result.missing += static_cast<std::size_t>(missing);
  }
  result.gap_count = result.gaps.size();
  keepLongest(result.gaps);
  return result;
}

void addSampleIntervals(const Session& session, CalibrationRecord& record) {
  record.sample_intervals.clear();
  record.shown_intervals.clear();
  const auto add = [&](const std::string& sensor, const std::vector<TimeNs>& stamps) {
    addShown(static_cast<int>(record.sample_intervals.size()), stamps, record.shown_intervals);
    record.sample_intervals.push_back(sampleIntervals(sensor, stamps));
  };
  const auto stampsOf = [](const auto& samples) {
    std::vector<TimeNs> stamps;
    for (const auto& sample : samples) stamps.push_back(sample.t);
    return stamps;
  };
  for (const CameraStream& camera : session.cameras) add(camera.name, stampsOf(camera.views));
  if (session.imu) add("imu", stampsOf(session.imu->samples));
}

}  // namespace plumbline

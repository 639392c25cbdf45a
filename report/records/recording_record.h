// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/base/time.h"
#include "calibrator/fields/fields.h"

namespace plumbline {

/// An interval between two samples in which at least one is missing: above 1.5 times the median.
struct SampleGap {
  TimeNs t = 0;  ///< by the sensor's own stamps
  double duration_s = 0;
  int missing = 0;
};

void fields(auto& v, SampleGap& g) {
  v("t_ns", g.t, "stamp of the sample before it");
  v("duration_s", g.duration_s, "s", "to the next sample");
  v("missing", g.missing, "1", "missing samples, by the median interval");
}

/// How often intervals had which length: equal bins, bin i covers
/// [first_s + i bin_s, first_s + (i + 1) bin_s). What lies beyond either end counts in `below` and
/// `above`.
struct IntervalHistogram {
  double first_s = 0, bin_s = 0;
  std::size_t below = 0, above = 0;
  std::vector<std::size_t> counts;  ///< empty: fewer than two samples
};

void fields(auto& v, IntervalHistogram& h) {
  v("first_s", h.first_s, "s", "where the first bin begins");
  v("bin_s", h.bin_s, "s", "width of a bin");
  v("below", h.below, "1", "intervals shorter than the first bin's");
  v("above", h.above, "1", "intervals longer than the last bin's");
  v.ifSet("counts", h.counts, "intervals in each bin");
}

/// How evenly a sensor's samples follow each other, by its own stamps.
struct SampleIntervals {
  static constexpr std::size_t kMostGaps = 100;  ///< that are listed

  std::string sensor;
  std::size_t samples = 0;
  double median_s = 0, min_s = 0, max_s = 0, spread_s = 0;
  std::size_t missing = 0, gap_count = 0;
  std::vector<SampleGap> gaps;
  IntervalHistogram histogram;
};

inline std::string partName(const SampleIntervals& s) { return s.sensor; }

void fields(auto& v, SampleIntervals& s) {
  v("sensor", s.sensor, "a camera's name, or `imu`");
  v("samples", s.samples, "1", "of the part of the recording that was used");
  v("median_s", s.median_s, "s", "interval between samples");
  v("min_s", s.min_s, "s", "the shortest");
  v("max_s", s.max_s, "s", "the longest");
  v("spread_s", s.spread_s, "s", "between the quantiles at 1 and 99 %");
  v("missing", s.missing, "1", "number of samples missing in the gaps");
  v("gap_count", s.gap_count, "1", "intervals above 1.5 times the median");
  v.ifSet("gaps", s.gaps, "the longest of them (100 at most), in the order of time");
  v("histogram", s.histogram, "how often they had which length");
}

/// An interval as a plot over time shows it.
struct ShownInterval {
  int sensor = 0;
  TimeNs t = 0;
  double interval_s = 0;
};

void fields(auto& v, ShownInterval& i) {
  v("sensor", i.sensor, "its position in `sample_intervals`");
  v("t_ns", i.t, "of the later sample");
  v("interval_s", i.interval_s, "s", "since the sample before it");
}

/// One camera's errors in one frame.
struct ViewErrors {
  int camera = 0, frame = 0;
  double rmse_px = 0;     ///< of the used corners; NaN without any
  double largest_px = 0;  ///< of them
  std::size_t used = 0;
  std::vector<const CornerResidual*> corners = {};  ///< all, into what viewErrors() was given
};

/// A stage's views by frame, then camera.
std::vector<ViewErrors> viewErrors(const std::vector<CornerResidual>& residuals);

/// Positions of views from the largest RMSE down; those without a used corner come last.
std::vector<std::size_t> worstFirst(const std::vector<ViewErrors>& views);

inline constexpr std::size_t kWorstViews = 8;  ///< whose images a record keeps, and a page lists

/// The image of a view, for the page.
struct ViewImage {
  int camera = 0;
  TimeNs t = 0;
  int factor = 1;
  std::string jpeg;
};

void fields(auto& v, ViewImage& i) {
  v("camera", i.camera, "its position");
  v("t_ns", i.t, "stamp of its frame");
  v("factor", i.factor, "factor by which the image was reduced");
  v("jpeg", i.jpeg, "grey");
}

}  // namespace plumbline

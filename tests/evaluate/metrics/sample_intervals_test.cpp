// SPDX-License-Identifier: BSD-3-Clause
// How evenly samples follow each other: gaps and what is missing in them, and what a plot shows.
#include "evaluate/metrics/sample_intervals.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

constexpr TimeNs kInterval = 5'000'000;

std::vector<TimeNs> stamps(int count) {
  std::vector<TimeNs> all;
  for (int i = 0; i < count; ++i) all.push_back(1'000'000'000 + i * kInterval);
  return all;
}

TEST(SampleIntervals, OfAnEvenStreamAreAllTheMedian) {
  const SampleIntervals s = sampleIntervals("imu", stamps(101));
  EXPECT_EQ(s.sensor, "imu");
  EXPECT_EQ(s.samples, 101U);
  EXPECT_DOUBLE_EQ(s.median_s, 0.005);
  EXPECT_DOUBLE_EQ(s.min_s, 0.005);
  EXPECT_DOUBLE_EQ(s.max_s, 0.005);
  EXPECT_EQ(s.spread_s, 0);
  EXPECT_EQ(s.gap_count, 0U);
  EXPECT_EQ(s.missing, 0U);
}

TEST(SampleIntervals, GapsCountTheSamplesThatWereTakenOut) {
  std::vector<TimeNs> t = stamps(101);
  t.erase(t.begin() + 70);                  // one
  t.erase(t.begin() + 20, t.begin() + 24);  // four
  const SampleIntervals s = sampleIntervals("imu", t);
  ASSERT_EQ(s.gaps.size(), 2U);
  EXPECT_EQ(s.gaps[0].t, 1'000'000'000 + 19 * kInterval);
  EXPECT_DOUBLE_EQ(s.gaps[0].duration_s, 0.025);
  EXPECT_EQ(s.gaps[0].missing, 4);
  EXPECT_EQ(s.gaps[1].t, 1'000'000'000 + 69 * kInterval);
  EXPECT_EQ(s.gaps[1].missing, 1);
  EXPECT_EQ(s.missing, 5U);
  EXPECT_EQ(s.gap_count, 2U);
  EXPECT_DOUBLE_EQ(s.max_s, 0.025);
}

TEST(SampleIntervals, AFirstStampOfZeroIsAVeryLongGap) {
  std::vector<TimeNs> t = {0};
  for (const TimeNs stamp : stamps(101)) t.push_back(1'700'000'000'000'000'000 + stamp);
  const SampleIntervals s = sampleIntervals("imu", t);
  ASSERT_EQ(s.gap_count, 1U);
  EXPECT_EQ(s.gaps[0].missing, std::numeric_limits<int>::max());
  EXPECT_EQ(s.missing, static_cast<std::size_t>(std::numeric_limits<int>::max()));
}

TEST(SampleIntervals, LateStampsAreNoGaps) {
  std::vector<TimeNs> t = stamps(101);
  t[50] += kInterval * 4 / 10;  // 1.4 intervals before it, 0.6 after
  const SampleIntervals s = sampleIntervals("cam0", t);
  EXPECT_EQ(s.gap_count, 0U);
  EXPECT_DOUBLE_EQ(s.max_s, 0.007);
  EXPECT_DOUBLE_EQ(s.min_s, 0.003);
}

TEST(SampleIntervals, OfManyGapsTheLongestAreListedAndAllAreCounted) {
  std::vector<TimeNs> t = {0};
  for (int i = 0; i < 400; ++i) t.push_back(t.back() + (i % 2 == 0 ? 1 : 2 + i) * kInterval);
  for (int i = 0; i < 400; ++i) t.push_back(t.back() + kInterval);
  const SampleIntervals s = sampleIntervals("imu", t);
  EXPECT_EQ(s.gap_count, 200U);
  ASSERT_EQ(s.gaps.size(), SampleIntervals::kMostGaps);
  EXPECT_EQ(s.gaps.back().missing, 400);
  EXPECT_EQ(s.gaps.front().missing, 202);
  EXPECT_TRUE(std::is_sorted(s.gaps.begin(), s.gaps.end(),
                             [](const SampleGap& a, const SampleGap& b) { return a.t < b.t; }));
}

std::size_t sumOf(const IntervalHistogram& h) {
  return std::accumulate(h.counts.begin(), h.counts.end(), h.below + h.above);
}

TEST(SampleIntervals, TheHistogramCountsEveryInterval) {
  std::vector<TimeNs> t = stamps(20'001);
  for (std::size_t i = 1; i < t.size(); i += 2) t[i] += 400'000;  // 5.4 and 4.6 ms in turn
  t.erase(t.begin() + 777);                                       // two of them become 10 ms
  const IntervalHistogram h = sampleIntervals("imu", t).histogram;
  EXPECT_EQ(sumOf(h), 19'999U);
  EXPECT_EQ(h.below, 0U);
  EXPECT_EQ(h.above, 1U) << "a gap does not make the others too narrow to tell apart";
  const auto countAt = [&](double interval_s) {
    return h.counts.at(static_cast<std::size_t>((interval_s - h.first_s) / h.bin_s));
  };
  EXPECT_EQ(countAt(0.0054), 9'999U);
  EXPECT_EQ(countAt(0.0046), 9'999U);
  EXPECT_LT(h.bin_s, 0.1e-3);
}

TEST(SampleIntervals, TheHistogramOfAnEvenStreamIsOneBinInItsMiddle) {
  const IntervalHistogram h = sampleIntervals("cam0", stamps(101)).histogram;
  ASSERT_EQ(h.counts.size() % 2, 1U);
  EXPECT_EQ(h.counts[h.counts.size() / 2], 100U);
  EXPECT_NEAR(h.first_s + h.bin_s * static_cast<double>(h.counts.size()) / 2, 0.005, 1e-9);
}

TEST(SampleIntervals, OfFewerThanTwoSamplesThereAreNone) {
  for (const int count : {0, 1}) {
    const SampleIntervals s = sampleIntervals("cam0", stamps(count));
    EXPECT_EQ(s.samples, static_cast<std::size_t>(count));
    EXPECT_EQ(s.median_s, 0);
    EXPECT_EQ(s.gap_count, 0U);
    EXPECT_TRUE(s.histogram.counts.empty());
  }
}

TEST(SampleIntervals, APlotOfALongStreamKeepsItsGapAndItsEarlyStamp) {
  Session session;
  session.cameras.resize(1);
  session.cameras[0].name = "left";
  for (const TimeNs t : stamps(3)) session.cameras[0].views.push_back({t, {}});
  session.imu.emplace();
  std::vector<TimeNs> t = stamps(20'000);
  t[7'000] -= kInterval / 2;
  t.erase(t.begin() + 12'345);
  for (const TimeNs stamp : t) session.imu->samples.push_back({stamp, {}, {}});
  CalibrationRecord record;
  addSampleIntervals(session, record);
  ASSERT_EQ(record.sample_intervals.size(), 2U);
  EXPECT_EQ(record.sample_intervals[0].sensor, "left");
  EXPECT_EQ(record.sample_intervals[1].sensor, "imu");
  const auto& shown = record.shown_intervals;
  EXPECT_LE(shown.size(), 2U + 800U);
  const auto has = [&](double interval, TimeNs at) {
    return std::any_of(shown.begin(), shown.end(), [&](const ShownInterval& i) {
      return i.sensor == 1 && i.t == at && std::abs(i.interval_s - interval) < 1e-12;
    });
  };
  EXPECT_TRUE(has(0.0025, 1'000'000'000 + 7'000 * kInterval - kInterval / 2));
  EXPECT_TRUE(has(0.01, 1'000'000'000 + 12'346 * kInterval));
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "evaluate/statistics/several_tests.h"

namespace plumbline {

std::vector<SurvivalPoint> kaplanMeier(std::vector<TimeToEvent> times) {
  std::sort(times.begin(), times.end(),
            [](const TimeToEvent& a, const TimeToEvent& b) { return a.t < b.t; });
  std::vector<SurvivalPoint> curve;
  double survival = 1;
  for (std::size_t i = 0; i < times.size();) {
    std::size_t end = i;
    int events = 0;
    for (; end < times.size() && times[end].t == times[i].t; ++end) events += times[end].done;
    // Those whose time is not before this one, events and censored ones alike.
    const auto at_risk = static_cast<int>(times.size() - i);
    // Where all are censored the curve does not fall: they only leave the numbers at risk.
    if (events > 0) {
      survival *= 1 - static_cast<double>(events) / at_risk;
      curve.push_back({times[i].t, at_risk, events, survival});
    }
    i = end;
  }
  return curve;
}

double restrictedMean(const std::vector<SurvivalPoint>& curve, double limit) {
  double area = 0, from = 0, height = 1;
  for (const SurvivalPoint& point : curve) {
    if (point.t >= limit) break;
    area += height * (point.t - from);
    from = point.t;
    height = point.survival;
  }
  return area + height * (limit - from);
}

std::optional<double> medianSurvival(const std::vector<SurvivalPoint>& curve) {
  for (const SurvivalPoint& point : curve) {
    // A product of fractions that is 1/2 may come out a rounding above it.
    if (point.survival <= 0.5 + 1e-12) return point.t;
  }
  return std::nullopt;
}

}  // namespace plumbline

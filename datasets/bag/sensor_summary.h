// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iterator>
#include <map>
#include <vector>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/bag/import_bag.h"

namespace plumbline {

/// A sensor with the number, times and rate of what it gave; `items` by stamp, at least one.
template <class Item>
ImportedSensor summaryOf(ImportedSensor sensor, const std::map<TimeNs, Item>& items) {
  std::vector<double> intervals;
  for (auto at = items.begin(); std::next(at) != items.end(); ++at) {
    intervals.push_back(1e-9 * static_cast<double>(std::next(at)->first - at->first));
  }
  sensor.count = items.size();
  sensor.first = items.begin()->first;
  sensor.last = items.rbegin()->first;
  sensor.rate_hz = intervals.empty() ? 0 : 1 / median(intervals);
  return sensor;
}

}  // namespace plumbline

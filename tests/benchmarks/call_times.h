// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

namespace plumbline::test {

/// Processor time of each of many calls [ms], in ascending order at the end.
class CallTimes {
 public:
  template <class Call>
  void time(const Call& call) {
    const std::clock_t start = std::clock();
    call();
    ms_.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  void report(benchmark::State& state) {
    std::sort(ms_.begin(), ms_.end());
    const auto at = [&](double share) {
      return ms_[static_cast<std::size_t>(share * static_cast<double>(ms_.size() - 1))];
    };
    state.counters["p50_ms"] = at(0.5);
    state.counters["p95_ms"] = at(0.95);
    state.counters["p99_ms"] = at(0.99);
    state.counters["max_ms"] = ms_.back();
    state.counters["calls"] = static_cast<double>(ms_.size());
  }

 private:
  std::vector<double> ms_;
};

}  // namespace plumbline::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "evaluate/trajectory/evaluate_runs.h"
#include "evaluate/trajectory/evaluate_trajectory.h"

namespace plumbline {

/// How trajectories are judged, in the words of the command line; `evaluate trajectory` and
/// `evaluate trajectories` share them.
struct TrajectoryMetricWords {
  std::string align = "se3", association = "one-to-one", rpe = "1m";
  std::string rpe_pairs = "plumbline";
  std::string clock_offset = "none", hand_eye = "none";
  TrajectoryRequest request;            ///< what is no word
  std::optional<double> clock_range_s;  ///< of auto alone
  std::string coverage_from = "start";
  double min_coverage = kLeastCoverage;
  double max_ate_m = 0;  ///< 0: not given
};

/// Adds the options to `app`, which fills `words`.
void declareTrajectoryMetrics(CLI::App& app, TrajectoryMetricWords& words);

/// --min-coverage, --coverage-from and --max-ate, for commands that judge whether a run is
/// complete.
void declareCoverage(CLI::App& app, TrajectoryMetricWords& words);

/// Theirs that a run's status depends on, of the runs that are there or that are made.
template <class Request>
void setLimits(const TrajectoryMetricWords& words, Request& request) {
  request.min_coverage = words.min_coverage;
  // Otherwise each run has a limit of its own, from its truth and alignment.
  if (words.max_ate_m > 0) request.max_ate_m = words.max_ate_m;
}

/// The request with the words as values; throws InputError that names an option and what it may be.
TrajectoryRequest judgedAs(const TrajectoryMetricWords& words);

}  // namespace plumbline

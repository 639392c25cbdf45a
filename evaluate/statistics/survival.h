// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace plumbline {

/// A time until done; `done` false: it ended without (censored).
struct TimeToEvent {
  double t = 0;
  bool done = true;
};

/// A step of the survival curve.
struct SurvivalPoint {
  double t = 0;
  int at_risk = 0;      ///< just before t
  int events = 0;       ///< at t
  double survival = 1;  ///< from t on
};

/// Kaplan and Meier's product limit S(t) = prod_{t_i <= t} (1 - d_i / n_i); one point per distinct
/// time of an event. Censored ones at a time of an event are at risk there.
std::vector<SurvivalPoint> kaplanMeier(std::vector<TimeToEvent> times);

/// Area below the curve from 0 to `limit`. Where the last ones are censored before the limit the
/// curve goes on at its last height.
double restrictedMean(const std::vector<SurvivalPoint>& curve, double limit);

/// The first time at which the curve is at 1/2 or below.
std::optional<double> medianSurvival(const std::vector<SurvivalPoint>& curve);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/replay/view_pool.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// The least number of views from which on the curve's error stays at the target or below; a point
/// without a solution misses it. Between two abscissae of the curve the interval is halved, before
/// the first one nothing is tried.
std::optional<int> viewsNeeded(const ViewPool& pool, const CounterfactualCurve& curve,
                               double target_px);

/// Numbers of views at which all curves are evaluated: the options' (or the default) up to the
/// longest order, and every order's length.
std::vector<int> evaluatedViews(const std::vector<CounterfactualCurve>& curves,
                                const std::vector<int>& asked);

/// The curves with entropies and held-out errors at those numbers of views. The same for any number
/// of threads.
std::vector<CounterfactualCurve> evaluated(const ViewPool& pool,
                                           std::vector<CounterfactualCurve> curves,
                                           const std::vector<int>& views, int threads);

/// Quartiles over the seeds of each strategy, and each strategy's regret.
std::vector<CounterfactualBand> bandsOf(const std::vector<CounterfactualCurve>& curves);

/// Fills the curves' regret from the bands.
std::vector<CounterfactualCurve> withRegret(std::vector<CounterfactualCurve> curves,
                                            const std::vector<CounterfactualBand>& bands);

/// The curves of one strategy.
std::vector<const CounterfactualCurve*> curvesOf(const std::vector<CounterfactualCurve>& curves,
                                                 const std::string& strategy);

/// Quartiles over curves of one strategy at place `i` of their abscissa; empty unless all have a
/// value there.
using CurveValues = std::vector<std::optional<double>> CounterfactualCurve::*;
std::optional<Quartiles> quartilesAt(const std::vector<const CounterfactualCurve*>& curves,
                                     CurveValues values, std::size_t i);

/// A band by its strategy; nullptr where there is none.
const CounterfactualBand* findBand(const std::vector<CounterfactualBand>& bands,
                                   const std::string& strategy);

}  // namespace plumbline

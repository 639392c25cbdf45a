// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/replay/counterfactuals.h"
#include "evaluate/replay/view_pool.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// The orders of the strategies (names and seeds as CounterfactualOptions says), not yet evaluated.
std::vector<CounterfactualCurve> strategyOrders(const ViewPool& pool,
                                                const std::vector<int>& guide_frames,
                                                const CounterfactualOptions& options);

/// Numbers of views at which all curves are evaluated: the options' (or the default) up to the
/// longest order, and every order's length.
std::vector<int> evaluatedViews(const std::vector<CounterfactualCurve>& curves,
                                const std::vector<int>& asked);

/// The curves with entropies and held-out errors at those numbers of views. The same for any number
/// of threads.
std::vector<CounterfactualCurve> evaluated(const ViewPool& pool,
                                           std::vector<CounterfactualCurve> curves,
                                           const std::vector<int>& views, int threads);

/// Evaluated curves with views_needed to come to `target_px` or below for good: from the last
/// number of views that misses it, the interval up to the next one is halved.
std::vector<CounterfactualCurve> withViewsNeeded(const ViewPool& pool,
                                                 std::vector<CounterfactualCurve> curves,
                                                 double target_px, int threads);

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

/// Sentences, with figures, on how greedy MI compares with random orders and, where it does no
/// better, what its views have in common: where their corners lie, how well the model fits them, in
/// which part of the image the held-out error is, and whether another model changes it. Only what
/// the numbers hold is said.
std::vector<std::string> counterfactualRemarks(const ViewPool& pool, const Counterfactuals& found,
                                               int guide_frames);

}  // namespace plumbline

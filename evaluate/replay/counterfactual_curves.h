// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
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

/// The curves with entropies and held-out errors at those numbers of views, and views_needed to
/// come to `target_px` or below: the first of `views` that does, then halving the interval before
/// it. The same for any number of threads.
std::vector<CounterfactualCurve> evaluated(const ViewPool& pool,
                                           std::vector<CounterfactualCurve> curves,
                                           const std::vector<int>& views, double target_px,
                                           int threads);

/// Quartiles over the seeds of each strategy, and each strategy's regret.
std::vector<CounterfactualBand> bandsOf(const std::vector<CounterfactualCurve>& curves);

/// Fills the curves' regret from the bands.
std::vector<CounterfactualCurve> withRegret(std::vector<CounterfactualCurve> curves,
                                            const std::vector<CounterfactualBand>& bands);

/// A band by its strategy; nullptr where there is none.
const CounterfactualBand* findBand(const std::vector<CounterfactualBand>& bands,
                                   const std::string& strategy);

}  // namespace plumbline

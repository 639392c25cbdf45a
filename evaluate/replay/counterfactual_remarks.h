// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/replay/view_pool.h"
#include "report/records/replay_record.h"

namespace plumbline {

/// Sentences, with figures, on how greedy MI compares with random orders and, where it does no
/// better, what its views have in common: where their corners lie, how well the model fits them, in
/// which part of the image the held-out error is, and whether another model changes it. Only what
/// the numbers hold is said.
std::vector<std::string> counterfactualRemarks(const ViewPool& pool, const Counterfactuals& found,
                                               int guide_frames);

}  // namespace plumbline

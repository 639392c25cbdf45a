// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "report/records/replay_record.h"

namespace plumbline {

struct ReplayPageOptions {
  /// Most that the images may take up in the page [bytes]. Beyond it every n-th frame keeps its
  /// own, and the page says so.
  std::size_t image_bytes = 24'000'000;
};

/// One self-contained HTML page: a player (time slider, images or corners with what was suggested
/// drawn over them, 3D scene with the candidates coloured by their gain, gain and entropy over
/// time, list of events, the decision of the frame), then verdict, stages, suggestions, stop audit,
/// compliance, counterfactuals, provenance. It needs no network, no other file and no GPU. Parts
/// that the record does not have are left out. Equal records give equal bytes. One thread at a time
/// (see report/plots/svg.h).
///
/// Everything but the images takes about 1.5 kB a frame of two cameras with 144 corners each.
std::string renderReplayPage(const ReplayRecord& record, const ReplayPageOptions& options = {});

}  // namespace plumbline

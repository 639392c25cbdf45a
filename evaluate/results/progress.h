// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace plumbline {

/// Told of long work as it goes: what is being done, and how far (0 to 1; negative: not known).
/// Called from one thread at a time.
using ProgressSink = std::function<void(const std::string& step, double fraction)>;

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace plumbline {

/// Told of long work as it goes: what is being done, and how far (0 to 1; negative: not known).
/// Called from one thread at a time.
using ProgressSink = std::function<void(const std::string& step, double fraction)>;

/// Calls body(worker, index) once for each index below `count`, on up to `threads` threads (0: all
/// cores), indices handed out in order. An exception in a body stops the rest; the one with the
/// lowest index is rethrown, so that errors do not depend on the threads either.
void parallelFor(std::size_t count, int threads,
                 const std::function<void(int worker, std::size_t index)>& body);

/// The same work, of which `progress`, if there is one, is told as `step` after each index.
void parallelFor(std::size_t count, int threads, const std::string& step,
                 const ProgressSink& progress,
                 const std::function<void(int worker, std::size_t index)>& body);

/// The number of threads that `threads` stands for.
int threadCount(int threads);

}  // namespace plumbline

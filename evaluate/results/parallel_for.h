// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace plumbline {

/// Calls body(worker, index) once for each index below `count`, on up to `threads` threads (0: all
/// cores), indices handed out in order. An exception in a body stops the rest; the one with the
/// lowest index is rethrown, so that errors do not depend on the threads either.
void parallelFor(std::size_t count, int threads,
                 const std::function<void(int worker, std::size_t index)>& body);

/// The number of threads that `threads` stands for.
int threadCount(int threads);

}  // namespace plumbline

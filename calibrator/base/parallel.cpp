// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace plumbline {

void parallelCalls(int count, int threads, const std::function<void(int)>& work) {
  const int used = std::min(threads, count);
  if (used <= 1) {
    for (int i = 0; i < count; ++i) work(i);
    return;
  }
  // An arena of its own keeps to the threads that were asked for; one task for each call, for the
  // calls are the chunks already, whose bounds results may depend on.
  tbb::task_arena arena(used);
  arena.execute([&] { tbb::parallel_for(0, count, work, tbb::simple_partitioner()); });
}

}  // namespace plumbline

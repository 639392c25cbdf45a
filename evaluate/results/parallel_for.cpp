// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

/// The exception of the lowest index; that index bounds the work that is still worth doing.
class FirstFailure {
 public:
  bool isBefore(std::size_t index) const { return index_ < index; }
  void note(std::size_t index) {
    const std::lock_guard lock(mutex_);
    // Bodies of lower indices still run to their end and may replace this one.
    if (index >= index_) return;
    index_ = index;
    error_ = std::current_exception();
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<std::size_t> index_{std::numeric_limits<std::size_t>::max()};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

int threadCount(int threads) {
  return threads > 0 ? threads : tbb::this_task_arena::max_concurrency();
}

void parallelFor(std::size_t count, int threads,
                 const std::function<void(int, std::size_t)>& body) {
  // No more than there is work for: each worker may hold memory of its own, as detectors do.
  const int workers = static_cast<int>(
      std::clamp<std::size_t>(count, 1, static_cast<std::size_t>(threadCount(threads))));
  std::atomic<std::size_t> next{0};
  FirstFailure failure;
  // One task a worker, each taking the next index: indices begin in order, whatever they cost.
  tbb::task_arena(workers).execute([&] {
    tbb::parallel_for(0, workers, [&](int worker) {
      for (std::size_t i = next++; i < count && !failure.isBefore(i); i = next++) {
        try {
          body(worker, i);
        } catch (...) {
          failure.note(i);
        }
      }
    });
  });
  failure.rethrow();
}

void parallelFor(std::size_t count, int threads, const std::string& step,
                 const ProgressSink& progress, const std::function<void(int, std::size_t)>& body) {
  std::mutex telling;
  std::size_t done = 0;
  parallelFor(count, threads, [&](int worker, std::size_t i) {
    body(worker, i);
    // Counted under the lock as well: the shares told ascend.
    const std::lock_guard lock(telling);
    ++done;
    if (progress) progress(step, static_cast<double>(done) / static_cast<double>(count));
  });
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace plumbline {

/// A segment [begin, end) of a range that is cut into chunks of fixed size.
struct Chunk {
  int index = 0;
  int begin = 0;
  int end = 0;
};

inline int chunkCount(int count, int size) { return (count + size - 1) / size; }

/// Calls work(Chunk) once for every chunk of 0 .. count, on up to `threads` threads. The cut does
/// not depend on `threads`: partial sums kept per chunk and added in the order of the chunks give
/// the same bits for any number of threads. `work` must not throw.
template <class Work>
void forChunks(int count, int size, int threads, Work&& work) {
  const int chunks = chunkCount(count, size);
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < chunks; i = next++) {
      work(Chunk{i, i * size, std::min(count, (i + 1) * size)});
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < std::min(threads, chunks); ++t) others.emplace_back(run);
  run();
  for (std::thread& other : others) other.join();
}

}  // namespace plumbline

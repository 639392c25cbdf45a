// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <vector>

namespace plumbline {

/// A segment [begin, end) of a range that is cut into chunks of fixed size.
struct Chunk {
  int index = 0;
  int begin = 0;
  int end = 0;
};

inline int chunkCount(int count, int size) { return (count + size - 1) / size; }

/// Calls work(0), ..., work(count - 1), each once, on up to `threads` threads (TBB). An exception
/// of one call is thrown again here.
void parallelCalls(int count, int threads, const std::function<void(int)>& work);

/// Calls work(Chunk) once for every chunk of 0 .. count, on up to `threads` threads. The cut does
/// not depend on `threads`: partial sums kept per chunk and added in the order of the chunks give
/// the same bits for any number of threads.
template <class Work>
void forChunks(int count, int size, int threads, Work&& work) {
  parallelCalls(chunkCount(count, size), threads, [&](int i) {
    work(Chunk{i, i * size, std::min(count, (i + 1) * size)});
  });
}

/// What work(0), ..., work(count - 1) give, on up to `threads` threads; work takes a std::size_t.
template <class Work>
auto parallelMap(std::size_t count, int threads, Work&& work) {
  using Value = std::invoke_result_t<Work&, std::size_t>;
  // Threads would write into one word of a vector of bool.
  static_assert(!std::is_same_v<Value, bool>);
  std::vector<Value> out(count);
  parallelCalls(static_cast<int>(count), threads, [&](int i) { out[i] = work(i); });
  return out;
}

/// Two calls at once, on up to `threads` threads.
template <class First, class Second>
void inParallel(int threads, First&& first, Second&& second) {
  parallelCalls(2, threads, [&](int i) { i == 0 ? first() : second(); });
}

}  // namespace plumbline

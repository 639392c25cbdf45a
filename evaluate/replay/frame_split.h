// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/session.h"

namespace plumbline {

/// Frames of a recording that are chosen from, and those that choices are judged by: positions in
/// pairFrames(session.cameras, pairing), ascending, no frame in both.
struct FrameSplit {
  std::vector<int> pool;
  std::vector<int> held_out;
};

struct FrameSplitOptions {
  double block_s = 1;      ///< frames are split into blocks of this length [s]
  int held_out_every = 3;  ///< of so many blocks the last is held out; at least 2
  double guard_s = 0.1;    ///< pool frames this close to a held-out block are in neither [s]

  /// Throws InputError for values out of range.
  void check() const;
};

/// Blocks of time rather than single frames, for neighbours show nearly the same: block b holds the
/// frames with floor((t - t_first) / block_s) = b; held out where (b + 1) % held_out_every = 0.
/// Throws InputError for options out of range.
FrameSplit splitFrames(const Session& session, const FrameSplitOptions& options = {},
                       const FrameOptions& pairing = {});

/// The items at some positions.
template <class Item, class Position>
std::vector<Item> itemsAt(const std::vector<Item>& items, const std::vector<Position>& positions) {
  std::vector<Item> some;
  for (const Position i : positions) some.push_back(items[i]);
  return some;
}

/// At most `most` of the frames, evenly spread.
std::vector<int> thinned(const std::vector<int>& frames, int most);

}  // namespace plumbline

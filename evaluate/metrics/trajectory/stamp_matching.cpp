// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <queue>
#include <tuple>

#include "evaluate/metrics/trajectory/association.h"

namespace plumbline {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Poses of one side that share a stamp, in a doubly linked list over both sides by stamp.
struct Node {
  std::int64_t tick = 0;
  bool is_estimate = false;
  std::size_t first = 0;  // index of the lowest pose that is still free
  std::size_t end = 0;    // one past the last
  std::size_t previous = kNone, next = kNone;

  bool used() const { return first == end; }
};

// Two neighbours of different sides, as they were when the pair was put on the heap.
struct Candidate {
  std::int64_t dt = 0;
  StampMatch match;
  std::size_t left = kNone, right = kNone;

  bool operator>(const Candidate& o) const {
    return std::tie(dt, match.estimate, match.truth) >
           std::tie(o.dt, o.match.estimate, o.match.truth);
  }
};

/// Poses of one side with equal stamps queue in one node and are used lowest index first.
std::vector<Node> groupedByStamp(const Ticks& ticks, bool is_estimate) {
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (nodes.empty() || nodes.back().tick != ticks[i]) {
      nodes.push_back({ticks[i], is_estimate, i, i, kNone, kNone});
    }
    nodes.back().end = i + 1;
  }
  return nodes;
}

/// Both sides in one list by stamp; of equal stamps the estimate's node stands first.
std::vector<Node> mergedNodes(const Ticks& estimate, const Ticks& truth) {
  const std::vector<Node> a = groupedByStamp(estimate, true);
  const std::vector<Node> b = groupedByStamp(truth, false);
  std::vector<Node> nodes(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), nodes.begin(),
             [](const Node& x, const Node& y) { return x.tick < y.tick; });
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (i > 0) nodes[i].previous = i - 1;
    if (i + 1 < nodes.size()) nodes[i].next = i + 1;
  }
  return nodes;
}

class ClosestFirst {
 public:
  ClosestFirst(const Ticks& estimate, const Ticks& truth, double max_dt)
      : nodes_(mergedNodes(estimate, truth)), max_dt_(max_dt) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) offer(i);
  }

  std::vector<StampMatch> run() {
    std::vector<StampMatch> matches;
    while (!heap_.empty()) {
      const Candidate best = heap_.top();
      heap_.pop();
      if (!stillStands(best)) continue;
      matches.push_back(best.match);
      use(best);
    }
    std::sort(matches.begin(), matches.end(),
              [](const StampMatch& x, const StampMatch& y) { return x.estimate < y.estimate; });
    return matches;
  }

 private:
  StampMatch frontsOf(const Node& left, const Node& right) const {
    return left.is_estimate ? StampMatch{left.first, right.first}
                            : StampMatch{right.first, left.first};
  }

  // Puts the pair of `left` and its next neighbour on the heap, if it is one.
  void offer(std::size_t left) {
    if (left == kNone || nodes_[left].next == kNone) return;
    const Node& a = nodes_[left];
    const Node& b = nodes_[a.next];
    const std::int64_t dt = b.tick - a.tick;
    if (a.is_estimate == b.is_estimate || static_cast<double>(dt) > max_dt_) return;
    heap_.push({dt, frontsOf(a, b), left, a.next});
  }

  // Candidates are not taken off the heap when their nodes change; they are recognised here.
  bool stillStands(const Candidate& c) const {
    const Node& a = nodes_[c.left];
    const Node& b = nodes_[c.right];
    return !a.used() && !b.used() && a.next == c.right && frontsOf(a, b) == c.match;
  }

  // Only pairs at the gap are new. One that is offered twice is used once, as stillStands() refuses
  // it then.
  void use(const Candidate& c) {
    ++nodes_[c.left].first;
    ++nodes_[c.right].first;
    if (nodes_[c.right].used()) unlink(c.right);
    if (nodes_[c.left].used()) unlink(c.left);
    offer(nodes_[c.left].previous);
    if (!nodes_[c.left].used()) offer(c.left);
    if (!nodes_[c.right].used()) offer(c.right);
  }

  void unlink(std::size_t i) {
    const Node& node = nodes_[i];
    if (node.previous != kNone) nodes_[node.previous].next = node.next;
    if (node.next != kNone) nodes_[node.next].previous = node.previous;
  }

  std::vector<Node> nodes_;
  double max_dt_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> heap_;
};

}  // namespace

std::vector<StampMatch> closestFirst(const Ticks& estimate, const Ticks& truth, double max_dt) {
  return ClosestFirst(estimate, truth, max_dt).run();
}

std::vector<StampMatch> nearestOfShorter(const Ticks& estimate, const Ticks& truth, double max_dt) {
  const bool estimate_is_short = estimate.size() <= truth.size();
  const Ticks& few = estimate_is_short ? estimate : truth;
  const Ticks& many = estimate_is_short ? truth : estimate;
  std::vector<StampMatch> matches;
  for (std::size_t i = 0; i < few.size() && !many.empty(); ++i) {
    const std::size_t j = firstNearest(many, few[i], 0);
    if (static_cast<double>(std::abs(many[j] - few[i])) > max_dt) continue;
    matches.push_back(estimate_is_short ? StampMatch{i, j} : StampMatch{j, i});
  }
  return matches;
}

std::vector<StampMatch> forwardSweep(const Ticks& estimate, const Ticks& truth, double max_dt) {
  std::vector<StampMatch> matches;
  std::size_t cursor = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const auto dt = [&] { return static_cast<double>(std::abs(truth[cursor] - estimate[i])); };
    // Truth that is too old for this pose is too old for all that follow.
    while (cursor < truth.size() && truth[cursor] < estimate[i] && dt() > max_dt) ++cursor;
    const std::size_t first = cursor;
    double best = max_dt;
    // Past the stamps that come nearer; the last of them is the match, and the cursor stands behind
    // it.
    for (; cursor < truth.size() && dt() < best; ++cursor) best = dt();
    if (cursor > first) matches.push_back({i, cursor - 1});
  }
  return matches;
}

}  // namespace plumbline

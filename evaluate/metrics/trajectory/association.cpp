// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/association.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

// 2^-30 s. At today's epoch a double of seconds is a multiple of 2^-22 s, so this grid holds it
// exactly, and with it every difference of two of them.
constexpr int kGridBits = 30;

/// The rules that stand for other tools, which read stamps as doubles of seconds.
bool seesDoubles(AssociationRule rule) {
  return rule == AssociationRule::kEvo || rule == AssociationRule::kRpg ||
         rule == AssociationRule::kOvEval;
}

// The double of seconds that a tool reads from a file, on the grid.
std::int64_t gridTick(TimeNs t) {
  // long double holds every nanosecond of an int64 (64-bit mantissa); a division in double would
  // round twice.
  const auto seconds = static_cast<double>(static_cast<long double>(t) / 1e9L);
  return std::llround(std::ldexp(seconds, kGridBits));
}

Ticks ticksOf(const std::vector<StampedPose>& poses, AssociationRule rule) {
  Ticks ticks;
  ticks.reserve(poses.size());
  const bool doubles = seesDoubles(rule);
  for (const StampedPose& pose : poses) ticks.push_back(doubles ? gridTick(pose.t) : pose.t);
  return ticks;
}

/// The limit on the grid on which stamps are compared; it may lie between two ticks.
double maxTicks(const AssociationOptions& o) {
  if (seesDoubles(o.rule)) return std::ldexp(o.max_dt_s, kGridBits);
  return static_cast<double>(toNanoseconds(o.max_dt_s));
}

std::vector<StampMatch> matchesOf(const std::vector<StampedPose>& estimate,
                                  const std::vector<StampedPose>& truth,
                                  const AssociationOptions& o) {
  const Ticks a = ticksOf(estimate, o.rule);
  const Ticks b = ticksOf(truth, o.rule);
  const double max_dt = maxTicks(o);
  switch (o.rule) {
    case AssociationRule::kEvo:
      return nearestOfShorter(a, b, max_dt);
    case AssociationRule::kRpg:
      return closestFirst(a, b, std::ceil(max_dt) - 1);  // strictly below
    case AssociationRule::kOvEval:
      return forwardSweep(a, b, max_dt);
    default:
      return closestFirst(a, b, max_dt);
  }
}

/// Poses that have the stamp of the one before; stamps do not descend.
std::size_t duplicatesOf(const std::vector<StampedPose>& poses) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) count += poses[i].t == poses[i - 1].t ? 1 : 0;
  return count;
}

double largestGapOf(const std::vector<StampedPose>& poses) {
  TimeNs gap = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) gap = std::max(gap, poses[i].t - poses[i - 1].t);
  return static_cast<double>(gap) * 1e-9;
}

/// Signed, t_estimate - t_truth [s]: a constant offset of the clocks stays visible in it. 0
/// of no pairs.
double medianDt(const std::vector<PosePair>& pairs) {
  std::vector<double> dt;
  dt.reserve(pairs.size());
  for (const PosePair& pair : pairs) dt.push_back(secondsBetween(pair.truth.t, pair.estimate.t));
  return sampleStatistics(std::move(dt)).median;
}

/// t + offset, the offset rounded to a nanosecond once, so that intervals stay as they are.
std::vector<StampedPose> shifted(std::vector<StampedPose> poses, double offset_s) {
  const TimeNs offset = toNanoseconds(offset_s);
  for (StampedPose& pose : poses) pose.t += offset;
  return poses;
}

void addInterpolated(const std::vector<StampedPose>& estimate,
                     const std::vector<StampedPose>& truth, double max_gap_s, Association& result) {
  const TimeNs max_gap = toNanoseconds(max_gap_s);
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Interpolated at = poseAt(truth, estimate[i].t, max_gap);
    if (at.in_gap) ++result.record.stamps_in_gaps;
    if (!at.pose) continue;
    result.pairs.push_back({estimate[i], *at.pose});
    result.estimate_index.push_back(i);
  }
}

AssociationRecord describe(const Trajectory& estimate, const Trajectory& truth,
                           const AssociationOptions& o) {
  AssociationRecord record;
  record.rule = toString(o.rule);
  record.max_dt_s = o.rule == AssociationRule::kInterpolate ? 0 : o.max_dt_s;
  record.time_offset_s = o.time_offset_s;
  record.estimate_poses = estimate.poses.size();
  record.truth_poses = truth.poses.size();
  record.estimate_duplicates = duplicatesOf(estimate.poses);
  record.truth_duplicates = duplicatesOf(truth.poses);
  record.largest_estimate_gap_s = largestGapOf(estimate.poses);
  record.largest_truth_gap_s = largestGapOf(truth.poses);
  return record;
}

constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);

// Poses of one side that share a stamp, in a doubly linked list over both sides by stamp.
struct Node {
  std::int64_t tick = 0;
  bool is_estimate = false;
  std::size_t first = 0;  // index of the lowest pose that is still free
  std::size_t end = 0;    // one past the last
  std::size_t previous = kNoIndex, next = kNoIndex;

  bool used() const { return first == end; }
};

// Two neighbours of different sides, as they were when the pair was put on the heap.
struct Candidate {
  std::int64_t dt = 0;
  StampMatch match;
  std::size_t left = kNoIndex, right = kNoIndex;

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
      nodes.push_back({ticks[i], is_estimate, i, i, kNoIndex, kNoIndex});
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
    if (left == kNoIndex || nodes_[left].next == kNoIndex) return;
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
    if (node.previous != kNoIndex) nodes_[node.previous].next = node.next;
    if (node.next != kNoIndex) nodes_[node.next].previous = node.previous;
  }

  std::vector<Node> nodes_;
  double max_dt_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> heap_;
};

}  // namespace

double usualInterval(const std::vector<StampedPose>& poses) {
  std::vector<TimeNs> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i) intervals.push_back(poses[i].t - poses[i - 1].t);
  return intervals.empty() ? 0 : 1e-9 * static_cast<double>(middleOf(std::move(intervals)));
}

Interpolated poseAt(const std::vector<StampedPose>& poses, TimeNs t, TimeNs max_gap) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), t,
                       [](const StampedPose& pose, TimeNs at) { return pose.t < at; });
  if (after == poses.end()) return {};
  if (after->t == t) return {*after, false};
  if (after == poses.begin()) return {};
  const StampedPose& a = *(after - 1);
  const StampedPose& b = *after;
  // Across a wide gap the truth's motion is unknown, and a straight line would be charged to the
  // estimate.
  if (b.t - a.t > max_gap) return {std::nullopt, true};
  const double u = static_cast<double>(t - a.t) / static_cast<double>(b.t - a.t);
  const Eigen::Vector3d p = (1 - u) * a.p + u * b.p;
  return {StampedPose{t, p, a.q.normalized().slerp(u, b.q.normalized())}, false};
}

Association associate(const Trajectory& estimate, const Trajectory& truth,
                      const AssociationOptions& options) {
  assert(options.max_dt_s >= 0 && options.max_gap_s >= 0);
  Association result{{}, describe(estimate, truth, options), {}};
  const std::vector<StampedPose> poses = shifted(estimate.poses, options.time_offset_s);
  if (options.rule == AssociationRule::kInterpolate) {
    addInterpolated(poses, truth.poses, options.max_gap_s, result);
  } else {
    for (const StampMatch& match : matchesOf(poses, truth.poses, options)) {
      result.pairs.push_back({poses[match.estimate], truth.poses[match.truth]});
      result.estimate_index.push_back(match.estimate);
    }
  }
  result.record.matches = result.pairs.size();
  result.record.median_dt_s = medianDt(result.pairs);
  return result;
}

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

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/view_orders.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <queue>
#include <set>

#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

constexpr double kWeakPrior = 1000;  // standard deviations over those that all views leave

/// Views by the largest gain that they can still have, the earlier one first in a tie.
struct GainBound {
  double gain = 0;
  int view = 0;
  int computed_at = 0;  ///< views used when the gain was computed
  bool operator<(const GainBound& other) const {
    return gain != other.gain ? gain < other.gain : view > other.view;
  }
};

/// log |I + S|, with parameters in units of the prior's standard deviations.
double logDeterminantOfScaled(const Eigen::MatrixXd& information) {
  // Positive definite whatever the views, by the identity in it.
  const Eigen::LLT<Eigen::MatrixXd> llt(information);
  return 2 * llt.matrixLLT().diagonal().array().log().sum();
}

class GreedyOrder {
 public:
  GreedyOrder(const std::vector<Eigen::MatrixXd>& shares, const Eigen::VectorXd& prior_std) {
    for (const Eigen::MatrixXd& share : shares) {
      // Scaling from both sides adds the same to every log-determinant, so that gains stay as they
      // are, and the prior becomes the identity.
      scaled_.emplace_back(prior_std.asDiagonal() * share * prior_std.asDiagonal());
    }
    information_ = Eigen::MatrixXd::Identity(prior_std.size(), prior_std.size());
  }

  // Minoux' accelerated greedy algorithm (1978): a view whose gain is of now and still leads is the
  // best, for the bounds of the others only fall.
  std::vector<int> run() {
    std::priority_queue<GainBound> queue;
    for (int v = 0; v < static_cast<int>(scaled_.size()); ++v) queue.push({gain(v), v, 0});
    std::vector<int> order;
    while (!queue.empty()) {
      GainBound best = queue.top();
      queue.pop();
      const int used = static_cast<int>(order.size());
      if (best.computed_at < used) {
        queue.push({gain(best.view), best.view, used});
        continue;
      }
      order.push_back(best.view);
      information_ += scaled_[best.view];
      log_determinant_ = logDeterminantOfScaled(information_);
    }
    return order;
  }

 private:
  double gain(int view) const {
    const Eigen::MatrixXd& share = scaled_[view];
    return 0.5 * (logDeterminantOfScaled(information_ + share) - log_determinant_);
  }

  std::vector<Eigen::MatrixXd> scaled_;
  Eigen::MatrixXd information_;
  double log_determinant_ = 0;
};

}  // namespace

std::vector<int> greedyInformationOrder(const std::vector<Eigen::MatrixXd>& shares) {
  if (shares.empty()) return {};
  Eigen::MatrixXd all = shares.front();
  for (std::size_t v = 1; v < shares.size(); ++v) all += shares[v];
  const auto covariance = covarianceOf(all);
  if (!covariance) return {};
  // Scaled by each parameter's own deviation, as pixels and radians have no size in common.
  return GreedyOrder(shares, kWeakPrior * covariance->diagonal().cwiseSqrt()).run();
}

std::vector<std::vector<int>> cellsSeen(const Session& session, const std::vector<Frame>& frames,
                                        const ImageCells& grid) {
  std::vector<std::vector<int>> cells;
  for (const Frame& frame : frames) {
    std::set<int> seen;
    for (std::size_t c = 0; c < frame.view.size(); ++c) {
      if (frame.view[c] < 0) continue;
      const CameraStream& camera = session.cameras[c];
      const int first = static_cast<int>(c) * grid.size();
      for (const Corner& corner : camera.views[frame.view[c]].corners) {
        seen.insert(first + grid.cellOf(corner.uv, camera.resolution));
      }
    }
    cells.emplace_back(seen.begin(), seen.end());
  }
  return cells;
}

std::vector<int> coverageOrder(const std::vector<std::vector<int>>& cells) {
  int count = 0;
  for (const std::vector<int>& seen : cells) {
    for (const int cell : seen) count = std::max(count, cell + 1);
  }
  std::vector<bool> covered(count, false);
  const auto adds = [&](int view) {
    return std::ranges::count_if(cells[view], [&](int cell) { return !covered[cell]; });
  };
  std::vector<int> left(cells.size());
  std::iota(left.begin(), left.end(), 0);
  std::vector<int> order;
  while (!left.empty()) {
    auto best = left.begin();
    auto most = adds(*best);
    for (auto v = left.begin() + 1; v != left.end(); ++v) {
      const auto added = adds(*v);
      if (added > most) best = v;
      most = std::max(most, added);
    }
    // Not where nothing is covered: views without a corner would begin anew for ever.
    if (most == 0 && std::ranges::find(covered, true) != covered.end()) {
      covered.assign(count, false);
      continue;
    }
    for (const int cell : cells[*best]) covered[cell] = true;
    order.push_back(*best);
    left.erase(best);
  }
  return order;
}

}  // namespace plumbline

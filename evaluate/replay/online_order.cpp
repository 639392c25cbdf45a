// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/online_order.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "calibrator/base/error.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/guidance/views/view_error.h"

namespace plumbline {
namespace {

/// Candidates at the estimate of the time.
class Candidates {
 public:
  Candidates(const ViewPool& pool, const CameraEstimate& cameras, const std::vector<int>& frames)
      : posed_(pool.posed(cameras, frames)),
        // Later use is what the frames to choose from have seen.
        model_(errorModel(posed_.views, cameras, pool.cauchyPx(), LaterUseKind::kSeen)) {
    // Not a number is bad, too.
    const double most = kWorstView * quantile(posed_.rmse_px, 0.5);
    for (const double rmse : posed_.rmse_px) bad_.push_back(!(rmse <= most));
    if (!model_) return;
    for (const RigView& view : posed_.views) terms_.push_back(model_->maker.seen(view));
  }

  bool determined() const { return model_.has_value(); }
  bool isBad(std::size_t i) const { return bad_[i]; }
  const LaterUse& use() const { return model_->use; }
  const ViewTerms& terms(std::size_t i) const { return terms_[i]; }
  std::size_t size() const { return terms_.size(); }

 private:
  ViewPool::PosedFrames posed_;
  std::optional<ErrorModel> model_;
  std::vector<ViewTerms> terms_;
  std::vector<bool> bad_;
};

/// Scores by mutual information; the less, the better, as E: -0.5 log |H + I|, which differs from
/// minus the gain by what is the same for all candidates.
class Information {
 public:
  explicit Information(const Eigen::MatrixXd& before) : H_(before) {}
  void add(const ViewTerms& view) { H_ += view.I; }
  double valueWith(const ViewTerms& view) const {
    const Eigen::LLT<Eigen::MatrixXd> llt(H_ + view.I);
    if (llt.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
    return -llt.matrixLLT().diagonal().array().log().sum();
  }

 private:
  Eigen::MatrixXd H_;
};

/// Adds `count` candidates, each the one that leaves the least.
void addBest(const Candidates& candidates, auto criterion, int count,
             std::vector<std::size_t>& used) {
  // The criterion is a copy, begun anew with the views used: their terms are those of this
  // estimate.
  std::vector<char> taken(candidates.size(), 0);
  for (const std::size_t i : used) {
    taken[i] = 1;
    criterion.add(candidates.terms(i));
  }
  for (int added = 0; added < count; ++added) {
    std::optional<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (taken[i] != 0 || candidates.isBad(i) || candidates.terms(i).corners == 0) continue;
      const double value = criterion.valueWith(candidates.terms(i));
      // The first one also where all are infinite: with it they may no longer be.
      if (best && !(value < least)) continue;
      least = value;
      best = i;
    }
    if (!best) return;
    taken[*best] = 1;
    used.push_back(*best);
    criterion.add(candidates.terms(*best));
  }
}

class Online {
 public:
  Online(const ViewPool& pool, const std::vector<int>& frames, const OnlineOrderOptions& options)
      : pool_(pool), frames_(frames), options_(options) {}

  OnlineOrder run(const std::vector<int>& first) {
    for (const int f : first) {
      const auto at = std::ranges::find(frames_, f);
      // From here on frames are positions among the candidates.
      if (at != frames_.end()) used_.push_back(static_cast<std::size_t>(at - frames_.begin()));
    }
    const auto most = std::min(static_cast<std::size_t>(options_.most_views), frames_.size());
    while (used_.size() < most) {
      const std::size_t before = used_.size();
      step(static_cast<int>(most - before));
      if (used_.size() == before) break;  // all that is left is bad
    }
    out_.order = itemsAt(frames_, used_);
    return std::move(out_);
  }

 private:
  void step(int most) {
    const int views = static_cast<int>(used_.size());
    const int count = std::min(most, viewsUntilRefresh(views));
    const auto solution = views > 0 ? pool_.solve(itemsAt(frames_, used_)) : std::nullopt;
    // Too few views, or too much alike: one more is taken blindly.
    if (!solution) return addNext();
    const Candidates candidates(pool_, solution->estimate, frames_);
    if (!candidates.determined()) return addNext();
    const ErrorComponents components = note(candidates);
    if (options_.criterion == ViewCriterion::kPredictedError && views >= kLeastViewsForError) {
      addBest(candidates, PredictedError(candidates.use(), components), count, used_);
    } else {
      // So weak that it only keeps the determinants of the first views finite.
      const Eigen::MatrixXd before = 1e-6 * candidates.use().H;
      addBest(candidates, Information(before), count, used_);
    }
  }

  ErrorComponents note(const Candidates& candidates) {
    std::vector<ViewTerms> terms;
    for (const std::size_t i : used_) {
      // A view that turns out bad once it is used still tells of the parameters (below), but its
      // error would be taken for misfit of all.
      if (!candidates.isBad(i)) terms.push_back(candidates.terms(i));
    }
    const ErrorComponents components = guarded(errorComponents(terms));
    PredictedError error(candidates.use(), components);
    for (const std::size_t i : used_) error.add(candidates.terms(i));
    OnlineStep s;
    s.views = static_cast<int>(used_.size());
    s.components = components;
    s.predicted_px2 = error.value();
    s.excess = relativeExcess(s.predicted_px2, components);
    out_.steps.push_back(s);
    return components;
  }

  /// The next one as they are listed.
  void addNext() {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (std::ranges::find(used_, i) != used_.end()) continue;
      used_.push_back(i);
      return;
    }
  }

  const ViewPool& pool_;
  const std::vector<int>& frames_;
  OnlineOrderOptions options_;
  std::vector<std::size_t> used_;
  OnlineOrder out_;
};

}  // namespace

void OnlineOrderOptions::check() const {
  if (most_views < 1) throw InputError("an order has at least one view");
}

OnlineOrder onlineOrder(const ViewPool& pool, const std::vector<int>& candidates,
                        const std::vector<int>& first, const OnlineOrderOptions& options) {
  options.check();
  return Online(pool, candidates, options).run(first);
}

}  // namespace plumbline

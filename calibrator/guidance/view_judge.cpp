// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/view_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plumbline {
namespace {

ViewErrorOptions errorOptions(const ViewGuideOptions& options) {
  ViewErrorOptions o;
  o.model() = options.model();
  o.min_corners = options.min_corners;
  o.later_use = options.later_use;
  return o;
}

ViewGainOptions gainOptions(const ViewGuideOptions& options) {
  ViewGainOptions o;
  o.model() = options.model();
  o.min_corners = options.min_corners;
  return o;
}

}  // namespace

ViewJudge::ViewJudge(const AprilGrid& target, const ViewGuideOptions& options, int threads)
    : target_(target),
      options_(options),
      threads_(threads),
      errors_(target, errorOptions(options)) {}

void ViewJudge::forget() {
  scorer_.reset();
  errors_ = ViewErrorTracker(target_, errorOptions(options_));
}

void ViewJudge::refresh(const CameraWindow& window, const Eigen::MatrixXd& information) {
  scorer_.emplace(target_, window.estimate(), information, gainOptions(options_));
  if (errors_.isDue()) errors_.refresh(window.estimate(), window.cameras(), threads_);
}

bool ViewJudge::score(const CameraWindow& window, const FrameCorners& corners, Decision& d) {
  const double gain = scorer_->seenGain(corners, *d.T_FC0);
  if (std::isnan(gain)) return false;
  d.mi_nats = gain;
  errors_.see(corners, *d.T_FC0);
  if (errors_.isDue()) errors_.refresh(window.estimate(), window.cameras(), threads_);
  if (!errors_.isKnown()) return true;
  d.error_with_px = std::sqrt(errors_.seenWith(corners, *d.T_FC0));
  if (byError()) {
    d.error_bound_px = std::sqrt((1 - options_.least_lowering) * errors_.predicted());
  }
  return true;
}

bool ViewJudge::isWorthKeeping(const Decision& d) const {
  if (!scorer_->determined() || !d.error_bound_px) return *d.mi_nats >= options_.threshold_nats;
  return *d.error_with_px <= *d.error_bound_px;
}

bool ViewJudge::fits(const CameraEstimate& estimate, const FrameCorners& corners) const {
  return !byError() || errors_.fits(estimate, corners, estimate.T_C0F.back().inverse());
}

bool ViewJudge::isEnough() const {
  return byError() && errors_.components().told_apart &&
         errors_.keptCount() >= std::max(options_.stop_views, options_.min_views) &&
         errors_.excess() <= options_.stop_excess;
}

CandidateRound ViewJudge::scored(const std::vector<CandidateView>& views) const {
  CandidateRound round;
  for (const CandidateView& view : views) {
    round.names.push_back(view.name);
    round.T_FC0.push_back(view.T_FC0);
  }
  round.mi_nats = scorer_->predictedGains(round.T_FC0, threads_);
  if (errors_.isKnown()) {
    round.error_px = errors_.predictedWith(round.T_FC0, threads_);
    for (double& E : round.error_px) E = std::sqrt(E);
  }
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double gain = byError() ? -round.error_px[i] : round.mi_nats[i];
    if (!(gain > most)) continue;  // NaN as well
    most = gain;
    round.best = static_cast<int>(i);
  }
  return round;
}

bool ViewJudge::isWorthAsking(const CandidateRound& round) const {
  const auto best = static_cast<std::size_t>(round.best);
  if (!byError()) return round.mi_nats[best] >= options_.threshold_nats;
  if (errors_.keptCount() < options_.stop_views) return true;
  const double E = round.error_px[best] * round.error_px[best];
  return E <= (1 - options_.least_lowering) * errors_.predicted();
}

void ViewJudge::tell(Decision& d) const {
  if (!errors_.isKnown()) return;
  d.error_px = std::sqrt(errors_.predicted());
  d.excess = errors_.excess();
}

}  // namespace plumbline

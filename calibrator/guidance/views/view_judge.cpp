// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/view_judge.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/information/projection_uncertainty.h"

namespace plumbline {
namespace {

/// Predicted RMS over the image of the difference between projections by the estimate and by the
/// truth, at infinity, a rotation taken out, of the worst camera [px]: by the noise of the window's
/// corners (imageFitCovariance()). Empty before the views determine the cameras.
std::optional<double> predictedProjectionPx(const CameraWindow& window,
                                            const Eigen::MatrixXd& information,
                                            double pixel_sigma) {
  const auto rmse_px = window.rmsePx();
  const Eigen::LLT<Eigen::MatrixXd> llt(information);
  if (!rmse_px || llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd unit =
      llt.solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  // The noise that the residuals have, not the one that was assumed.
  // Half: it is over both axes, pixel_sigma of one.
  const double scale = 0.5 * *rmse_px * *rmse_px / (pixel_sigma * pixel_sigma);
  const CameraLayout layout(window.estimate().intrinsics);
  double worst = 0;
  for (std::size_t c = 0; c < window.estimate().intrinsics.size(); ++c) {
    // A block of the inverse: of one camera's intrinsics, all else marginalised.
    const int k = layout.intrinsics[c], size = layout.intrinsics_size[c];
    const auto square =
        imageFitMeanSquare(window.estimate().intrinsics[c], scale * unit.block(k, k, size, size));
    if (!square) return std::nullopt;
    if (const double px = std::sqrt(*square); isLarger(px, worst)) worst = px;
  }
  return std::isfinite(worst) ? std::optional(worst) : std::nullopt;
}

}  // namespace

ViewJudge::ViewJudge(const AprilGrid& target, const ViewGuideOptions& options, int threads)
    : target_(target), options_(options), threads_(threads), errors_(target, options) {}

void ViewJudge::forget() {
  projection_px_.reset();
  scorer_.reset();
  errors_ = ViewErrorTracker(target_, options_);
  reached_.clear();
}

void ViewJudge::refresh(const CameraWindow& window, const Eigen::MatrixXd& information) {
  cameras_ = static_cast<int>(window.cameras().size());
  // With every change of the window: its gains stand on this very information.
  scorer_.emplace(target_, window.estimate(), information, options_);
  if (errors_.isDue()) errors_.refresh(window.estimate(), window.cameras(), threads_);
  if (options_.stop_projection_px > 0) {
    projection_px_ = predictedProjectionPx(window, information, options_.pixel_sigma);
  }
}

bool ViewJudge::score(const CameraWindow& window, const FrameCorners& corners, Decision& d) {
  const double gain = scorer_->seenGain(corners, *d.T_FC0);
  if (std::isnan(gain)) return false;
  d.mi_nats = gain;
  errors_.see(corners, *d.T_FC0);
  // Seen before it is judged: where the frame's corners are is a place of later use, kept or not.
  if (errors_.isDue()) errors_.refresh(window.estimate(), window.cameras(), threads_);
  if (!errors_.isKnown()) return true;
  d.error_with_px = std::sqrt(errors_.seenWith(corners, *d.T_FC0));
  if (byError()) {
    // The share is one of E, squared; decisions state roots.
    d.error_bound_px = std::sqrt((1 - options_.least_lowering) * errors_.predicted());
  }
  return true;
}

bool ViewJudge::isWorthKeeping(const Decision& d) const {
  // Until the cameras are determined any view gains without bound, and is kept.
  if (!scorer_->determined() || !d.error_bound_px) return *d.mi_nats >= options_.threshold_nats;
  return *d.error_with_px <= *d.error_bound_px;
}

bool ViewJudge::fits(const CameraEstimate& estimate, const FrameCorners& corners) const {
  return !byError() || errors_.fits(estimate, corners, estimate.T_C0F.back().inverse());
}

bool ViewJudge::isEnough() const {
  // Asked for in pixels, neither gains nor predicted errors end the stage.
  if (options_.stop_projection_px > 0) {
    return hasLeastViews() && projection_px_ && *projection_px_ <= options_.stop_projection_px;
  }
  return meetsExcess() && coversImages();
}

bool ViewJudge::hasLeastViews() const {
  return errors_.keptCount() >= std::max(options_.stop_views, options_.min_views);
}

bool ViewJudge::meetsExcess() const {
  // Before the views tell b from tau, E stands on an even split of the misfit that is merely
  // assumed.
  return !(options_.stop_projection_px > 0) && hasLeastViews() && byError() && tellsMisfitApart() &&
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
  // The lowest error, or the highest gain.
  std::vector<double> scores = round.mi_nats;
  if (byError()) {
    for (std::size_t i = 0; i < scores.size(); ++i) scores[i] = -round.error_px[i];
  }
  std::vector<double> unreached = scores;
  for (std::size_t i = 0; i < unreached.size(); ++i) {
    if (reached_.contains(round.names[i])) unreached[i] = std::numeric_limits<double>::quiet_NaN();
  }
  round.best = bestCandidate(unreached);
  if (round.best < 0) round.best = bestCandidate(scores);
  return round;
}

bool ViewJudge::isWorthAsking(const CandidateRound& round, std::size_t i) const {
  // The goal is in pixels: as long as it is not reached no gain is too small to ask for.
  if (options_.stop_projection_px > 0) return !std::isnan(round.mi_nats[i]);
  const bool reached = reached_.contains(round.names[i]);
  if (!byError()) return !reached && round.mi_nats[i] >= options_.threshold_nats;
  if (std::isnan(round.error_px[i])) return false;
  // Where little of the images has been seen, later use hardly asks for the rest.
  if (mayMissMisfit() || !coversImages()) return true;
  const double E = round.error_px[i] * round.error_px[i];
  return !reached && E <= (1 - options_.least_lowering) * errors_.predicted();
}

std::vector<double> ViewJudge::worthwhileGains(const CandidateRound& round) const {
  std::vector<double> gains;
  for (std::size_t i = 0; i < round.names.size(); ++i) {
    // Logarithms of ratios, as gains in nats are: both add up over views.
    const double gain =
        byError() ? std::log(std::sqrt(errors_.predicted()) / round.error_px[i]) : round.mi_nats[i];
    const bool asks = isWorthAsking(round, i) && !reached_.contains(round.names[i]);
    gains.push_back(asks ? gain : std::numeric_limits<double>::quiet_NaN());
  }
  return gains;
}

bool ViewJudge::seesTarget(const Transform& T_FC0) const {
  for (int c = 0; c < cameras_; ++c) {
    const auto corners = static_cast<int>(predictedCorners(c, T_FC0).size());
    if (corners >= options_.min_corners) return true;
  }
  return false;
}

void ViewJudge::tell(Decision& d) const {
  d.projection_px = projection_px_;
  if (!errors_.isKnown()) return;
  d.error_px = std::sqrt(errors_.predicted());
  d.excess = errors_.excess();
}

}  // namespace plumbline

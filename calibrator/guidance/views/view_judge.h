// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "calibrator/guidance/views/candidate_views.h"
#include "calibrator/guidance/views/view_error.h"
#include "calibrator/guidance/views/view_gain.h"
#include "calibrator/window/camera_window.h"

namespace plumbline {

/// Which views the camera stage keeps and asks for, and when it has enough: by the criterion of
/// ViewGuideOptions. Mutual information (ViewScorer) and predicted error (ViewErrorTracker) are
/// both worked out, so that a decision holds either, whichever decides.
class ViewJudge {
 public:
  ViewJudge(const AprilGrid& target, const ViewGuideOptions& options, int threads);

  /// As if no frame had been seen.
  void forget();
  /// A frame with a plausible pose; a view that entered the window.
  void see(const FrameCorners& corners, const Transform& T_FC0) { errors_.see(corners, T_FC0); }
  void keep(const FrameCorners& corners, const Transform& T_FC0) {
    errors_.keep(corners, T_FC0);
    reached_.clear();
  }
  /// The operator was at a candidate. Until a view is kept it gains what the frames there gained,
  /// however much is predicted of it: it is not asked for again.
  void reached(const std::string& candidate) { reached_.insert(candidate); }
  /// After every change of the window; `information`: its own.
  void refresh(const CameraWindow& window, const Eigen::MatrixXd& information);

  /// Sees a frame at d.T_FC0 and writes its scores; false where its corners leave the pose free.
  bool score(const CameraWindow& window, const FrameCorners& corners, Decision& d);
  /// Of a frame that was scored. Before the views kept determine the cameras, any view is.
  bool isWorthKeeping(const Decision& d) const;
  /// By predicted error, whether the last frame of an estimate, that took part in it, fits there.
  bool fits(const CameraEstimate& estimate, const FrameCorners& corners) const;
  /// Whether the views kept tell the misfit that all share from each one's own (ErrorComponents).
  bool tellsMisfitApart() const { return errors_.components().told_apart; }
  /// The stopping rule in pixels: of predicted error, or `stop_projection_px`.
  bool isEnough() const;
  /// Whether the predicted error would be enough if frames seen covered the images.
  bool lacksCoverage() const { return meetsExcess() && !coversImages(); }
  double coverage() const { return errors_.coverage(); }

  /// Scores candidates at the estimate of the last refresh(). The best is one that was not reached,
  /// as long as there is one.
  CandidateRound scored(const std::vector<CandidateView>& views) const;
  /// Whether a candidate of a round would be kept.
  bool isWorthAsking(const CandidateRound& round, std::size_t candidate) const;
  /// What each candidate that is worth asking gains [nats]: information, or the logarithm of what
  /// the predicted error is divided by; NaN: not worth it.
  std::vector<double> worthwhileGains(const CandidateRound& round) const;
  /// Whether some camera sees enough of the target there.
  bool seesTarget(const Transform& T_FC0) const;
  std::vector<Corner> predictedCorners(int camera, const Transform& T_FC0) const {
    return scorer_->predictedCorners(camera, T_FC0);
  }
  /// Writes what holds after a frame.
  void tell(Decision& d) const;

 private:
  bool byError() const {
    return options_.criterion == ViewCriterion::kPredictedError && errors_.isKnown();
  }
  bool hasLeastViews() const;
  bool meetsExcess() const;
  bool coversImages() const { return errors_.coverage() >= kLeastCoverage; }

  /// Whether the views kept may miss parts of the misfit, so that too little is predicted to gain.
  bool mayMissMisfit() const {
    return errors_.keptCount() < options_.stop_views || !tellsMisfitApart();
  }

  AprilGrid target_;
  ViewGuideOptions options_;
  int threads_;
  int cameras_ = 0;
  std::optional<double> projection_px_;
  std::optional<ViewScorer> scorer_;
  ViewErrorTracker errors_;
  std::set<std::string> reached_;  // candidates, since the last view that was kept
};

}  // namespace plumbline

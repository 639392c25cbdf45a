// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "calibrator/base/guide_decision.h"
#include "calibrator/guidance/trajectory_gain.h"

namespace plumbline {

/// When scores are asked for and when they are there, in the recording's time.
struct EvaluatorTiming {
  double every_s = 1;    ///< from one start to the next
  double latency_s = 0;  ///< from the frame whose estimate is scored to the answer
  int threads = 1;       ///< 2 or more: scores are computed beside the frames that follow
};

/// Scores all trajectories on snapshots of the estimate. What comes out, and when, depends on the
/// frames' stamps alone.
class TrajectoryEvaluator {
 public:
  TrajectoryEvaluator(TrajectoryScorer scorer, const EvaluatorTiming& timing);

  const std::vector<LissajousTrajectory>& trajectories() const { return scorer_->trajectories(); }
  /// Whether a new evaluation should start with the frame at `t`: the last one was answered, and it
  /// was asked for long enough ago.
  bool isDue(TimeNs t) const;
  void ask(TimeNs t, WindowKnowledge now);
  /// The scores, once, with the first frame at or after their time.
  std::optional<CandidateRound> answerAt(TimeNs t);

 private:
  std::shared_ptr<const TrajectoryScorer> scorer_;
  EvaluatorTiming timing_;
  std::optional<TimeNs> asked_;  // the last one
  std::future<std::vector<double>> gains_;
};

}  // namespace plumbline

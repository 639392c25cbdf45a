// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/trajectory_evaluator.h"

#include <cassert>
#include <cmath>
#include <utility>

namespace plumbline {
namespace {

/// Index of the highest score that is one; -1 where none is.
int bestOf(const std::vector<double>& gains) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(gains.size()); ++i) {
    const double gain = gains[static_cast<std::size_t>(i)];
    if (std::isnan(gain)) continue;
    if (best < 0 || gain > gains[static_cast<std::size_t>(best)]) best = i;
  }
  return best;
}

}  // namespace

TrajectoryEvaluator::TrajectoryEvaluator(TrajectoryScorer scorer, const EvaluatorTiming& timing)
    : scorer_(std::make_shared<TrajectoryScorer>(std::move(scorer))), timing_(timing) {}

bool TrajectoryEvaluator::isDue(TimeNs t) const {
  if (gains_.valid()) return false;
  return !asked_ || t >= *asked_ + toNanoseconds(timing_.every_s);
}

void TrajectoryEvaluator::ask(TimeNs t, WindowKnowledge now) {
  assert(isDue(t));
  asked_ = t;
  const bool beside = timing_.threads > 1 && timing_.latency_s > 0;
  gains_ = std::async(beside ? std::launch::async : std::launch::deferred,
                      [scorer = scorer_, now = std::move(now), threads = timing_.threads] {
                        return scorer->gainsNats(now, threads);
                      });
}

std::optional<CandidateRound> TrajectoryEvaluator::answerAt(TimeNs t) {
  if (!gains_.valid()) return std::nullopt;
  const TimeNs answered = *asked_ + toNanoseconds(timing_.latency_s);
  if (t < answered) return std::nullopt;
  CandidateRound round;
  round.asked = *asked_;
  round.answered = answered;
  for (const LissajousTrajectory& trajectory : trajectories()) {
    round.names.push_back(trajectory.name());
    round.T_FC0.push_back(trajectory.cameraAt(0).T_FB);
  }
  round.mi_nats = gains_.get();
  round.best = bestOf(round.mi_nats);
  return round;
}

}  // namespace plumbline

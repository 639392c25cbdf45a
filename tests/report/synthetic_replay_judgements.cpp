// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "tests/report/synthetic_replay_parts.h"

namespace plumbline::test {
namespace {

StageSummary batch(int views, double entropy) {
  StageSummary s;
  s.views_used = views;
  s.corners_used = static_cast<std::size_t>(views) * 139;
  s.reprojection.rmse_px = 0.2 + 1e-4 * views;
  s.entropy_nats = entropy;
  s.converged = true;
  return s;
}

ReplayStageSummary stage(const ReplayRecord& record, GuideStage which) {
  ReplayStageSummary s;
  s.stage = which;
  s.ran = true;
  for (const Decision& d : record.decisions) {
    if (d.stage != which) continue;
    if (!s.started) s.started = d.t;
    if (d.mode == GuideMode::kFinished && !s.finished) s.finished = d.t;
    ++s.frames_offered;
    s.frames_dropped += d.reason == GuideReason::kBusy ? 1 : 0;
    s.views_used += (d.accepted ? 1 : 0) - static_cast<int>(d.withdrawn.size());
    s.suggestions += d.event == SuggestionEvent::kOpened ? 1 : 0;
    s.reached += d.event == SuggestionEvent::kReached ? 1 : 0;
  }
  s.views_redundant = 7;
  s.views_missed = 11;
  s.kept_batch = batch(s.views_used, -40.5);
  s.full_batch = batch(s.frames_offered, -47.25);
  s.information_after_finish_nats = 1.25;
  return s;
}

std::optional<Quartiles> around(double value, int seeds, double width) {
  if (seeds < 2) return Quartiles{value, value, value};
  return Quartiles{value - width, value, value + width};
}

CounterfactualBand band(const std::string& strategy, int seeds, double speed) {
  CounterfactualBand b;
  b.strategy = strategy;
  b.seeds = seeds;
  for (int k = 2; k <= 80; k += 2) {
    b.views.push_back(k);
    const bool known = k > 4;
    b.entropy_nats.push_back(known ? around(-10 - speed * 6 * std::log(k), seeds, 1.5)
                                   : std::nullopt);
    b.held_out_px.push_back(known ? around(0.25 + 2 / (speed * k * k), seeds, 0.3 / k)
                                  : std::nullopt);
    b.regret_px.push_back(known ? std::optional(0.3 / k) : std::nullopt);
  }
  b.views_needed = around(std::round(20 / speed), seeds, 3);
  return b;
}

Counterfactuals counterfactuals() {
  Counterfactuals c;
  c.pool_frames = 80;
  c.held_out_frames = 40;
  c.full_pool_entropy_nats = -38.5;
  c.full_pool_held_out_px = 0.2508;
  c.bands = {band("recorded", 1, 0.8),        band("random", 20, 1),    band("greedy-mi", 1, 1.6),
             band("predicted-error", 1, 1.8), band("coverage", 1, 1.3), band("guide", 1, 1.2)};
  c.other_model = "pinhole-equidistant";
  c.other_model_bands = {band("greedy-mi", 1, 1.7), band("random", 20, 1.05)};
  c.remarks = {"greedy-mi needs 13 views where random needs 20 in the median.",
               "greedy-mi loses to random from 40 views on: <edge> & centre."};
  return c;
}

}  // namespace

void addJudgements(ReplayRecord& record) {
  record.stages = {stage(record, GuideStage::kCamera), stage(record, GuideStage::kCameraImu)};
  record.stages[1].problem = "the IMU begins 0.3 s after the cameras: 6 frames without it";
  OperatorCompliance compliance;
  for (const SuggestionOutcome& o : record.suggestions) {
    if (compliance.suggestions.size() < 3) compliance.suggestions.push_back(o);
  }
  compliance.reached = 2;
  compliance.median_seconds_to_reach = 4.25;
  record.compliance = compliance;
  const auto early = StopAudit::Verdict::kEarly;
  record.stop_audits = {{GuideStage::kCamera, StopAudit::Verdict::kLate, record.stages[0].finished,
                         std::nullopt, record.frames[record.frames.size() / 3].t, true, 3.5, 6.25,
                         0.018, 0.015, 0.021, std::nullopt, std::nullopt, std::nullopt, -40.5,
                         -47.25, "good enough at 31 views, finish came at 44"},
                        {GuideStage::kCameraImu, early, record.stages[1].finished, std::nullopt,
                         std::nullopt, false, 1.5, 0.5, std::nullopt, std::nullopt, std::nullopt,
                         0.12, 0.2, 0.05, -20, -22, "8 % worse than the batch over all"}};
  record.counterfactuals = counterfactuals();
  record.verdict =
      makeVerdict({{"Finish of the camera stage", VerdictLevel::kCaution, "3.5 s late",
                    "raise the threshold", 3.5, 2, "s"},
                   {"Suggestions reached", VerdictLevel::kGood, "3 of 5", "", 0.6, 0.5, "share"}});
}

}  // namespace plumbline::test

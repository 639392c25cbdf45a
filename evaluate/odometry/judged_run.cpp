// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/judged_run.h"

#include <algorithm>

#include <fmt/format.h>

#include "evaluate/odometry/runner.h"

namespace plumbline {
namespace {

constexpr TimeNs kTruthMargin = 25'000'000;  // [ns]: half a frame at 20 Hz

std::optional<std::string> truthOf(const OdometryRequest& request,
                                   const OdometrySequence& sequence) {
  if (request.truth) return filledIn(*request.truth, {{"sequence", sequence.name}});
  if (sequence.truth) return sequence.truth->string();
  return std::nullopt;
}

}  // namespace

std::optional<SequenceTruth> readTruthOf(const OdometryRequest& request,
                                         const OdometrySequence& sequence) {
  const auto path = truthOf(request, sequence);
  if (!path) return std::nullopt;
  TrajectoryRequest how = request.how;
  how.truth = *path;
  SequenceTruth truth{how.truth, readTruth(how)};
  // Nothing is cut where the offset of the clocks is yet to be found.
  if (how.metrics.clock) return truth;
  // From the clock of the images to that of the truth.
  const TimeNs offset = toNanoseconds(how.metrics.association.time_offset_s);
  const TimeNs from = sequence.images[0].front().t + offset - kTruthMargin;
  const TimeNs to = sequence.images[0].back().t + offset + kTruthMargin;
  const std::vector<StampedPose>& all = truth.file.trajectory.poses;
  const auto meets = [&](const StampedPose& p) { return p.t >= from && p.t <= to; };
  if (std::none_of(all.begin(), all.end(), meets)) return truth;  // who pairs them says why
  std::erase_if(truth.file.trajectory.poses, [&](const StampedPose& p) { return !meets(p); });
  // They were parallel to the poses; an estimate is judged by its own.
  truth.file.trajectory.covariances.clear();
  return truth;
}

TrajectoryRun judgedByTruth(const TrajectoryRun& run, const SequenceTruth& truth,
                            const OdometryRequest& request) {
  RunsRequest rules;
  rules.how = request.how;
  rules.min_coverage = request.min_coverage;
  rules.max_ate_m = request.max_ate_m;
  return judgedRun(run, truth.path, truth.file, rules);
}

TrajectoryRun judgedWithoutTruth(TrajectoryRun run, const OdometrySequence& sequence,
                                 const std::vector<StampedPose>& poses, double min_coverage) {
  // From the first pose to the last, holes included, unlike coverageOf() under a truth.
  const double recorded = sequence.duration_s();
  const double covered = poses.empty() ? 0 : secondsBetween(poses.front().t, poses.back().t);
  run.coverage = recorded > 0 ? std::min(1.0, covered / recorded) : 0;
  run.starts_late_s =
      poses.empty() ? 0 : secondsBetween(sequence.images[0].front().t, poses.front().t);
  run.remarks.emplace_back(
      "has no ground truth, so there is no trajectory error: the odometry's self-consistency shows "
      "calibrations that do not fit the recording, but does not rank two that fit");
  if (run.coverage >= min_coverage) return run;
  run.status = RunStatus::kPartial;
  run.problem = coverageText(run.coverage, min_coverage, "the images'");
  return run;
}

}  // namespace plumbline

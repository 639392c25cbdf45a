// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/judged_run.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "evaluate/results/text.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr TimeNs kTruthMargin = 25'000'000;  // [ns]: half a frame at 20 Hz

std::optional<std::string> truthOf(const OdometryRequest& request,
                                   const OdometrySequence& sequence) {
  if (request.truth) return filledIn(*request.truth, {{"sequence", sequence.name}});
  if (sequence.truth) return sequence.truth->string();
  return std::nullopt;
}

/// How far the last pose is from the first, which does not depend on the world.
void addClosure(const std::vector<StampedPose>& poses, OdometryRunRecord& r) {
  if (poses.size() < 2) return;
  r.closure_m = (poses.back().p - poses.front().p).norm();
  r.closure_deg = poses.front().q.angularDistance(poses.back().q) * 180 / std::numbers::pi;
}

/// Of the first `cameras` cameras (0: all), those that an odometry of one time offset does not use
/// as calibrated.
void addOwnOffsets(const Calibration& calibration, int cameras, std::vector<std::string>& remarks) {
  const ImuCalibration& imu = *calibration.imu;
  for (std::size_t c = 1; c < calibration.cameras.size(); ++c) {
    if (cameras > 0 && c >= static_cast<std::size_t>(cameras)) break;
    if (!hasOwnOffset(imu.time_offsets, c)) continue;
    remarks.push_back(fmt::format(
        "the calibration's time offset of {} is {:.6f} s more than that of {}; this odometry takes "
        "all cameras as exposed together",
        calibration.cameras[c].name, imu.timeOffset(c) - imu.timeOffset(),
        calibration.cameras[0].name));
  }
}

/// Whether it is told a time offset, or its stamps are moved by one: else it reads the
/// calibration's file itself.
bool needsOffset(const Runner& runner) {
  return runner.settings || runner.imu_clock || runner.needs_shifted_imu;
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

TrajectoryRun judgedPlan(const OdometryPlan& plan, const OdometryOutcome& outcome,
                         const OdometryRequest& request, const std::optional<SequenceTruth>& truth,
                         const fs::path& out) {
  TrajectoryRun run;
  run.sequence = plan.sequence->name;
  run.calibration = plan.calibration->name;
  run.run = std::to_string(plan.run);
  run.estimate = (out / pathOf(plan)).string();
  // By the file that was written, as anybody else would judge it.
  if (fs::is_regular_file(run.estimate)) {
    run = truth ? judgedByTruth(run, *truth, request)
                : judgedWithoutTruth(run, *plan.sequence, outcome.poses, request.min_coverage);
    run.problem = replaceAll(run.problem, out.string() + "/", "");  // which is renamed in the end
  }
  run.without_truth = !truth;
  run.estimate = pathOf(plan);
  run.truth = truth ? truth->path.string() : "";
  run.odometry = outcome.record;
  addClosure(outcome.poses, *run.odometry);
  const double recorded = plan.sequence->duration_s();
  run.odometry->real_time_factor =
      outcome.record.seconds > 0 ? recorded / outcome.record.seconds : 0;
  run.remarks.insert(run.remarks.end(), outcome.remarks.begin(), outcome.remarks.end());
  // Kalibr's files alone have an offset for each camera.
  if (!request.runner ||
      (request.runner->settings && *request.runner->settings != ExportTool::kKalibr)) {
    addOwnOffsets(plan.calibration->calibration, request.runner ? 0 : request.builtin.cameras,
                  run.remarks);
  }
  if (!plan.calibration->offset_known && (!request.runner || needsOffset(*request.runner))) {
    run.remarks.emplace_back(
        "the calibration states no time offset between camera and IMU: 0 was used, and it may be "
        "any; estimate it");
  }
  // Last, since an estimate that is accurate does not excuse a run that was lost.
  return outcome.problem.empty() ? run : failedRun(std::move(run), outcome.problem);
}

}  // namespace plumbline

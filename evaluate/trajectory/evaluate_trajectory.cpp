// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/evaluate_trajectory.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/errors.h"
#include "evaluate/metrics/trajectory/mismatch.h"
#include "evaluate/metrics/trajectory/quaternion_order.h"
#include "evaluate/trajectory/remarks.h"

namespace plumbline {
namespace {

// What a fit needs (align()), asked of every alignment: no figure stands on a pose or two.
constexpr std::size_t kFewestPairs = 3;
constexpr std::size_t kPlotted = 2000;
constexpr int kGapFactor = 10;  // an interval so many times the median one is a hole

/// Alignments by the first pair's rotations; the fits use positions alone.
bool standsOnRotation(AlignmentKind kind) {
  return kind == AlignmentKind::kOrigin || kind == AlignmentKind::kSe3First ||
         kind == AlignmentKind::kYawFirst;
}

/// Share of the truth's span, from `from` on, within the estimate's intervals, holes left out. A
/// hole is one by the estimate's own median interval, so that one of keyframes has none.
double coverageOf(const std::vector<StampedPose>& estimate, const Trajectory& truth, TimeNs offset,
                  TimeNs from) {
  const TimeNs to = truth.poses.back().t;
  if (estimate.size() < 2 || to <= from) return 0;
  std::vector<TimeNs> intervals;
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    intervals.push_back(estimate[i].t - estimate[i - 1].t);
  }
  const TimeNs hole = kGapFactor * middleOf(std::move(intervals));
  TimeNs covered = 0;
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    const TimeNs a = std::max(from, estimate[i - 1].t + offset);
    const TimeNs b = std::min(to, estimate[i].t + offset);
    if (b > a && estimate[i].t - estimate[i - 1].t <= hole) covered += b - a;
  }
  return static_cast<double>(covered) / static_cast<double>(to - from);
}

// `run` with what it covers of the truth; both have poses.
TrajectoryRun withCoverage(TrajectoryRun run, const Trajectory& estimate, const Trajectory& truth,
                           const TrajectoryMetricOptions& options) {
  const TimeNs offset = toNanoseconds(options.association.time_offset_s);
  const TimeNs start = truth.poses.front().t, first = estimate.poses.front().t + offset;
  const bool whole = options.coverage == CoverageSpan::kTruth;
  // Both shares, so that a partial run can say whether its late start alone is to blame.
  run.coverage_from_first_pose = coverageOf(estimate.poses, truth, offset, std::max(start, first));
  run.coverage =
      whole ? coverageOf(estimate.poses, truth, offset, start) : run.coverage_from_first_pose;
  run.starts_late_s = secondsBetween(start, first);
  return run;
}

// `run` with every k-th pair, for plots.
TrajectoryRun withPlots(TrajectoryRun run, const std::vector<PosePair>& pairs,
                        const AlignedPoses& poses, const std::vector<double>& error_deg) {
  // At most kPlotted of them; the figures are of all.
  const std::size_t step = (pairs.size() + kPlotted - 1) / kPlotted;
  // Angles of all pairs, before they are thinned: each is chosen by the one before it.
  std::vector<Eigen::Vector3d> truth_rpy, estimate_rpy;
  if (!error_deg.empty()) {
    truth_rpy = rollPitchYaw(poses.truth);
    estimate_rpy = rollPitchYaw(poses, truth_rpy);
  }
  for (std::size_t i = 0; i < pairs.size(); i += step) {
    run.t.push_back(pairs[i].truth.t);
    run.truth_m.push_back(poses.truth[i].t);
    run.estimate_m.push_back(poses.estimate[i].t);
    run.error_m.push_back((poses.estimate[i].t - poses.truth[i].t).norm());
    if (error_deg.empty()) continue;
    run.error_deg.push_back(error_deg[i]);
    run.truth_rpy_deg.push_back(truth_rpy[i]);
    run.estimate_rpy_deg.push_back(estimate_rpy[i]);
  }
  return run;
}

// `run` with the errors of its pairs, which are matched and aligned.
TrajectoryRun measured(TrajectoryRun run, const std::vector<PosePair>& pairs,
                       const std::vector<RelativeDelta>& rpe, bool with_rotation) {
  const AlignedPoses poses = alignedPoses(pairs, run.alignment);
  run.ate_translation_m = sampleStatistics(absoluteErrors(poses, AbsoluteMeasure::kTranslation));
  std::vector<double> error_deg;
  if (with_rotation) error_deg = absoluteErrors(poses, AbsoluteMeasure::kRotationDeg);
  run.ate_rotation_deg = sampleStatistics(error_deg);
  std::vector<TimeNs> t;
  for (const PosePair& pair : pairs) t.push_back(pair.truth.t);
  // Without orientations the frame of a relative motion is unknown.
  if (with_rotation) {
    for (const RelativeDelta& delta : rpe) run.rpe.push_back(relativeErrorOver(delta, poses, t));
  }
  return withPlots(std::move(run), pairs, poses, error_deg);
}

/// An alignment by the first pose's rotation hides what the rotations of the bodies differ by: it
/// is looked for after one by positions, and the positions are as wrong as the rotation is.
RotationRemark rotationRemark(const std::vector<PosePair>& pairs, const AlignmentRecord& used,
                              const AlignmentOptions& options) {
  if (!standsOnRotation(options.kind)) return remarkOnRotations(pairs, used, options.kind);
  AlignmentOptions by_positions = options;
  by_positions.kind = AlignmentKind::kSe3;
  const Result<AlignmentRecord> alignment = align(pairs, by_positions);
  if (!alignment) return {};
  RotationRemark remark = remarkOnRotations(pairs, *alignment, options.kind);
  if (remark.of_alignment) return {};  // of the one that is looked at here alone
  // Only a cause with a cure is believed; rotations that differ for no known reason are those of a
  // bad estimate.
  if (!remark.cure.empty()) {
    remark.text += "; the alignment by the first pose turns the positions as wrongly";
  }
  return remark;
}

// `run` without the figures that need the rotations of both, or those of the alignment.
TrajectoryRun withoutRotations(TrajectoryRun run, const RotationRemark& why) {
  run.left_out = why.text + (why.of_alignment
                                 ? "; rotation errors and NEES are not reported"
                                 : "; rotation errors, relative errors and NEES are not reported");
  run.cure = why.cure;
  run.ate_rotation_deg = {};
  if (!why.of_alignment) run.rpe.clear();
  run.error_deg.clear();
  run.truth_rpy_deg.clear();
  run.estimate_rpy_deg.clear();
  return run;
}

/// Frames that stand in for stamps are no clock: their times lie elsewhere for this reason alone.
bool hasNoStamps(const TrajectoryFile& file, const TrajectoryReadOptions& read) {
  return file.format == TrajectoryFormat::kKitti && read.times.empty();
}

Failure named(Failure failure, const TrajectoryFile& estimate, const TrajectoryFile& truth,
              const TrajectoryRequest& request) {
  if (failure.code == FailureCode::kNoCommonTime) {
    if (hasNoStamps(truth, request.read_truth)) failure.values.emplace("unstamped", "truth");
    if (hasNoStamps(estimate, request.read_estimate)) {
      failure.values.insert_or_assign("unstamped", "estimate");
    }
  }
  failure.where = fmt::format("{} against {}", request.estimate.string(), request.truth.string());
  return failure;
}

std::vector<std::string> remarksOf(const std::filesystem::path& path, const TrajectoryFile& file) {
  std::vector<std::string> remarks;
  for (const std::string& remark : file.remarks) {
    remarks.push_back(fmt::format("{}: {}", path.filename().string(), remark));
  }
  return remarks;
}

// `first` stands before what is remarked already.
void prepend(std::vector<std::string> first, TrajectoryRun& run) {
  append(first, run.remarks);
  run.remarks = std::move(first);
}

void remarkOnErrors(bool with_rotation, std::size_t deltas, TrajectoryRun& run) {
  if (!with_rotation) {
    run.remarks.push_back(
        fmt::format("there are no orientations: no rotation errors{}",
                    deltas > 0 ? ", and no relative ones, which need the body's frame" : ""));
  }
  for (const RelativeErrorRecord& rpe : run.rpe) {
    if (rpe.translation_m.n > 0) continue;
    run.remarks.push_back(fmt::format(
        "no poses are {} {} apart: no relative error over that distance", rpe.delta, rpe.unit));
  }
}

// `run` with the NEES of the pairs, whose covariances are the estimate's.
TrajectoryRun withNees(TrajectoryRun run, const Trajectory& estimate,
                       const Association& association, const AlignedPoses& poses) {
  const AlignmentRecord& alignment = run.alignment;
  std::vector<Matrix6d> covariances;
  covariances.reserve(association.estimate_index.size());
  for (const std::size_t i : association.estimate_index) {
    covariances.push_back(alignedCovariance(estimate.covariances[i], alignment));
  }
  const Nees nees = neesOf(poses, covariances);
  run.nees = nees.parts;
  if (nees.left_out > 0) {
    run.remarks.push_back(
        fmt::format("{} covariances are not positive definite: excluded from NEES", nees.left_out));
  }
  if (nees.used > 0 && isFit(alignment)) {
    run.remarks.push_back(
        fmt::format("NEES after alignment {}: the fit removes error that the covariances, which "
                    "grow from the start, include; use yaw-first or se3-first",
                    alignment.kind));
  }
  return run;
}

// The offset that the positions ask for, where none was estimated from angular rates, which know
// better. `truth` as it was read: a hand-eye transform takes up part of what the clocks are off by.
std::optional<ClockMismatch> clockMismatchOf(const TrajectoryRun& run, const Trajectory& estimate,
                                             const Trajectory& truth,
                                             const TrajectoryMetricOptions& options) {
  if (options.clock) return std::nullopt;
  ClockTrialOptions trial;
  trial.time_offset_s = options.association.time_offset_s;
  trial.max_gap_s = options.association.max_gap_s;
  const bool scaled = scaleIsUnknown(options.alignment.kind) || run.scale_mismatch;
  if (scaled) trial.alignment = AlignmentKind::kSim3;
  return clockMismatch(estimate, truth, trial);
}

// With clock and bodies in common.
Result<TrajectoryRun> evaluated(const Trajectory& estimate, const Trajectory& truth,
                                const TrajectoryMetricOptions& options) {
  const bool with_rotation = estimate.has_orientation && truth.has_orientation;
  const Association association = associate(estimate, truth, options.association);
  if (association.pairs.size() < kFewestPairs) {
    return explainTooFewPairs(estimate, truth, association, options.association);
  }
  if (with_rotation) {
    // Before the alignment, which may stand on the rotations of the first pair.
    if (const auto fault = explainQuaternionOrder(association.pairs)) return *fault;
  }
  const Result<AlignmentRecord> alignment = align(association.pairs, options.alignment);
  if (!alignment) return alignment.failure();
  TrajectoryRun run;
  run.association = association.record;
  run.alignment = *alignment;
  run = withCoverage(std::move(run), estimate, truth, options);
  run = measured(std::move(run), association.pairs, options.rpe, with_rotation);
  if (!scaleIsUnknown(options.alignment.kind)) {
    run.scale_mismatch = scaleMismatch(association.pairs);
  }
  run.remarks = remarksOn(association, estimate, truth, options.clock.has_value());
  if (std::string reading = remarkOnReading(association.pairs, with_rotation); !reading.empty()) {
    run.remarks.push_back(std::move(reading));
  }
  remarkOnErrors(with_rotation, options.rpe.size(), run);
  if (!with_rotation) return run;
  const RotationRemark rotations = rotationRemark(association.pairs, *alignment, options.alignment);
  // The bodies differ, or one side is inverted: figures of rotations would be of that and not of
  // errors.
  if (!rotations.cure.empty()) return withoutRotations(std::move(run), rotations);
  if (!rotations.text.empty()) run.remarks.push_back(rotations.text);
  if (estimate.covariances.empty()) return run;
  return withNees(std::move(run), estimate, association,
                  alignedPoses(association.pairs, *alignment));
}

// Bodies that differ by a lever arm hide a clock from clockMismatch(), and a hand-eye transform
// that was estimated by late stamps takes up part of them: with the offset that the angular rates
// ask for, and another transform, positions agree far better where the clocks are off.
std::optional<ClockMismatch> clockMismatchUnderHandEye(const TrajectoryRun& run,
                                                       const Trajectory& estimate,
                                                       const Trajectory& truth,
                                                       TrajectoryMetricOptions options) {
  const double given = options.association.time_offset_s;
  options.clock = ClockOffsetOptions();
  options.clock->max_offset_s = kRatesRange;
  options.rpe.clear();
  const Result<CommonFrames> frames = commonFrames(estimate, truth, options);
  if (!frames) return std::nullopt;
  const double offset = frames->time_offset_s - given;
  if (std::abs(offset) < kLeastOffset) return std::nullopt;
  options.association.time_offset_s = frames->time_offset_s;
  const Result<TrajectoryRun> moved = evaluated(estimate, *frames->truth_S, options);
  // Not by a few poses at the ends that still have a partner.
  if (!moved || 2 * moved->association.matches < run.association.matches) return std::nullopt;
  const double before = run.ate_translation_m.rmse, after = moved->ate_translation_m.rmse;
  if (!(after <= kFarBetter * before)) return std::nullopt;
  return ClockMismatch{given,  offset, offset, run.alignment.kind + " and hand-eye anew",
                       before, after};
}

// A file whose w may stand first, as its reader took it to stand last, and whose quaternions may
// map the world into the body; its positions are in the world.
TrajectoryFile readAs(const std::filesystem::path& path, TrajectoryReadOptions options,
                      bool w_first, bool inverted) {
  options.order_is_stated = w_first;
  TrajectoryFile file = readTrajectory(path, options);
  // The other formats have one order, or name it.
  if (w_first && (file.format != TrajectoryFormat::kTum || !file.trajectory.has_orientation)) {
    throw InputError(path.string(), 0,
                     "is not a TUM file with quaternions; --truth-w-first and --estimate-w-first "
                     "apply to TUM files only; omit the option");
  }
  if (inverted && !file.trajectory.has_orientation) {
    throw InputError(path.string(), 0, "has no quaternions to invert; omit the option");
  }
  for (StampedPose& pose : file.trajectory.poses) {
    if (w_first) pose.q = fromWFirst(pose.q);
    if (inverted) pose.q = pose.q.conjugate();
  }
  return file;
}

}  // namespace

void TrajectoryMetricOptions::check() const {
  if (!(association.max_dt_s >= 0 && association.max_gap_s >= 0)) {
    throw InputError("the largest difference of stamps and the widest gap must be 0 s or more");
  }
  if (!std::isfinite(association.time_offset_s)) throw InputError("the time offset must be finite");
  if (alignment.first_n < 0)
    throw InputError("the number of pairs to align by must be 0 (all) or more");
  if (clock && !(clock->max_offset_s > 0))
    throw InputError("the range of the clock search must be above 0 s");
  for (const RelativeDelta& over : rpe) {
    if (over.delta > 0 && hasPairsOver(over.pairs, over.unit)) continue;
    throw InputError(fmt::format("no pairs of {} over {:g} {}", toString(over.pairs), over.delta,
                                 toString(over.unit)));
  }
}

Result<TrajectoryRun> evaluateTrajectories(const Trajectory& estimate, const Trajectory& truth,
                                           const TrajectoryMetricOptions& options) {
  options.check();
  const bool with_rotation = estimate.has_orientation && truth.has_orientation;
  if (!with_rotation && standsOnRotation(options.alignment.kind)) {
    return Failure{FailureCode::kAlignmentNeedsOrientations,
                   {{"alignment", toString(options.alignment.kind)}}};
  }
  const Result<CommonFrames> frames = commonFrames(estimate, truth, options);
  if (!frames) return frames.failure();
  TrajectoryMetricOptions rest = options;
  // The offset that was found contains the one that was given.
  rest.association.time_offset_s = frames->time_offset_s;
  Result<TrajectoryRun> result =
      evaluated(estimate, frames->truth_S ? *frames->truth_S : truth, rest);
  if (!result) return result;
  result.value().clock_offset = frames->clock_offset;
  result.value().hand_eye = frames->hand_eye;
  result.value().clock_mismatch = clockMismatchOf(*result, estimate, truth, options);
  if (!result->clock_mismatch && options.hand_eye && !options.clock) {
    result.value().clock_mismatch = clockMismatchUnderHandEye(*result, estimate, truth, options);
  }
  prepend(frames->remarks, result.value());
  return result;
}

TrajectoryFile readEstimate(const TrajectoryRequest& request) {
  return readAs(request.estimate, request.read_estimate, request.estimate_w_first,
                request.estimate_inverted);
}

TrajectoryFile readTruth(const TrajectoryRequest& request) {
  return readAs(request.truth, request.read_truth, request.truth_w_first, request.truth_inverted);
}

Result<TrajectoryRun> evaluateFiles(const TrajectoryFile& estimate, const TrajectoryFile& truth,
                                    const TrajectoryRequest& request) {
  Result<TrajectoryRun> result =
      evaluateTrajectories(estimate.trajectory, truth.trajectory, request.metrics);
  if (!result) return named(result.failure(), estimate, truth, request);
  TrajectoryRun& run = result.value();
  run.estimate = request.estimate.string();
  run.truth = request.truth.string();
  prepend(remarksOf(request.truth, truth), run);
  prepend(remarksOf(request.estimate, estimate), run);
  return result;
}

Result<TrajectoryRun> evaluateTrajectory(const TrajectoryRequest& request) {
  return evaluateFiles(readEstimate(request), readTruth(request), request);
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// A file that a pattern found, with what its fields stood for ("" where the pattern lacks one).
struct RunFile {
  std::filesystem::path path;
  std::string sequence, calibration, run;
};

/// Files such as 'results/{calibration}/{sequence}_{run}.txt', sorted by path. A field stands for
/// one or more characters of one folder's or file's name: {run} without underscores, the others as
/// many as they can. Where `sequences` are known, {sequence} is one of them if the name allows it,
/// so that underscores in both parts do no harm. Without fields the pattern is a file.
///
/// Throws InputError, naming the pattern, for fields of another name and folders that are not
/// there.
std::vector<RunFile> findRuns(const std::string& pattern,
                              const std::vector<std::string>& sequences = {});

/// Whether the pattern has the field, e.g. "sequence".
bool hasField(const std::string& pattern, const std::string& field);

/// Share of the truth's span below which a run is partial, unless told otherwise.
inline constexpr double kLeastCoverage = 0.9;

/// Runs x sequences x calibrations against their truths.
struct RunsRequest {
  std::string runs;                      ///< pattern of the estimates, see findRuns
  std::string truth;                     ///< pattern with {sequence} at most
  TrajectoryRequest how;                 ///< but for the files: how each is read and judged
  double min_coverage = kLeastCoverage;  ///< of TrajectoryMetricOptions::coverage's span; a run
                                         ///< below is partial
  /// ATE (RMSE of positions [m]) above which a run has diverged. Unset: the RMS distance of the
  /// truth's positions from their mean, which an estimate that never moves would reach; half of it
  /// under sim3, whose scale may shrink an estimate to a point.
  std::optional<double> max_ate_m;
  /// The only words that {calibration} may stand for, each with runs or without; empty: any.
  std::vector<std::string> calibrations;
  int threads = 0;  ///< 0: all cores

  /// Throws InputError for values out of range.
  void check() const;
};

/// One run for each calibration with each (sequence, run) that any calibration has, sorted by
/// sequence, calibration, run. What is missing, cannot be read, has no truth, cannot be paired or
/// aligned, or has diverged, is failed; what covers too little is partial; each says why. Nothing
/// is left out. The result does not depend on threads or on the order of files. name and provenance
/// are the caller's. Throws InputError where no estimate is found, a truth cannot be read, or a
/// calibration is none of `calibrations`.
TrajectoryRecord evaluateRuns(const RunsRequest& request);

/// One of them: the file `expected.estimate` against a truth that is at hand, or a part of it. Its
/// sequence, calibration and run are kept; `request` says how it is judged, not which files.
TrajectoryRun judgedRun(const TrajectoryRun& expected, const std::filesystem::path& truth_path,
                        const TrajectoryFile& truth, const RunsRequest& request);

/// A study of one run, so that it can be kept and shown as many are: partial, with its errors,
/// where it diverged or is below the least coverage, as `request` has the limits. `run` and
/// `sequence` are named after the files of estimate and truth, or after the folder of the recording
/// where a file lies in one ("MH_01/mav0/vicon0/data.csv": "MH_01").
TrajectoryRecord studyOfOne(TrajectoryRun run, const RunsRequest& request);

/// "covers 89.96 % of the truth's time, less than 90 %": a share below `least`, with as many digits
/// as it takes to show that.
std::string coverageText(double share, double least, const char* of_what);

/// Why nothing, or too little, was paired: both spans in seconds and what most likely differs (the
/// unit, the epoch, the clock), or how far the nearest stamps are apart. Neither trajectory is
/// empty.
Failure explainTooFewPairs(const Trajectory& estimate, const Trajectory& truth,
                           const Association& association, const AssociationOptions& options);

/// One sentence for each odd thing about the pairs: stamps that differ, poses without a partner or
/// in gaps, poses that were used twice. Equal stamps are the reader's remark, which knows the line.
/// A clock offset is suspected where none was estimated (`clock_is_known`) and the stamps differ by
/// more than a dense truth leaves: half its interval, that being at most half the estimate's.
std::vector<std::string> remarksOn(const Association& association, const Trajectory& estimate,
                                   const Trajectory& truth, bool clock_is_known);

/// Whether rotation and translation are by least squares over positions.
bool isFit(const AlignmentRecord& alignment);

/// What is odd about the rotations of aligned poses.
struct RotationRemark {
  std::string text;  ///< "" where they agree within 15 degrees in the median
  /// The option that makes their differences errors: there is another body frame, or one file maps
  /// the world into the body, or positions that leave the alignment's rotation free. Empty where
  /// none explains them.
  std::string cure;
  bool of_alignment = false;  ///< the latter: relative errors do not stand on it
};

/// Why the rotations of poses that were aligned by their positions (least squares) disagree widely:
/// positions so near a line or a point that the fit leaves their rotation free, another body frame
/// (a camera against an IMU), or quaternions that one file has inverted. The
/// cure is one that the evaluation accepts under `kind`, the alignment that was asked for.
RotationRemark remarkOnRotations(const std::vector<PosePair>& pairs,
                                 const AlignmentRecord& alignment, AlignmentKind kind);

/// kImplausible with the cure where quaternions were read in the wrong order, see
/// quaternionOrderFault.
std::optional<Failure> explainQuaternionOrder(const std::vector<PosePair>& pairs);

/// What `evaluate trajectory` prints for a person: a table of errors, rmse first, the pairs and the
/// alignment they stand on, and the remarks.
std::string trajectorySummary(const TrajectoryRun& run);

/// What `evaluate trajectories` prints for a person: completion and median ATE by sequence and
/// calibration, paired differences, and why each run that is not complete is so.
std::string runsSummary(const TrajectoryStudy& study);

/// trajectory.csv: one row for each run.
std::string runsTable(const TrajectoryRecord& record);

}  // namespace plumbline

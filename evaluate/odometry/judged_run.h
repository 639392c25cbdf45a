// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "evaluate/odometry/run_odometry.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// A calibration of the request, under the name that its runs have.
struct NamedCalibration {
  std::string name;
  std::filesystem::path file;
  Calibration calibration;
  bool noise_known = true;
  bool offset_known = true;  ///< false: the file states no time offset, and 0 is used
};

/// One run: a calibration on a sequence, for the `run`-th time.
struct OdometryPlan {
  const OdometrySequence* sequence = nullptr;
  const NamedCalibration* calibration = nullptr;
  int run = 1;
};

/// What a run left: its record, and the file that holds its poses.
struct OdometryOutcome {
  OdometryRunRecord record;
  std::string problem;
  std::vector<std::string> remarks;
  std::vector<StampedPose> poses;
};

/// How the remark begins that says why there is no hint (OdometryRequest::hint).
inline constexpr const char* kNoHint = "--estimate gives nothing: ";

/// The noise of a calibration that states none (Kalibr's camchain) is the sequence's.
Calibration withNoise(const OdometryPlan& plan);
/// Below the folder of results; sequences and calibrations have a name each, so that no run
/// overwrites another's.
std::string pathOf(const OdometryPlan& plan);

/// The built-in odometry's run; its poses are written to pathOf() in `out`.
OdometryOutcome runBuiltinPlan(const OdometryPlan& plan, const OdometryRequest& request,
                               const std::filesystem::path& out);
/// Another odometry's, in a folder of its own below work/ in `out`; with request.hint a second one
/// with its online calibration. Every end but a readable trajectory is a problem, not an exception;
/// throws InputError where its settings cannot be exported.
OdometryOutcome runExternalPlan(const OdometryPlan& plan, const OdometryRequest& request,
                                const std::filesystem::path& out);

/// The ground truth of a sequence.
struct SequenceTruth {
  std::filesystem::path path;
  TrajectoryFile file;
};

/// The truth while there are images: what lies before and after is not the odometry's to cover.
/// Whole where the offset of the clocks is yet to be found. Empty where none is named or lies
/// beside the sensors; throws InputError for one that cannot be read.
std::optional<SequenceTruth> readTruthOf(const OdometryRequest& request,
                                         const OdometrySequence& sequence);

/// The file `run.estimate` against its truth, by the rules of evaluateRuns().
TrajectoryRun judgedByTruth(const TrajectoryRun& run, const SequenceTruth& truth,
                            const OdometryRequest& request);

/// Without one: complete, or partial where its poses cover less than `min_coverage` of the images'
/// time; with a remark that says so.
TrajectoryRun judgedWithoutTruth(TrajectoryRun run, const OdometrySequence& sequence,
                                 const std::vector<StampedPose>& poses, double min_coverage);

/// An outcome's run, by its truth where there is one.
TrajectoryRun judgedPlan(const OdometryPlan& plan, const OdometryOutcome& outcome,
                         const OdometryRequest& request, const std::optional<SequenceTruth>& truth,
                         const std::filesystem::path& out);

}  // namespace plumbline

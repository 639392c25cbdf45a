// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "evaluate/odometry/run_odometry.h"
#include "evaluate/odometry/sequence.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

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

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "datasets/trajectory_reader.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "evaluate/metrics/trajectory/relative_error.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// How an estimate is judged, whatever the files.
struct TrajectoryMetricOptions {
  AssociationOptions association;
  AlignmentOptions alignment;
  std::vector<RelativeDelta> rpe;
};

/// One estimate, its truth, and how it is judged.
struct TrajectoryRequest {
  std::filesystem::path estimate, truth;
  TrajectoryReadOptions read_estimate, read_truth;
  TrajectoryMetricOptions metrics;
};

struct TrajectoryEvaluation {
  TrajectoryRun run;
  std::vector<std::string>
      remarks;  ///< one sentence each, what a reader of the figures should know
};

/// Pairs, aligns and measures two trajectories in memory. The rotation's errors are empty (n = 0)
/// where one of them has no orientations. Failures: kNoOverlap where the spans do not meet or no
/// stamps pair, with both spans and the likely cause; kNotObservable for fewer than three pairs and
/// whatever align() refuses.
Result<TrajectoryEvaluation> evaluateTrajectories(const Trajectory& estimate,
                                                  const Trajectory& truth,
                                                  const TrajectoryMetricOptions& options);

/// The same from files, which failures and remarks then name. Throws InputError for bad files.
Result<TrajectoryEvaluation> evaluateTrajectory(const TrajectoryRequest& request);

}  // namespace plumbline

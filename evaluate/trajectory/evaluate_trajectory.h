// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/initialise/clock_offset.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "evaluate/metrics/trajectory/errors.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// The span of the truth that coverage is a share of.
enum class CoverageSpan {
  kTruth,      ///< all of it: an estimator that starts late leaves its start uncovered
  kFirstPose,  ///< from the estimate's first pose on: its start-up is not counted
};

/// How an estimate is judged, whatever the files.
struct TrajectoryMetricOptions {
  AssociationOptions association;
  AlignmentOptions alignment;
  std::vector<RelativeDelta> rpe;
  /// Set: the offset of the clocks is estimated about association.time_offset_s and replaces it.
  std::optional<ClockOffsetOptions> clock;
  bool hand_eye = false;  ///< whether the marker body's transform is estimated, and the truth moved
  CoverageSpan coverage = CoverageSpan::kTruth;

  /// Throws InputError for values out of range.
  void check() const;
};

/// One estimate, its truth, and how it is judged.
struct TrajectoryRequest {
  std::filesystem::path estimate, truth;
  TrajectoryReadOptions read_estimate, read_truth;
  bool estimate_w_first = false;  ///< TUM: its columns are t x y z qw qx qy qz
  bool truth_w_first = false;
  bool estimate_inverted = false;  ///< its quaternions map the world into the body
  bool truth_inverted = false;
  TrajectoryMetricOptions metrics;
};

/// Pairs, aligns and measures two trajectories in memory. The rotation's errors are empty (n = 0)
/// where one of them has no orientations. Failures by reason: kNoOverlap where the spans do not
/// meet or no stamps pair, with both spans and the likely cause; kNotObservable for fewer than
/// three pairs and whatever align() refuses; kImplausible for quaternions in the wrong order; what
/// commonFrames says. NEES are there where the estimate has covariances.
Result<TrajectoryRun> evaluateTrajectories(const Trajectory& estimate, const Trajectory& truth,
                                           const TrajectoryMetricOptions& options);

/// The files of a request, as its options say. Throw InputError for bad ones, and where w is said
/// to stand first in a file that is not TUM.
TrajectoryFile readEstimate(const TrajectoryRequest& request);
TrajectoryFile readTruth(const TrajectoryRequest& request);

/// evaluateTrajectories on what these returned; failures and remarks name the files.
Result<TrajectoryRun> evaluateFiles(const TrajectoryFile& estimate, const TrajectoryFile& truth,
                                    const TrajectoryRequest& request);

/// All of it.
Result<TrajectoryRun> evaluateTrajectory(const TrajectoryRequest& request);

/// What brings an estimate and its truth to one clock and one body.
struct CommonFrames {
  double time_offset_s = 0;  ///< to add to the estimate's stamps
  std::optional<ClockOffsetRecord> clock_offset;
  std::optional<HandEyeRecord> hand_eye;
  std::optional<Trajectory> truth_S;  ///< with hand_eye: T_VS = T_VM T_SM^-1
  std::vector<std::string> remarks;
};

/// The clock offset and the hand-eye transform that `options` ask for, in this order, from the
/// data; neither by default. The hand-eye takes the truth at the estimate's stamps by
/// interpolation, whatever the association. Fails as estimateClockOffset and estimateHandEye do,
/// where one of the trajectories has no orientations, and where hand-eye is asked for under an
/// unknown scale.
Result<CommonFrames> commonFrames(const Trajectory& estimate, const Trajectory& truth,
                                  const TrajectoryMetricOptions& options);

}  // namespace plumbline

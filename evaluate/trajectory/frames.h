// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

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

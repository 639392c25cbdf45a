// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline {

/// T_SC0 and the time offset that were held against those that `estimated` found on the recording
/// with the same cameras: a caution where a component differs by more than three standard
/// deviations of both (robust ones where they are known, by Student's t; a file that states none is
/// taken to be as uncertain), which chance does in 2 % of the recordings, worse by the bounds on
/// the size of what is certain; with the mistake of convention that explains the difference, if one
/// does. Where nothing could be estimated, that is said. An offset that the file does not state is
/// 0, and its difference a caution at most. A second finding is on the offsets between cameras, by
/// the same rule, where those were estimated or tested.
enum class HeldOffset { kStated, kAssumed };
std::vector<Finding> judgeHeldImu(const ImuCalibration& held, HeldOffset offset,
                                  const Result<CameraImuStageResult>& estimated);

/// The same, T_SC0 and the offset estimated on the recording with the calibration's cameras (and
/// faults tested where their models can be calibrated); nothing where either side has no IMU, or it
/// is not asked for.
std::vector<Finding> testHeldImu(const Calibration& calibration, HeldOffset offset,
                                 const Session& session, const ScoreOptions& options);

}  // namespace plumbline

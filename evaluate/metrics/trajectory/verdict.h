// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/records/trajectory_record.h"

namespace plumbline {

/// What runs say: whether each calibration's are complete (`bad` where one failed, `caution` where
/// one is partial), whether another scale or another clock would explain their errors (mismatch.h),
/// what is left to be cured by an option (quaternions that are probably inverted), and covariances
/// that are too small. An error has no level: what it may be depends on the use.
///
/// The headline says how far estimates and truth are apart: of one run the ATE and what it stands
/// on; of several each calibration's median, and which is better where the 95 % interval of the
/// paired difference excludes zero. Then the gravest finding.
Verdict trajectoryVerdict(const TrajectoryStudy& study);

}  // namespace plumbline

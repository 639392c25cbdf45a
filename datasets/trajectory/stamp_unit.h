// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/trajectory/trajectory_builder.h"

namespace plumbline {

/// In which unit a table's stamps are: 10^power nanoseconds.
struct StampUnit {
  int power = 9;
  std::string remark;  ///< where the unit is not the format's; else empty
};

/// What is known of the unit before a row is read.
struct StampEvidence {
  int line = 0;               ///< of the first row
  double first = 0;           ///< its stamp, in the unknown unit
  std::optional<int> stated;  ///< power that the header states
  int usual = 9;              ///< power of the format
};

/// The stated unit, else the format's, else seconds or nanoseconds where only they put the stamp
/// between 1990 and 2100. Throws InputError where the header is contradicted by that, or the
/// stamps are milliseconds or microseconds that no header states.
StampUnit decideStampUnit(const TrajectorySource& source, const StampEvidence& evidence);

/// Throws InputError where the median interval is no rate of poses (0.2 ms to 20 s) for stamps read
/// with `power`, naming the unit in which it would be.
void checkPoseIntervals(const TrajectorySource& source, const std::vector<StampedPose>& poses,
                        int power, int line);

}  // namespace plumbline

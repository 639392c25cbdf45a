// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

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

/// That positions agree far better where all poses of one side are inverted, or mirrored
/// (readingMismatch()); "" where they do not.
std::string remarkOnReading(const std::vector<PosePair>& pairs, bool with_rotation);

/// kImplausible with the cure where quaternions were read in the wrong order, see
/// quaternionOrderFault.
std::optional<Failure> explainQuaternionOrder(const std::vector<PosePair>& pairs);

}  // namespace plumbline

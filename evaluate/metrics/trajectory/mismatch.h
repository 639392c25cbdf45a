// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// The most that the ATE with another scale, clock or reading may be of that without.
inline constexpr double kFarBetter = 0.5;
/// Offsets of the clocks below this are nobody's fault [s].
inline constexpr double kLeastOffset = 1e-3;
/// Within which the angular rates are asked for an offset [s].
inline constexpr double kRatesRange = 3;

/// The scale by which the positions of `pairs` agree, where by lengths as they are they do not: s
/// of sim3 is outside of 0.8 to 1.25, the ATE after it at most half of that after se3, and a tenth
/// of the RMS distance of the truth from its mean. So an estimate that diverged, of which a small
/// scale makes a point, has none. Of all pairs, whatever the alignment of the figures. O(n).
std::optional<ScaleMismatch> scaleMismatch(const std::vector<PosePair>& pairs);

/// What was done to all poses of one side before the alignment.
enum class PoseReading {
  kEstimateInverted,  ///< T_BW was read for T_WB
  kTruthInverted,
  kMirrored,  ///< one of the two has a left-handed world
};

/// Poses that agree far better when read otherwise.
struct ReadingMismatch {
  PoseReading reading = PoseReading::kMirrored;
  double ate_m = 0, other_ate_m = 0;  ///< after se3, as they were read and otherwise
};

/// The reading by which the positions of `pairs` agree best, where as they were read they do not:
/// the ATE after se3 is at most half, and a tenth of the RMS distance of the truth from its mean.
/// Inversions are tried where both sides have orientations. O(n).
std::optional<ReadingMismatch> readingMismatch(const std::vector<PosePair>& pairs,
                                               bool with_rotation);

struct ClockTrialOptions {
  double time_offset_s = 0;  ///< that was given: added to the estimate's stamps first
  double max_gap_s = 0.1;  ///< widest gap of the truth that is bridged, if it is no usual interval
  AlignmentKind alignment = AlignmentKind::kSe3;  ///< or kSim3
};

/// The offset d of the clocks, t_truth = t_estimate + d, by which the positions agree, where by the
/// stamps as they are they do not: the ATE with it is at most half of that without, over the poses
/// that have a truth both ways. The truth is taken at the estimate's stamps by interpolation,
/// whatever the association of the figures: nearest stamps vanish where both lie on one grid.
///
/// Gauss-Newton from 0 over the aligned errors e = p_truth - p_estimate, which an offset makes
/// e = -v d, v the truth's velocity, and from which the alignment has taken what it could, J:
///   d = -sum e^T v / (sum v^T v - sum v^T J (sum J^T J)^-1 sum J^T v),
/// J = d p_estimate / d (R, t and, with sim3, s), with truth and alignment anew after each step.
/// Errors of which the first step explains less than a tenth (sum of squares) are not those of a
/// clock: nothing more is computed, O(n log n). None beyond 2 s, where the steps do not settle, and
/// for fewer than half of the poses.
///
/// Positions that are ahead along the way may also be those of another body, which travels ahead (a
/// vehicle's antenna). Where both have orientations the angular rates therefore tell the offset,
/// too (estimateClockOffset, within kRatesRange): `rates_s`, where these do.
std::optional<ClockMismatch> clockMismatch(const Trajectory& estimate, const Trajectory& truth,
                                           const ClockTrialOptions& options);

/// Whether the clocks are off, by the angular rates: by at least a quarter of what the positions
/// ask for. Nothing where no rates tell.
std::optional<bool> ratesConfirm(const ClockMismatch& mismatch);

}  // namespace plumbline

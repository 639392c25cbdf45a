// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"

namespace plumbline {

struct ClockOffsetOptions {
  double max_offset_s = 1;            ///< search range, both ways [s]
  double estimate_interval_s = 0.05;  ///< the estimate's rates are means over at least this [s]
  double truth_interval_s = 0.02;     ///< and the truth's over at least this
  double max_gap_s = 0.5;             ///< no rate is taken across a longer pause
  double min_correlation = 0.6;       ///< below it nothing is claimed

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// What was correlated.
enum class RateFeature {
  kVectors,     ///< rates in the body frames, after the best rotation between these
  kMagnitudes,  ///< their magnitudes, which no choice of frames changes
};

struct ClockOffset {
  double offset_s = 0;     ///< t_truth = t_estimate + offset_s
  double std_s = 0;        ///< standard deviation, see estimateClockOffset
  double correlation = 0;  ///< of the rates at the offset, 0 to 1
  RateFeature feature = RateFeature::kVectors;
  Eigen::Matrix3d R_MS = Eigen::Matrix3d::Identity();  ///< truth's body M, estimate's body S;
                                                       ///< identity for kMagnitudes
  std::size_t rates = 0;                               ///< that were compared
};

/// The offset between two clocks by which the same motion was stamped, from angular rates alone:
/// neither the bodies' frames nor the worlds matter. The search is that of estimateTimeOffset
/// (correlation after the best rotation, over the whole range); a least-squares step in offset,
/// rotation and a constant then makes it accurate to the noise. Magnitudes stand in where they
/// correlate better by 0.1, as when a file has its quaternions inverted.
///
/// std_s is that of the least-squares estimate with the scores summed over 16 segments of time,
/// whose sums are taken as independent; so rates whose errors correlate within a segment (pose
/// noise, which makes neighbouring rates err against each other; an estimator's smooth errors) are
/// accounted for. It stands on 15 degrees of freedom: itself known to a fifth. What noise of the
/// truth adds to the rates' slopes is no information: products with the estimate's slopes tell it.
///
/// Fails with kNotObservable where the rates do not vary or do not correlate (static, another
/// motion, an offset beyond the range) or correlate best at the range's edge, and where the least
/// squares leave the range or do not settle; kTooFewViews for fewer than 20 rates, kNoOverlap where
/// the trajectories share too little time within the range. O(range / 0.02 s * rates).
Result<ClockOffset> estimateClockOffset(std::span<const StampedPose> estimate,
                                        std::span<const StampedPose> truth,
                                        const ClockOffsetOptions& options = {});

}  // namespace plumbline

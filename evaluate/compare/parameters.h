// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "evaluate/metrics/verdict.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// When a difference is worth a person's attention.
inline constexpr struct ComparisonThresholds {
  double notable = 2;         ///< of a parameter's difference, caution from [standard deviations]
  double significance = 3;    ///< and bad from; above it the findings name the parameter
  Bound difference_px{1, 5};  ///< worst projection difference
  // Of transforms and offset, as far as stated deviations do not explain the difference.
  Bound lever_mm{5, 20};      ///< of a translation
  Bound angle_deg{0.2, 1.0};  ///< of a rotation
  Bound offset_ms{0.5, 5.0};  ///< of the time offset

  /// Of a parameter's difference in standard deviations.
  VerdictLevel levelOf(double sigmas) const;
} kThresholds;

/// Every parameter under all calibrations, in the order of the first (docs/comparison.md):
/// the list of calibrationParameters(), where `time_offset` is the mean over cameras, then
/// - "T_C0Ci.angle", "T_C0Ci.lever" and the same of T_SC0: value |Log(R)| [rad] and |t| [m];
///   difference the angle of R_i R_0^T and |t_i - t_0|, which have no sign;
/// - "time_offset.camI" where a calibration has one for each camera.
/// Cameras have the names that all calibrations give them; where these differ, "camI" by place.
/// Differences are to the first calibration (calibrationChange(): tangents for transforms), with
/// significance where both deviations are known, as if the two estimates were independent: the
/// normal deviate that is as rare as Student's t with the degrees of freedom of both (sumOf()).
/// Where a camera's model differs from the first's, its parameters have values but no difference.
std::vector<ComparedParameter> comparedParameters(const std::vector<Calibration>& calibrations);

/// Takes the time offset of the calibration at this place, which its file does not state, out of
/// the rows: no value, and no difference from it.
void removeTimeOffset(std::size_t calibration, std::vector<ComparedParameter>& rows);

/// The offsets of every calibration in the sign t_imu = t_cam + t_d.
OffsetSummary offsetSummary(const std::string& label, const Calibration& calibration);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "evaluate/metrics/calibration/score.h"
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

/// Per camera, over the views that both results of the same session used: mean of
///   d_v = mean |e|^2 under `other` - mean |e|^2 under `first`   [px^2]
/// with its standard error and 95 % interval. Pairing takes out what makes a view hard for both;
/// neighbouring views are alike, so the error comes from means of blocks of 10 consecutive views,
/// with as many degrees of freedom as blocks less one; below 5 blocks there is neither. Cameras
/// without two common views are left out.
std::vector<PairedPrediction> pairedPredictions(const CameraStageResult& first,
                                                const CameraStageResult& other,
                                                const std::string& label);

/// Calibrates the session itself, as `plumbline calibrate` does: with the camera models of the
/// first calibration, the board's shape under `target`, and with the IMU where a calibration and
/// the session have one. Compares every calibration with the result: comparedParameters() of the
/// session's own estimate and all of them, in this order.
///
/// The significance of a calibration that was estimated from the same session says little: the two
/// share their corners. What cannot be calibrated (a model that can only be scored, a stage that
/// fails) is said in SessionEstimate::problem; then `parameters` has what there is.
SessionEstimate sessionEstimate(Session session, const std::vector<Calibration>& calibrations,
                                const ScoreOptions& options, TargetMode target);

/// A map in brief.
struct MapExtremes {
  double worst = std::numeric_limits<double>::quiet_NaN();  ///< of its numbers; NaN without one
  std::size_t at = 0;                                       ///< its place among them
  double centre = 0;     ///< the middle grid point: the image's where columns and rows are odd
  double undefined = 0;  ///< share of the grid without a number
};
MapExtremes extremesOf(const ImageMap& map);

/// "a, b, ...": the first of these names, and whether there are more.
std::string firstNames(std::vector<std::string> names, std::size_t most);

/// Whether a calibration is known to be from other data than the session.
bool isHeldOut(const ComparisonRecord& record, const std::string& label);

/// A row of the compared parameters by its name; none where there is no such row.
const ComparedParameter* comparedParameter(const ComparisonRecord& record, const std::string& name);

/// What a comparison says, in the order in which it is read: parameters that differ beyond their
/// deviations, transforms and offsets, the worst projection difference of each pair and camera with
/// its value at the centre, which calibration predicts corners better, calibrations that could not
/// be scored; then the lint of every calibration.
std::vector<Finding> comparisonFindings(const ComparisonRecord& record);

/// What a reader asks of a comparison first, for every calibration but the first: which predicts
/// corners better and by how much (pooled over cameras, 95 % interval of the paired difference;
/// only "better" where it excludes zero), and by how much they differ over the image, in T_SC0 and
/// in the time offset; then which of three and more stands alone, and in what (loneParameters()).
std::string comparisonHeadline(const ComparisonRecord& record);

/// A parameter in which one of three and more calibrations stands alone: it differs from each of
/// the others by more than `significance` standard deviations, and these agree with each other
/// within `notable` ones.
struct LoneParameter {
  std::size_t calibration = 0;
  std::string name;
  double sigmas = 0;  ///< the smallest of its differences from the others
  double others = 0;  ///< the largest among the others
};

/// By calibration, the clearest first. Only parameters that three or more calibrations state with
/// a standard deviation, all comparable with the first's; differences are as if the estimates were
/// independent, those between two that are not the first to first order in their tangents.
std::vector<LoneParameter> loneParameters(const ComparisonRecord& record);

/// The same against the session's own estimate, for two calibrations and more: one stands alone
/// where the session and all others agree. Only where these others are known not to have been
/// estimated from that session: those that were agree with it anyway.
std::vector<LoneParameter> loneAgainstSession(const ComparisonRecord& record);

/// A finding for each calibration that stands alone in some parameter.
std::vector<Finding> loneFindings(const ComparisonRecord& record);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/verdict.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// Residuals, less the parameters fitted to them, below which no noise density is judged.
inline constexpr double kLeastRedundancy = 50;

/// One rule of the verdict: its name, the unit of what it compares, and what to do where the level
/// is not good.
struct Rule {
  std::string name;
  std::string unit;
  Bound bound;
  std::string advice;
};

/// The finding of a rule: the threshold beside it is the bound crossed, or the nearer one if none
/// was; advice only where the level is not good.
Finding finding(const Rule& rule, VerdictLevel level, double value, std::string evidence);
/// The same for a value that is worse the larger, or the smaller, it is; NaN is bad.
Finding above(const Rule& rule, double value, std::string evidence);
Finding below(const Rule& rule, double value, std::string evidence);
/// The finding of a rule that could not be judged (isNotJudged()), and why.
Finding notJudged(const Rule& rule, const std::string& why);

/// The largest of a parameter's standard deviations: formal, cluster-robust, bootstrap.
struct LargestStd {
  double value = 0;
  std::string name;                                ///< of the parameter; empty where there was none
  const char* kind = "formal standard deviation";  ///< which of the three it is, in words
};

/// The largest among the parameters whose name starts with `prefix` and, after the dot, is one of
/// `suffixes`; relative to the parameter's value where asked.
LargestStd largestStd(const std::vector<ParameterEstimate>& estimates,
                      const std::vector<std::string>& suffixes, const std::string& prefix,
                      bool relative);
/// The largest among the time offsets of all cameras, named by the camera where it has its own:
/// "time_offset", or "the time offset of cam2".
LargestStd largestOffsetStd(const std::vector<ParameterEstimate>& estimates,
                            const std::vector<CameraCalibration>& cameras);
/// part / whole; 0 of nothing.
double share(double part, double whole);

/// Views of a camera with a used corner.
int usedViews(const CameraStageResult& stage, int camera);

/// Where --select-views was asked for and the recording has more views with corners, of a camera or
/// of all: a sentence that says so; otherwise empty.
std::string selectionNote(const CalibrationRecord& record, std::optional<int> camera = {});

/// `advice` to record other views, of a camera or of all; behind selectionNote(), since the views
/// that it left out come first.
std::string adviceOnViews(const CalibrationRecord& record, const char* advice,
                          std::optional<int> camera = {});

/// kCameraImuNotConverged of a stage that did not; with the faults that explain its
/// residuals, where some are significant.
Failure notConverged(const CameraImuStageResult& stage);

/// Whether the recording tests the target's size, by the batch or by the linear fit, at least to
/// within the bound that is bad. Where not, every length rests on the size that is stated.
bool testsTargetSize(const CalibrationRecord& record, const VerdictThresholds& t);

/// The rules of the verdict, each as a function from results to findings. `stage` is "cameras" or
/// "camera-IMU" and only appears in the rules' names.
using Findings = std::vector<Finding>;

/// Corners and their errors at a stage's solution.
struct StageErrors {
  const std::vector<CornerResidual>& residuals;
  const StageSummary& summary;
  const std::vector<CameraCalibration>& cameras;
};

// ---- reprojection and convergence (reprojection_rules.cpp)
Findings judgeConvergence(const StageSummary& summary, const std::string& stage);
Findings judgeResiduals(const StageErrors& errors, const std::string& stage,
                        const VerdictThresholds& t);
/// Of every camera: the part of its error that neighbouring corners share (batch/halves.h).
Findings judgeBias(const CameraStageResult& stage, const VerdictThresholds& t);
/// Of every camera whose model has no tangential terms: by how much the rotation that stands on it
/// (T_SC0 of cam0, else of T_C0Ci; of cam0 without an IMU T_C0C1) would change with them, in its
/// largest standard deviation, where they are significant. Nothing is said of a camera alone.
/// The subject is that rotation's.
Findings judgeDecentring(const CalibrationRecord& record, const VerdictThresholds& t);
/// The block of parameters in which the recording's halves differ most.
Findings judgeHalves(const StageSummary& summary, const std::string& stage,
                     const VerdictThresholds& t);
/// A bootstrap that was asked for and has no spread, or one of so few draws that it is a rough
/// figure (not judged); no finding of others.
Findings judgeResample(const std::optional<ResampleSpread>& spread, const std::string& stage);
/// Corners rejected as outliers, of those in the frames used.
Findings judgeRejected(const std::vector<CornerResidual>& residuals, const std::string& stage,
                       const VerdictThresholds& t);
/// Corners of frames that the camera stage could not use; those that view selection left out on
/// purpose do not count.
Findings judgeLeftOut(const CalibrationRecord& record, const VerdictThresholds& t);

// ---- what the recording shows of the target and the image (recording_rules.cpp)
Findings judgeData(const CalibrationRecord& record, const VerdictThresholds& t);
/// Frames, of the camera stage or else of the camera-IMU stage, whose views are paired only because
/// `pairing` lets their stamps be further apart than FrameOptions().tolerance, and by how much,
/// beyond a constant shift of a camera; no finding where there are none. Needs one of the stages.
Findings judgeFrameStamps(const CalibrationRecord& record, const std::vector<CameraStream>& cameras,
                          const FrameOptions& pairing, const VerdictThresholds& t);
/// An optical centre far from the image's middle: another resolution, or a cropped image.
Findings judgePrincipalPoints(const CameraStageResult& stage, const VerdictThresholds& t);
/// A stated resolution that is larger than the image was: corners reach one edge and end well
/// before the opposite one, and the optical centre lies on their side of the middle.
Findings judgeResolutions(const CameraStageResult& stage, const VerdictThresholds& t);
/// tagRows and tagSpacing of target.yaml against the tags that were seen.
Findings judgeTarget(const CalibrationRecord& record, const VerdictThresholds& t);
/// The board's own shape: by how much it departs from the grid, and whether the calibration stands
/// on it. A bent board that was taken as flat is caution, whatever its size.
Findings judgeTargetShape(const CameraStageResult& stage, const VerdictThresholds& t);

// ---- how well the data determine the parameters (reprojection_rules.cpp)
Findings judgeCameraStd(const CalibrationRecord& record, const VerdictThresholds& t);
Findings judgeImuStd(const CalibrationRecord& record, const VerdictThresholds& t);

// ---- the IMU (imu_rules.cpp)
Findings judgeFramesAndGaps(const CameraImuStageResult& stage, const VerdictThresholds& t);
/// The rule of judgePlausibility() on it.
inline constexpr char kOffsetSizeRule[] = "Size of the time offset";
/// Whether samples come often enough for a hand's motion; nothing where they do. Where not, other
/// rules speak of noise, scale or motion instead.
Findings judgeSampling(const CameraImuStageResult& stage);
/// What the files state against what the data say: the IMU's rate; scale and gravity by the linear
/// fit ahead of the batch, where faults could not be tested (caution at most).
Findings judgeStatements(const CalibrationRecord& record, const VerdictThresholds& t);
Findings judgePlausibility(const CameraImuStageResult& stage, const VerdictThresholds& t);
/// A density is said to be larger than the data need below this share of it that they ask for.
inline constexpr double kPessimisticFactor = 1.0 / 5;
/// One density of imu.yaml against what the residuals say of it, if they say enough. `record` is
/// that of the check, with its camera-IMU stage.
Findings judgeDensity(const std::string& sensor, const ImuNoiseCheck& check,
                      const CalibrationRecord& record, const VerdictThresholds& t);

// ---- single samples (sample_rules.cpp)
/// Channels whose largest reading repeats in a row and far more often than the next ones: cut off
/// at the sensor's range.
Findings judgeSamples(const std::vector<ImuSample>& samples, const VerdictThresholds& t);
/// The largest whitened residual of an interval, per sensor, over the median of all: spikes, jumps
/// of a bias, wrong stamps.
Findings judgeIsolatedResiduals(const CameraImuStageResult& stage, const VerdictThresholds& t);
/// Stamps of frames that err one by one: rotation residuals along the motion, with opposite signs
/// in neighbouring intervals, or reprojection errors that a shift of the stamp takes away.
Findings judgeStampJitter(const CameraImuStageResult& stage, const VerdictThresholds& t);
/// The corners' deviation that explains the noise of single frames' poses under the densities that
/// fit best (ImuNoiseChecks::pose_pixel_sigma), over that of the corners about each frame's own
/// pose: 1 and less where frames and IMU agree. Not judged where the poses do not tell it.
Findings judgeFramePoses(const CameraImuStageResult& stage, const VerdictThresholds& t);
/// RMS of the whitened residuals of the whole chain over what the noise check, which cuts it into
/// segments with biases of their own, expects of them: above 1 where the segments do not fit
/// together.
Findings judgeLongResiduals(const CameraImuStageResult& stage, const VerdictThresholds& t);

// ---- what was left out (sample_rules.cpp)
/// A sample of the IMU as a person finds it: file and line, or its stamp.
std::string sampleName(TimeNs t, int line);
/// Spikes, views delivered twice, tags with another's id, false corners: found and left out.
Findings judgeScreening(const CameraImuStageResult& stage, const VerdictThresholds& t);

// ---- faults that the calibration does not model (fault_rules.cpp)
/// What the score tests name, and whether it moves the calibration by more than its deviations;
/// that nothing is judged where they were not made. `record` has a camera-IMU stage.
Findings judgeFaults(const CalibrationRecord& record, const VerdictThresholds& t);

}  // namespace plumbline

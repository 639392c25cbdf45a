// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/camera_imu/frame_selection.h"
#include "calibrator/batch/camera_imu/posed_frames.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

/// First guess of everything that is not a frame's own.
struct CameraImuStart {
  Transform T_SC0;
  TimeOffsets time_offsets{TimeOffset()};
  Eigen::Vector3d gravity_direction = -Eigen::Vector3d::UnitZ();
  ImuBias bias;
  InertialCheck check;
  std::optional<PartOffsets> parts;  ///< time offsets of parts of the recording, by rates alone
};

/// Units and axes checked, time offset by correlation, rotation by alignment of rates, gravity,
/// translation and accelerometer bias by linear least squares.
Result<CameraImuStart> startCameraImu(std::span<const CameraPose> poses,
                                      std::span<const ImuSample> samples, const AprilGrid& target,
                                      const CameraImuOptions& options);

/// kStampsWander where parts of the recording have offsets that differ by more than 5 ms and ten
/// standard deviations.
std::optional<Failure> wanderingStamps(const std::optional<PartOffsets>& parts);

/// Gives every camera whose stamps are off camera 0's an offset of its own to be estimated,
/// starting at camera 0's.
void freeOwnOffsets(const Session& session, const std::vector<Frame>& frames, TimeOffsets& offsets);

/// The start under a given calibration, which is taken as it is: gravity from the mean specific
/// force, biases zero. Nothing of it can fail, whatever the calibration.
CameraImuStart startFromCalibration(std::span<const CameraPose> poses,
                                    std::span<const ImuSample> samples, const ImuCalibration& imu);

/// States at the frames: poses through T_SC0, velocities by differences of positions.
std::vector<ImuState> startStates(std::span<const CameraPose> poses, const CameraImuStart& start);

/// The session's measurements without frames: corners packed, stamps shifted, noise chosen. Checks
/// the options (InputError).
CameraImuProblem makeProblem(const Session& session, const CameraImuOptions& options);

/// The result's values as an estimate to start from, without states.
CameraImuEstimate calibrationEstimate(const CameraImuStageResult& result);

/// A result's frames with their measurements, and its values: the batch at its solution.
struct SolvedCameraImu {
  CameraImuProblem problem;
  CameraImuEstimate estimate;
};
/// `session` and `options` are those that gave the result.
SolvedCameraImu solvedBatch(const Session& session, const CameraImuStageResult& result,
                            const CameraImuOptions& options);

/// How frames are selected under a time offset, from the stage's options.
FrameSelectionOptions selectionOptions(const CameraImuOptions& options, double time_offset_s);

/// solveCameraImu() under the stage's options. With a robust loss the squared one goes first, for a
/// few steps (its normal equations lead closer to the minimum from afar), unless the start is a
/// solution already.
CameraImuSolution solveFrom(CameraImuProblem& problem, const CameraImuEstimate& start,
                            const CameraImuOptions& options);
CameraImuSolution solveFromSolution(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                    const CameraImuOptions& options);

/// Everything the stage reports of a solution but its seconds and what was left out before the
/// problem was made. Fails where the offset left the samples or the parameters are not observable.
Result<CameraImuStageResult> stageResult(const CameraImuProblem& problem,
                                         const CameraImuSolution& solution, const Session& session,
                                         const CameraImuOptions& options);

/// The same of a solution that holds the calibration: no covariance, no standard deviations. Fails
/// where the solver found nothing.
Result<CameraImuStageResult> scoreResult(const CameraImuProblem& problem,
                                         const CameraImuSolution& solution, const Session& session);

/// Residual of every corner of the problem's frames (rejected ones too, used == false).
std::vector<CornerResidual> cornerResiduals(const CameraImuProblem& problem,
                                            const CameraImuEstimate& estimate);

/// Residual of every inertial link, raw and normalised.
std::vector<ImuIntervalResidual> imuIntervalResiduals(const CameraImuProblem& problem,
                                                      const CameraImuEstimate& estimate,
                                                      const ImuWeights& weights);

/// RMS values and chi-square of the inertial residuals.
ImuResidualSummary summarise(const std::vector<ImuIntervalResidual>& residuals);

/// Covariance of T_SC0, time_offset, if freed the cameras, and "time_offset.NAME" of cameras that
/// are not synchronised (camera 0's plus the difference), all else marginalised: the inverse
/// information, plus (sandwich) what the noise of single IMU samples at the frames adds to the
/// gradient by the time offset; it matters for noisy IMUs at high rates. Fails with
/// kNotObservable, naming directions, where a standard deviation exceeds the options' limits.
Result<ParameterCovariance> cameraImuCovariance(const CameraImuProblem& problem,
                                                const CameraImuSolution& solution,
                                                const CameraImuOptions& options);

/// Inverse of the border's information, always finite: what nothing measures has a deviation far
/// beyond every limit.
Eigen::MatrixXd borderCovariance(const Eigen::MatrixXd& information);

/// The parameters of that list as combinations of the border's, a row each: T_SC0 and the time
/// offset are the first seven.
Eigen::MatrixXd listedByBorder(const CameraImuEstimate& estimate, bool free_cameras);

/// The same parameters at a solution that held them (fixed_calibration): the inverse information
/// with states and gravity's direction marginalised, cameras and the differences between the
/// cameras' own offsets held, so that the list is the same for every calibration; with the
/// sandwich's part. The corners are weighted by a Cauchy loss of scale `cauchy_px`; 0: all alike.
/// Empty where the information is singular.
std::optional<ParameterCovariance> fixedCovariance(CameraImuProblem problem,
                                                   const CameraImuSolution& solution,
                                                   double cauchy_px);

/// Covariance of every state and of gravity's direction, by the same rules: the selected inverse of
/// the information, plus the sandwich's part. Empty where the information is singular.
std::optional<ImuStateCovariances> stateCovariances(const CameraImuProblem& problem,
                                                    const CameraImuSolution& solution);

/// Sets a stage's covariance and its entropy, which is NaN where the covariance is singular.
void setCovariance(ParameterCovariance covariance, StageSummary& summary);

/// See FrameErrors. With H, b the sums of a frame's corners (MovedView) about its pose, and d the
/// column of its stamp's shift: b' H^-1 b is what the pose of its own takes, b_d^2 / H_dd what a
/// shift of the stamp takes.
FrameErrors frameErrors(const CameraImuProblem& problem, const CameraImuEstimate& estimate);

/// The significance that by chance is exceeded as seldom as `deviations` (above 0) of a normal
/// deviate are, where the dispersion is estimated from so many blocks of time (at least 2):
///   chi2 / dof follows F(dof, 3 (blocks - 1)).
/// The variances of T_SC0's translation, its rotation and the time offset count as three estimates
/// of the dispersion (ScoreTests::overdispersion()). `deviations` at least, which it approaches for
/// many blocks.
double significanceBound(double deviations, int dof, std::size_t blocks);

/// Relative errors (radians likewise) up to which the score tests' linear model holds: an estimate
/// beyond it is no test.
inline constexpr double kLinearShare = 0.25;

struct Diagnosis {
  FaultDiagnosis faults;
  /// Of a batch that refines the cameras: cluster-robust deviations of all that
  /// cameraImuCovariance() lists, with what the held board's terms add by their covariance, whose
  /// degrees of freedom are not known and taken as infinite. Empty where the cameras are held.
  std::optional<RobustDeviations> joint;
};

/// From how many blocks of time diagnoseFaults() estimates the dispersion for these frames, if it
/// judges at all: see areDiagnosed().
std::size_t diagnosedBlocks(const std::vector<Frame>& frames);

/// Whether these frames span the eight blocks of time that diagnoseFaults() needs.
bool areDiagnosed(const std::vector<Frame>& frames);

/// Score (Lagrange multiplier) tests at the optimum of the camera-IMU batch: one more block of
/// information for each fault, no new solution. With s the gradient and I the information about a
/// fault's parameters theta, all states and calibration parameters adapting (effectiveScores()),
///   theta = -I^-1 s,   chi2 = s' I^-1 s,   shift = dcalibration/dtheta theta
/// (Rao 1948; for a change at an unknown instant the largest over instants, Andrews 1993). The
/// deviations are cluster-robust: the scores of blocks of time, the fault taken out, take the place
/// of the assumed noise (sandwich, with n / (n - 1 - dof) for few blocks). chi2 is the smaller of
/// the robust one and the formal one over the factor by which robust variances of the calibration
/// exceed formal ones, since either alone can be fooled (few blocks; a wrong pixel_sigma).
///
/// The first cause is the significant fault that explains most (Schwarz's criterion: what the cost
/// falls by over that factor, less dof log(blocks)), the next ones are those
/// that remain significant with the first in the model. Estimates are right to first order: faults
/// that move the calibration far are found, their size is then a guess. An estimate far outside the
/// range where the fault acts linearly is no test: its chi2 is 0, unless directions that the motion
/// determines are left when the others are held (ScoreTests::test()). Empty where the recording has
/// too few blocks, the system has no inverse, or the solver stopped far from an optimum.
/// `cameras_given`: the cameras are tested too, see CameraImuOptions.
std::optional<Diagnosis> diagnoseFaults(const CameraImuProblem& problem,
                                        const CameraImuSolution& solution, bool cameras_given);

/// Longer recordings are judged by checkImuNoise() on segments of 100 frames spread evenly over
/// them, this many frames in all: more would cost as much as the calibration and say little more.
inline constexpr int kMostNoiseFrames = 300;

/// What the inertial residuals say of the assumed densities.
///
/// Whitened residuals at an optimum are r = (I - P) n with P = J S J', S the joint covariance of
/// all unknowns; their expected square is 1 - P_kk, far from 1 where an interval's own states
/// absorb its residual. The sum of 1 - P_kk over a group of rows is its redundancy. The groups:
/// rotation rows (gyroscope), velocity and position rows (accelerometer), the walk of either bias;
/// and the poses, six rows a frame: the distance to the pose that the frame's corners alone would
/// choose, in the metric of their information.
///
/// Each group's variance is multiplied by |r|^2 / redundancy until nothing changes, every time with
/// the residuals of the optimum under these variances (one linear step): iterated almost unbiased
/// estimation of variance components (Foerstner 1979), which ends in restricted maximum likelihood.
/// The poses' scale takes pixel_sigma out of the statement, and takes up errors that the corners of
/// a view share (blur, a wrong model), which reprojection residuals hide: noise of poses is fresh
/// in every frame, noise of rates adds up, and that tells them apart. In simulation pixel_sigma of
/// 1 where 0.2 is right changes factors by 1 to 3 %.
///
/// To be trusted where the redundancy is large: a factor's relative deviation is 1 / sqrt(2
/// redundancy) or somewhat more. Vibration, scale and alignment errors of the IMU and distortion of
/// the integration count as noise of the IMU. Redundancies are 0 where the system has no inverse.
///
/// The redundancy of the poses grows with the noise that they are taken to have: it is counted at
/// `corner_sigma_px`, that of the corners about each frame's own pose, per axis. Where it is below
/// 10 (quiet corners beside a noisy IMU, which poses follow little), and the squares of all rows
/// under that noise and the densities found are within chi-square's 99.9 %, pose_pixel_sigma is not
/// told, 0. (Rig d435i, 20 s, corners of 0.009 px: clean recordings had -2 to 44 more than their
/// redundancy of 1176, with stamps jittered by 0.5 ms 317 and 437 more; the bound is about 155.)
///
/// Takes over problem and solution, which are large: move them in where they are needed no more.
ImuNoiseChecks checkImuNoise(CameraImuProblem problem, CameraImuSolution solution,
                             double corner_sigma_px);

/// True standard deviations of the noise over those that a batch's weights assume.
struct NoiseFactors {
  double corner = 1;      ///< over pixel_sigma
  double gyro = 1;        ///< rotation rows
  double accel = 1;       ///< velocity and position rows
  double gyro_bias = 1;   ///< random walk
  double accel_bias = 1;  ///< random walk
  double samples = 1;  ///< of single samples, in the gradient by the offset (the sandwich's part)
};

/// Covariance of T_SC0 (6) and the time offset (7 x 7), cameras held, of a batch whose measurements
/// have other noise than its weights assume. With H_g the information that a group of rows brings
/// and f_g its factor,
///   H^-1 (sum of f_g^2 H_g) H^-1,   H = sum of H_g,
/// all else marginalised; with the sandwich's part of cameraImuCovariance(). Empty where H is
/// singular or the offset leaves the samples.
std::optional<Eigen::MatrixXd> covarianceUnder(const SolvedCameraImu& solved,
                                               const NoiseFactors& noise);

}  // namespace plumbline

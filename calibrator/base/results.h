// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// A fault of the recording or of its description that the camera-IMU batch does not model, with
/// what its estimate lists.
enum class UnmodelledFault {
  kAccelScale,         ///< scale errors of the accelerometer's axes, 3 [1]
  kAccelMisalignment,  ///< off-diagonal terms of its matrix, row by row, 6 [rad]
  kGyroScale,          ///< 3 [1]
  kGyroMisalignment,   ///< 6 [rad]
  kGSensitivity,       ///< of the gyroscope, 3 x 3 row by row [rad/s per m/s^2]
  kImuDelay,           ///< by how much the accelerometer is later than the gyroscope [s]
  kClockDrift,         ///< growth of the time offset [s/s]
  kLineDelay,          ///< readout time of the image's height (rolling shutter), of one camera or
                       ///< one for all [s]
  kTargetSize,         ///< the target is larger than stated, relative [1]
  kCameraDelay,        ///< by how much a camera's time offset differs from camera 0's [s]
  kImuMoved,           ///< change of T_SC0 from an instant on (3 m, 3 rad)
  kClockStep,          ///< change of the time offset from an instant on [s]
  kCameraMoved,        ///< change of T_C0Ci from an instant on (3 m, 3 rad)
  kTargetShape,   ///< the target is not flat or not even, all terms of TargetBasis but tag_edge [m]
  kTargetMoved,   ///< displacement of the target in F at an instant, 3 [m]
  kTargetSways,   ///< target swinging in F, sine x y z and cosine x y z [m]
  kGyroBiasJump,  ///< jump of the gyroscope's bias at an instant, 3 [rad/s]
  kAccelBiasJump,  ///< jump of the accelerometer's bias at an instant, 3 [m/s^2]
  kStampsWander,   ///< changes of the time offset at seven instants, evenly spaced [s]
  kGivenCameras,   ///< cameras that were given, in the order of their own stage: all intrinsics,
                   ///< then all T_C0Ci but camera 0's
};

/// Words of the documents, in the order above.
inline constexpr std::array<const char*, 20> enumWords(UnmodelledFault) {
  return {"accel-scale",    "accel-misalignment", "gyro-scale",    "gyro-misalignment",
          "g-sensitivity",  "imu-delay",          "clock-drift",   "line-delay",
          "target-size",    "camera-delay",       "imu-moved",     "clock-step",
          "camera-moved",   "target-shape",       "target-moved",  "target-sways",
          "gyro-bias-jump", "accel-bias-jump",    "stamps-wander", "given-cameras"};
}

/// A score test: is the fault there, how large is it, and what does it do to the calibration?
struct FaultTest {
  UnmodelledFault fault = UnmodelledFault::kAccelScale;
  int camera = -1;              ///< of faults that one camera has; -1: of the recording
  std::optional<TimeNs> since;  ///< of faults that begin at an instant, where they explain most
  Eigen::VectorXd estimate;     ///< to first order, see UnmodelledFault
  Eigen::VectorXd std;          ///< cluster-robust
  std::optional<double> frequency_hz;  ///< of what swings
  double chi2 = 0;                     ///< of the estimate against zero, see diagnoseFaults()
  double explained = 0;  ///< by how much twice the batch's cost falls with the fault in the model,
                         ///< over the factor by which robust variances exceed formal ones
  int dof = 0;
  double significance = 0;  ///< of chi2, in standard deviations (Wilson and Hilferty)
  /// What modelling the fault would add to T_SC0 (3 m, 3 rad) and the time offset [s].
  Eigen::Matrix<double, 7, 1> shift = Eigen::Matrix<double, 7, 1>::Zero();
  double shift_sigma = 0;  ///< the largest of them in its robust standard deviation
};

/// A reading that its neighbours contradict; its sample is not integrated.
struct ImuSpike {
  TimeNs t = 0;     ///< of the sample, as recorded
  int channel = 0;  ///< 0 to 2: gyroscope x, y, z; 3 to 5: accelerometer
  double size = 0;  ///< reading less what the neighbours say [rad/s, m/s^2]
  int line = 0;     ///< of the file, for who knows it
};

/// A pause between two samples that breaks the chain of motion.
struct ImuPause {
  TimeNs t = 0;           ///< of the sample before it, as recorded
  double duration_s = 0;  ///< to the next one
  int line = 0;           ///< of the sample before it, for who knows the file
};

/// A view that repeats the corners of the one before it, although the rig moved.
struct RepeatedView {
  int camera = 0;
  TimeNs t = 0;  ///< the view's own stamp
};

/// A tag that stands where another's id belongs.
struct MisplacedTag {
  int camera = 0;
  TimeNs t = 0;   ///< the view's own stamp
  int tag = 0;    ///< id that was read
  int place = 0;  ///< tag in whose place it stands
};

/// Measurements that contradict their neighbours or the target's geometry, and were left out.
struct Screening {
  std::vector<ImuSpike> spikes;
  std::vector<ImuPause> pauses;
  std::vector<RepeatedView> repeated_views;
  std::vector<MisplacedTag> misplaced_tags;
  /// Far off where their view says they are; left out under a robust loss.
  std::size_t false_corners = 0;
  std::size_t grazing_corners = 0;  ///< seen at 89 degrees and more from the optical axis

  bool empty() const {
    return spikes.empty() && pauses.empty() && repeated_views.empty() && misplaced_tags.empty() &&
           false_corners == 0 && grazing_corners == 0;
  }
};

struct FaultDiagnosis {
  std::vector<FaultTest> tests;  ///< each fault alone beside the calibration's own parameters
  /// Those that explain the residuals, most important first, each tested with those before it in
  /// the model. Empty: none is significant.
  std::vector<FaultTest> causes;
  /// One that explains the residuals as well as the first cause, so that the two cannot be told
  /// apart from this recording.
  std::optional<FaultTest> alternative;
  /// Cluster-robust standard deviations of T_SC0 (3 m, 3 rad) and the time offset [s], and the
  /// formal ones under the same assumptions.
  Eigen::Matrix<double, 7, 1> robust_std = Eigen::Matrix<double, 7, 1>::Zero();
  Eigen::Matrix<double, 7, 1> formal_std = Eigen::Matrix<double, 7, 1>::Zero();
  std::optional<Eigen::VectorXd> robust_dof;  ///< degrees of freedom of the squares of `robust_std`
  /// How T_SC0 and the offset follow the cameras that the batch holds, to first order: 7 rows, and
  /// columns for all intrinsics, all T_C0Ci and the board's terms but tag_edge, each as its stage's
  /// covariance lists it. Empty where the cameras are free.
  Eigen::MatrixXd by_cameras;
};

/// One corner's reprojection error at the solution: e = measured - projected [px] (paper, eq. for
/// e_r).
struct CornerResidual {
  int camera = 0;
  int frame = 0;  ///< index into the stage's frames
  int corner_id = 0;
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();     ///< measured [px]
  Eigen::Vector2f error = Eigen::Vector2f::Zero();  ///< [px]
  bool used = true;                                 ///< false: rejected as an outlier
};

/// One block of parameters, as the recording's halves have it.
struct HalvesBlock {
  std::string name;  ///< "cam0 intrinsics", "T_C0C1", "T_SC0", "time offset"
  double chi2 = 0;   ///< of the difference, under the halves' deviations
  int parameters = 0;
  double limit = 0;       ///< chi2 that one recording in a hundred exceeds by chance
  std::string worst;      ///< parameter that differs by most of its deviations
  double difference = 0;  ///< of it, second half minus first [unit]
  double std = 0;         ///< of that difference, cluster-robust [unit]
  std::string unit;

  bool agree() const { return chi2 <= limit; }
};

/// A stage solved on each half of the recording apart.
struct HalvesCheck {
  TimeNs split = 0;  ///< stamp of the second half's first frame
  std::vector<HalvesBlock> blocks;
};

/// Wall seconds of the parts of a stage.
struct StageSeconds {
  double load = 0, detect = 0, initialise = 0, solve = 0, checks = 0, covariance = 0, total = 0;
};

/// What both stages report of themselves.
struct StageSummary {
  ErrorStatistics reprojection;             ///< over all used corners
  std::vector<ErrorStatistics> per_camera;  ///< over each camera's used corners
  std::size_t corners_used = 0;
  std::size_t corners_offered = 0;
  int views_used = 0;     ///< (camera, frame) pairs with used corners
  int views_offered = 0;  ///< the same in the session, whatever they saw
  bool converged = false;
  int iterations = 0;
  double cost = 0;  ///< 0.5 * sum of (robustified) squared normalised residuals
  /// Of the calibration parameters with all else marginalised; pixel_sigma as given, no tuned
  /// factor.
  ParameterCovariance covariance;
  /// Cluster-robust standard deviations in the order of `covariance`, which hold where corners err
  /// together or the model misfits (calibrator/batch/camera/information.h); empty where too
  /// few blocks of time tell. Of the camera-IMU stage T_SC0 and the time offset through both stages
  /// (batch/two_stages.h), or, where it has estimated the cameras again, of all that it lists.
  std::optional<Eigen::VectorXd> robust_std;
  /// Degrees of freedom of their squares, by which they make intervals (halfWidth90()).
  std::optional<Eigen::VectorXd> robust_dof;
  /// Whether the recording's halves agree, where that was asked for and both have a solution.
  std::optional<HalvesCheck> halves;
  double entropy_nats = 0;  ///< 0.5 log((2 pi e)^n |Sigma|) of `covariance`
  StageSeconds seconds;
};

/// What was found of the board's shape.
enum class TargetFinding {
  kNotTested,     ///< too short a recording, or no solution with the terms
  kUndetermined,  ///< the recording does not determine some term
  kLensMisfits,   ///< another lens model predicts unseen frames better: board or lens, who knows
  kAsStated,      ///< its own terms predict unseen frames no better than the stated board
  kBent,          ///< they do
  kKnown,         ///< given, and terms of its own predict unseen frames no better
  kOther,         ///< given, but they do: another board, or one that has changed
};

/// The board's shape as a recording shows it, estimated together with the cameras.
struct TargetFit {
  TargetFinding finding = TargetFinding::kNotTested;
  TargetShape shape;  ///< with its formal covariance
  /// Of the terms [m]: the larger of formal and cluster-robust, where `blocks` of time sufficed.
  TargetTerms std = TargetTerms::Zero();
  int blocks = 0;
  /// RMS, after the loss (sqrt(mean rho(|e|^2))), of frames that cameras and board were not fitted
  /// to.
  double held_out_px = 0;
  double flat_held_out_px = 0;  ///< the same with the board as stated, or as it was given
  double gain_px2 = 0;          ///< mean over blocks of time: by how much the squares are smaller
  double gain_std_px2 = 0;      ///< standard deviation of that mean
  /// Of terms of degrees 3 and 4 (shape.higher where they are kept), where they were tried: RMS of
  /// the same frames, and by how much their squares are smaller than with the twelve terms.
  std::optional<double> higher_held_out_px, higher_gain_px2, higher_gain_std_px2;
  /// The same of remainders of single corners besides, against degrees 3 and 4; and the standard
  /// deviations [m] that their prior has been given, in the plane and in height, where they are
  /// kept.
  std::optional<double> corners_held_out_px, corners_gain_px2, corners_gain_std_px2;
  std::optional<double> corners_plane_std, corners_height_std;

  /// Whether unseen frames were compared: enough blocks of time, and solutions of their halves.
  bool isJudged() const { return flat_held_out_px > 0; }

  /// RMS of held-out frames with the board that `shape` is.
  double shapeHeldOutPx() const {
    if (shape.corners && corners_held_out_px) return *corners_held_out_px;
    return shape.higher && higher_held_out_px ? *higher_held_out_px : held_out_px;
  }
};

/// A lens model that was tried for a camera.
struct ModelCandidate {
  ProjectionModel projection = ProjectionModel::kPinhole;
  DistortionModel distortion = DistortionModel::kNone;
  int parameters = 0;
  int frames = 0;  ///< on which it was tried; fewer where that was enough to rule it out
  /// RMS, after the loss, of frames that it was not fitted to; NaN: no solution, or the recording
  /// does not determine it.
  double held_out_px = 0;
  double excess_px2 = 0;  ///< mean over blocks of time: by how much its squares exceed the best's
  double excess_std_px2 = 0;  ///< standard deviation of that mean
};

/// How much of a camera's reprojection error is systematic: left by lens model and board, not noise
/// of the detector (biasRatios() in batch/halves.h).
struct BiasRatio {
  std::string camera;
  double ratio = 0;     ///< share of the mean squared error that is systematic, 0 to 1
  double noise_px = 0;  ///< standard deviation of a corner per axis, from patches of neighbours
  double error_px = 0;  ///< the same of all residuals
  int patches = 0;      ///< on which noise_px stands; 0: too few, the ratio says nothing
};

/// Why a model was chosen.
enum class ModelReason {
  kNotTested,  ///< too short a recording, or no other model has a solution, or the recording does
               ///< not determine those that predict unseen frames best
  kStated,     ///< the recording states it, and no model predicts unseen frames better
  kSmallest,   ///< the fewest parameters of those that predict unseen frames as well as the best
  kCommon,     ///< the one for all cameras together; by itself the camera would have another
};

/// The lens model of one camera, chosen by the error of unseen frames.
struct ModelChoice {
  std::string camera;
  ProjectionModel projection = ProjectionModel::kPinhole;  ///< chosen
  DistortionModel distortion = DistortionModel::kNone;
  ModelReason reason = ModelReason::kNotTested;
  std::vector<ModelCandidate> candidates;  ///< the best first; without a solution last
};

/// Camera stage: intrinsics, extrinsics, and the pose of camera 0 in every frame used.
struct CameraStageResult {
  std::vector<CameraCalibration> cameras;
  std::vector<Frame> frames;     ///< frames used by the solution
  std::vector<Transform> T_FC0;  ///< one per frame
  std::vector<CornerResidual> residuals;
  /// The board that the solution stands on: the session's, or the estimated one.
  TargetShape target;
  std::optional<TargetFit> target_fit;  ///< where the shape was asked for
  std::vector<ModelChoice> models;      ///< one per camera, where they were to be chosen
  std::vector<BiasRatio> bias;          ///< one per camera
  /// Cluster-robust, of the parameters in the order of `summary.covariance`, then of the board's
  /// terms where they were estimated; empty where too few blocks of time tell. Not stored.
  std::optional<RobustCovariance> robust_covariance;
  StageSummary summary;
};

/// State of the sensor at a camera frame, in the target's frame F (no gauge freedom remains there).
struct ImuState {
  Transform T_FS;
  Eigen::Vector3d v_F = Eigen::Vector3d::Zero();         ///< [m/s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// What one of the IMU's sensors read on average between two frames, in the IMU's axes at the
/// earlier one, beside what the solution's states say that it should have read.
///   gyroscope:      measured Log(Delta R) / T + b_g,  predicted Log(R_i^T R_j) / T + b_g [rad/s]
///   accelerometer:  Delta v / T + b_a,  R_i^T ((v_j - v_i) / T - g) + b_a [m/s^2]
/// with the pre-integrated Delta R, Delta v, gravity g and the biases of state i.
struct MeanReading {
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();
  /// Of `measured`, by the assumed noise density of the samples alone.
  Eigen::Vector3d std = Eigen::Vector3d::Zero();
};

/// Residual of the IMU between two consecutive frames at the solution.
struct ImuIntervalResidual {
  TimeNs t = 0;     ///< of the earlier frame, camera clock
  double dt_s = 0;  ///< length of the interval
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// Whitened by the assumed noise; unit variance where the assumption holds. Rotation, velocity,
  /// position (jointly whitened), gyro bias walk, accel bias walk.
  Eigen::Matrix<double, 15, 1> normalised = Eigen::Matrix<double, 15, 1>::Zero();
  MeanReading gyro;   ///< [rad/s]
  MeanReading accel;  ///< [m/s^2]
};

/// What one group of inertial residuals says of the density that was assumed for it.
struct ImuNoiseCheck {
  /// Normalised RMS to expect at the solution if every assumption holds, pixel_sigma too: sqrt(mean
  /// of 1 - leverage), below 1, for each frame's own states absorb most of the residual.
  double expected_rms = 0;
  /// By how much the density should be multiplied: above 1 it is too small, below too large. 1 also
  /// where the redundancy is too low to tell.
  double factor = 1;
  /// How many residuals' worth the group has to say, once factors are applied. The factor's
  /// relative standard deviation is 1 / sqrt(2 redundancy) or somewhat more.
  double redundancy = 0;
};

/// The checks of all groups; see checkImuNoise() (calibrator/batch/camera_imu/stage.h).
struct ImuNoiseChecks {
  ImuNoiseCheck gyro;        ///< rotation rows
  ImuNoiseCheck accel;       ///< velocity and position rows
  ImuNoiseCheck gyro_bias;   ///< random walk
  ImuNoiseCheck accel_bias;  ///< random walk
  /// Standard deviation of a corner, per axis, that explains the poses' noise [px]: above that of
  /// the reprojection errors where a view's corners err together.
  double pose_pixel_sigma = 0;
};

/// What the inertial residuals say of the noise that was assumed.
struct ImuResidualSummary {
  double gyro_rms_rad_s = 0;        ///< RMS of |rotation residual| / dt
  double accel_rms_m_s2 = 0;        ///< RMS of |velocity residual| / dt
  double gyro_normalised_rms = 0;   ///< at the solution, per component, rotation rows; for what to
                                    ///< expect of it, which is not 1, see `noise`
  double accel_normalised_rms = 0;  ///< velocity and position rows
  double gyro_bias_normalised_rms = 0;
  double accel_bias_normalised_rms = 0;
  double chi2 = 0;  ///< sum of squared normalised residuals
  int dof = 0;      ///< their number
  ImuNoiseChecks noise;
};

/// How far the poses that frames and IMU share are from those that each frame's own corners would
/// choose, to first order. A shift of a frame's stamp is one of a pose's six directions.
struct FrameErrors {
  double rmse_px = 0;       ///< at the solution
  double free_rmse_px = 0;  ///< with every frame at the pose of its own corners
  double along = 0;   ///< squared error that a shift of its stamp takes from a frame, mean [px^2]
  double across = 0;  ///< that each of the other five directions takes, mean [px^2]
  double neighbours = 0;  ///< correlation of the shifts of frames that follow each other
  double jitter_s = 0;    ///< RMS of the shifts, less what directions take by chance
};

/// What the camera's motion and the accelerometer say of the stated target and of gravity, before
/// the batch takes both for granted (linear least squares over triples of frames).
struct InertialCheck {
  double target_scale = 1;  ///< metres per stated metre of the target; 0.5: stated twice too large
  double target_scale_std = 0;
  double gravity_m_s2 = 0;  ///< magnitude as measured; 0: not known
  /// What the fit leaves, over what noise of the poses and densities explains; 0: not known. Well
  /// above 1 the motion contradicts the IMU, and neither figure is to be believed.
  double residual_ratio = 0;
};

/// Covariances of what each recording has of its own, everything else marginalised. Tangents are
/// those of the batch.
struct ImuStateCovariances {
  /// One per frame: T_FS (translation in F [m], rotation on the left [rad]), velocity [m/s], gyro
  /// bias [rad/s], accelerometer bias [m/s^2].
  std::vector<Eigen::Matrix<double, 15, 15>> states;
  /// Of gravity's direction, along tangentBasis(direction) [rad].
  Eigen::Matrix2d gravity_direction = Eigen::Matrix2d::Zero();
};

/// Camera-IMU stage.
struct CameraImuStageResult {
  ImuCalibration imu;
  std::vector<CameraCalibration> cameras;  ///< as given, or refined where they were freed
  std::vector<Frame> frames;
  std::vector<ImuState> states;  ///< one per frame
  Eigen::Vector3d gravity_F =
      Eigen::Vector3d::Zero();  ///< in the target's frame [m/s^2], pointing down
  std::vector<CornerResidual> residuals;
  std::vector<ImuIntervalResidual> imu_residuals;
  ImuResidualSummary imu_summary;
  int frames_without_imu = 0;   ///< left out: not covered by IMU samples, or alone between gaps
  int frames_without_pose = 0;  ///< left out: no pose from the frame's own corners
  int imu_gaps = 0;             ///< pauses of the IMU that broke the chain
  double imu_rate_hz = 0;       ///< inverse of the median interval between IMU samples
  InertialCheck inertial_check;
  std::optional<FrameErrors> frame_errors;               ///< if the noise is checked
  Screening screening;                                   ///< what was left out of the recording
  std::optional<ImuStateCovariances> state_covariances;  ///< if asked for
  std::optional<FaultDiagnosis> faults;                  ///< if asked for, and long enough
  StageSummary summary;
};

}  // namespace plumbline

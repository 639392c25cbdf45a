// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/results/fault_diagnosis.h"
#include "calibrator/base/results/imu_residuals.h"
#include "calibrator/base/results/model_choice.h"
#include "calibrator/base/results/screening.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

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

/// How much of a camera's reprojection error is systematic: left by lens model and board, not noise
/// of the detector (biasRatios() in batch/halves.h).
struct BiasRatio {
  std::string camera;
  double ratio = 0;     ///< share of the mean squared error that is systematic, 0 to 1
  double noise_px = 0;  ///< standard deviation of a corner per axis, from patches of neighbours
  double error_px = 0;  ///< the same of all residuals
  int patches = 0;      ///< on which noise_px stands; 0: too few, the ratio says nothing
};

/// What tangential terms beside a camera's model would be, and what turns with them
/// (calibrator/batch/camera/decentring.h).
struct Decentring {
  std::string camera;
  Eigen::Vector2d p = Eigen::Vector2d::Zero();    ///< p1, p2, of a pinhole's scale on the axis
  Eigen::Vector2d std = Eigen::Vector2d::Zero();  ///< cluster-robust
  double f = 0;                                   ///< Fisher's F of p against zero
  double limit = 0;  ///< what one centred lens in ten thousand exceeds by chance
  /// By how much the target would turn in the camera's frame, mean over its views [rad]: T_SC0
  /// turns by as much the other way, seen from the camera.
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();

  bool isSignificant() const { return f > limit; }
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
  std::vector<Decentring> decentring;   ///< of cameras without tangential terms
  /// Cluster-robust, of the parameters in the order of `summary.covariance`, then of the board's
  /// terms where they were estimated; empty where too few blocks of time tell. Not stored.
  std::optional<RobustCovariance> robust_covariance;
  StageSummary summary;
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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/corners.h"
#include "calibrator/batch/resample.h"
#include "calibrator/initialise/imu_sanity.h"
#include "calibrator/initialise/rate_alignment.h"

namespace plumbline {

struct CameraImuOptions : MeasurementModel {
  TimeNs imu_shift_ns = 0;    ///< added to every IMU stamp before anything else
  bool free_cameras = false;  ///< refine intrinsics and extrinsics jointly (then the given
                              ///< cameras are the start)
  CornerFilter filter = CornerFilter::kNone;
  double filter_sigmas = 4;  ///< of CornerFilter::kSigma

  /// Frames are used that IMU samples cover, after the time offset, by this much on both sides [s].
  double margin_s = 0.005;
  /// A pause between IMU samples longer than this many times their median interval breaks the
  /// chain: only the walk of the biases is carried across.
  double max_gap_intervals = 5;
  double max_interval_s = 10;  ///< frames further apart are joined by the biases' walk alone [s]
  /// If given, only frames with one of these stamps (ascending) are used.
  std::optional<std::vector<TimeNs>> frame_stamps;
  FrameOptions frames;           ///< how views are paired
  double max_start_rms_px = 30;  ///< frames whose own pose leaves more are left out [px]

  TimeOffsetOptions offset_search;  ///< first guess of the time offset
  SanityOptions sanity;             ///< plausibility of the recording; gravity is taken from above
  double max_translation_std_m = 0.05;  ///< less certain: not observable
  double max_rotation_std_rad = 0.05;   ///< likewise
  double max_offset_std_s = 0.005;      ///< likewise
  bool state_covariances = false;       ///< report those of the states and of gravity's direction

  /// scoreCameraImu(): also report what the session tells of T_SC0 and the time offset at their
  /// given values (StageSummary::covariance, entropy_nats), the corners weighted by a Cauchy loss
  /// of this scale [px], at least 1e-3; 0: all alike. Unset: no covariance.
  std::optional<double> score_information_px;

  /// Judge the assumed densities by the inertial residuals: a fifth of the batch's time. Without it
  /// ImuResidualSummary::noise says nothing (redundancies 0).
  bool noise_check = true;

  /// Look for faults of the recording that the batch does not model (score tests): a tenth of the
  /// batch's time. Stamps that wander by what parts of the recording say (wanderingStamps()) are
  /// refused only with it, where no fault explains them or the recording is too short to be tested.
  bool diagnose_faults = true;
  /// The cameras were not calibrated on this recording: whether they suit it is tested as well.
  bool cameras_given = false;

  int threads = 1;  ///< results do not depend on it
  int max_iterations = 100;
  /// The last step is shorter than this, in standard deviations of all parameters together
  /// (sqrt(b' H^-1 b)).
  double tolerance = 1e-4;

  /// Throws InputError that names the field whose rule is violated; called by every function below.
  void check() const;
};

/// Calibrates cameras to IMU in one batch: per frame pose, velocity and biases of the sensor in the
/// target's frame; T_SC0, the time offset and the direction of gravity (and the cameras, if freed).
/// Cost: 0.5 sum rho(|e|^2) / pixel_sigma^2 over corners + 0.5 |normalised inertial residual|^2,
/// with the pre-integration redone at every step (as the paper's, but in the target's frame, so
/// that no gauge freedom remains). Deterministic, whatever the number of threads.
///
/// `cameras` in the session's order. The covariance lists T_SC0 (6), time_offset, if freed the
/// cameras as their own stage does (all intrinsics, then all T_C0Ci), and time_offset.NAME of
/// cameras that are not synchronised; everything else is marginalised. Fails with kNoOverlap,
/// kImplausible, kNotObservable, kTooFewViews or kNotConverged.
Result<CameraImuStageResult> calibrateCameraImu(const Session& session,
                                                const std::vector<CameraCalibration>& cameras,
                                                const CameraImuOptions& options = {});

/// Scores a given camera-IMU calibration on a session: the cameras, T_SC0 and the time offsets stay
/// as they are; only poses, velocities, biases and the direction of gravity move, under the same
/// cost. No check of the noise; options.score_information_px for a covariance. The noise is the
/// session's (or the options'), not the calibration's, so that scores compare; options.free_cameras
/// does not matter. Unlike calibrateCameraImu() it takes a calibration that contradicts the data:
/// that is what it is for. Fails with kNoOverlap, kTooFewViews or kNotConverged (no step lowers the
/// cost).
Result<CameraImuStageResult> scoreCameraImu(const Session& session,
                                            const std::vector<CameraCalibration>& cameras,
                                            const ImuCalibration& imu,
                                            const CameraImuOptions& options = {});

/// Cameras and board that a solution holds, in place of the earlier result's and the session's.
struct HeldCameras {
  std::vector<CameraCalibration> cameras;
  TargetShape target;
};

/// Solves again, from an earlier result, with only the given segments of its frames (ascending,
/// not overlapping), each cut loose from its neighbours: one draw of a bootstrap over time
/// segments. No corner residuals are listed in the result. Corners that the earlier result rejected
/// stay out.
Result<CameraImuStageResult> recalibrateCameraImu(
    const Session& session, const CameraImuStageResult& earlier,
    const std::vector<FrameSegment>& segments, const CameraImuOptions& options = {},
    const std::optional<HeldCameras>& held = std::nullopt);

/// Cameras and board of one draw of the bootstrap, whose segments of the earlier frames are given;
/// empty where they have no solution.
using DrawnCameras = std::function<std::optional<HeldCameras>(const std::vector<FrameSegment>&)>;

/// Solves the camera-IMU batch again on every draw of a bootstrap over time segments, each started
/// from `earlier` under the options that gave it. Draws are shared out over resample.threads; the
/// result does not depend on their number. Rows as in the covariance of `earlier` (tangent of
/// T_SC0, time offset, freed cameras). Fails with kTooFewViews if fewer than two draws have a
/// solution. With `cameras` every draw holds those (resampleBothStages()), without them the
/// earlier result's, and then the spread knows nothing of the cameras' errors.
Result<ResampleSummary> resampleCameraImu(const Session& session,
                                          const CameraImuStageResult& earlier,
                                          const ResampleOptions& resample,
                                          const CameraImuOptions& options = {},
                                          const DrawnCameras& cameras = {});

}  // namespace plumbline

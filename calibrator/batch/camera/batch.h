// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/corners.h"
#include "calibrator/batch/resample.h"
#include "calibrator/information/predicted_error.h"

namespace plumbline {

/// What a camera is to be calibrated as.
struct CameraModelPair {
  ProjectionModel projection = ProjectionModel::kPinhole;
  DistortionModel distortion = DistortionModel::kRadtan;

  bool operator==(const CameraModelPair&) const = default;
};

/// Which frames are kept, judged at the solution of all of them. By mutual information: a frame
/// that tells enough of the cameras' parameters given those kept before it, in bits (Kalibr's rule
/// and unit). By predicted error (information/predicted_error.h): one frame after the other, each
/// the one that lowers it most where all frames' corners are, until it raises the error of a corner
/// by no more than `stop_excess`; frames with more than three times the median RMSE are not taken.
struct ViewSelectionOptions {
  double threshold_bits = 0.2;
  std::uint64_t seed = 1;  ///< of the order in which frames are offered
  ViewCriterion criterion = ViewCriterion::kMutualInformation;
  double stop_excess = 0.02;
  int least_views = 8;  ///< by predicted error, never fewer

  void check() const;
};

/// What is done about the board's own shape (base/april_grid.h).
enum class TargetMode {
  kGiven,     ///< the session's target is taken as it is
  kTested,    ///< the same, but it is said whether its shape is another (TargetFit)
  kAuto,      ///< estimated, and kept where the recording determines it and it is significant
  kEstimate,  ///< estimated and kept
  /// The session's is that of another recording: its terms hold within their covariance, but
  /// tag_edge, of that recording and detector, is estimated anew.
  kKnown,
};

/// Who says what the cameras are calibrated as.
enum class ModelMode {
  kGiven,  ///< options.models, or the session's words
  kAuto,   ///< the error of unseen frames (camera/model_choice.h)
};

struct CameraStageOptions : MeasurementModel {
  ModelMode model_mode = ModelMode::kGiven;
  /// One per camera of the session. Empty: the words of the session's cameras, pinhole-radtan where
  /// they have none. A start has its own, and neither these nor the words count.
  std::vector<CameraModelPair> models;
  /// Start, one per camera of the session. Empty: from the views alone.
  std::vector<CameraCalibration> start;

  CornerFilter filter = CornerFilter::kNone;
  double filter_sigmas = 4;  ///< of CornerFilter::kSigma
  /// None: all frames are used. What the frames that it left do not determine fails with
  /// selected_frames and selected_from.
  std::optional<ViewSelectionOptions> select_views;

  TargetMode target = TargetMode::kGiven;
  /// Of TargetMode::kAuto: the board is taken as stated where the standard deviation of some term
  /// (TargetFit::std) exceeds this [m].
  double target_max_std = 5e-4;
  /// Highest degree of an estimated board's displacement: 2, or 4 where unseen frames ask for it.
  int target_degree = 4;
  /// Remainders of single corners, where degree 4 is kept and unseen frames ask for them too.
  bool target_corners = true;

  /// What the corners' detector does alike in all views: amplitude of each polynomial of a smooth
  /// displacement of a camera's image, over the RMS of the corners' errors (commonErrorMoves() and
  /// commonErrorPx() in camera/common_error.h). This stage's cluster-robust deviations contain it.
  /// 0: nothing is known of it.
  double common_error_share = 0;

  FrameOptions frames;        ///< how views are paired
  int min_start_corners = 4;  ///< views with fewer corners give no first guess of their pose
  int start_views = 30;       ///< views per camera on which its first solution stands
  /// Frames whose first guess of their pose leaves more than this share of the image's width are
  /// left out. (RMS error under a Cauchy loss of 1 % of the width: 1.5 % stand for about 3 %.)
  double max_start_error = 0.015;

  int threads = 1;  ///< results do not depend on it
  int max_iterations = 100;
  /// Of minimise(): the last step is shorter than this, in standard deviations of all parameters
  /// together; it is still taken. On EuRoC's stereo recording 1e-6 asks for one step more, which
  /// changes the RMSE by 1e-14 of itself and its median by 1e-9.
  double tolerance = 1e-4;

  /// Throws InputError that names the field whose rule is violated; called by every function below.
  void check() const;
};

/// What the session says of a camera's model; empty where it says nothing. Throws InputError for
/// words that are not known.
std::optional<CameraModelPair> statedModel(const CameraStream& stream);

/// One model per camera: options.models, or the session's words, or pinhole-radtan. Throws
/// InputError for models that cannot be calibrated, or a list of another length.
std::vector<CameraModelPair> cameraModels(const Session& session,
                                          const CameraStageOptions& options);

/// Calibrates all cameras of a session from its corners: intrinsics, extrinsics T_C0Ci, and the
/// pose of camera 0 in every frame, minimising
///   0.5 sum rho(|measured - projected|^2) / pixel_sigma^2,   rho(s) = c^2 log(1 + s / c^2) or s.
/// From scratch unless options.start is given. The result does not depend on the number of threads.
///
/// The covariance lists every camera's stacked intrinsics ("cam0.fu" ...), then the tangent of
/// every T_C0Ci ("T_C0C1.tx" ... "T_C0C1.rz"); poses are marginalised.
/// With ModelMode::kAuto the lens model of every camera is chosen by the error of unseen frames
/// (CameraStageResult::models); the session's words only count among equals, options.models not.
/// Where the recording does not determine what was chosen, models of no more than the usual eight
/// parameters are tried, and then those that the session states (ModelReason::kNotTested).
/// With options.target the board's terms are estimated besides (CameraStageResult::target); the
/// covariance is the cameras', with the terms marginalised.
/// views_offered counts all views of the session, whatever they saw; corners_offered their corners.
/// Fails with kTooFewViews, kNoOverlap, kNotObservable or kNotConverged; throws InputError for
/// models that cannot be calibrated, or lists whose length does not match the session.
Result<CameraStageResult> calibrateCameras(const Session& session,
                                           const CameraStageOptions& options = {});

/// Scores a given calibration on a session: the cameras stay as they are, only the poses T_FC0 move
/// (each frame for itself). No covariance. options.start, models and select_views do not matter.
/// Corners of misplaced tags (findMisplacedTags()) are left out, as calibrateCameras() does: a tag
/// that stands in the place of another does so under any calibration that misses by less than the
/// space between tags. Corners beyond 89 degrees
/// from a pinhole's axis count, unlike there: under a focal length that is too short there are
/// more of them, so that leaving them out would favour it over another calibration. With
/// CornerFilter::kSigma corners are rejected once, without solving again.
/// Fails with kTooFewViews if no frame has a pose.
Result<CameraStageResult> scoreCameras(const Session& session,
                                       const std::vector<CameraCalibration>& cameras,
                                       const CameraStageOptions& options = {});

/// Solves again, from an earlier result of the same session, with only the given segments of its
/// frames (ascending, not overlapping): one draw of a bootstrap over time segments. Corners that
/// the earlier result rejected stay out; no corner residuals are listed in the result.
Result<CameraStageResult> recalibrateCameras(const Session& session,
                                             const CameraStageResult& earlier,
                                             const std::vector<FrameSegment>& segments,
                                             const CameraStageOptions& options = {});

/// Solves the camera batch again on every draw, each started from `earlier`.
/// Fails with kTooFewViews if fewer than two draws have a solution.
Result<ResampleSummary> resampleCameras(const Session& session, const CameraStageResult& earlier,
                                        const ResampleOptions& resample,
                                        const CameraStageOptions& options = {});

/// Parameters of `to` minus those of `from` (the same cameras and models), in the order of the
/// camera stage's covariance: the stacked intrinsics of all cameras, then boxminus(to.T_C0Ci,
/// from.T_C0Ci) of all but the first [m, rad].
Eigen::VectorXd cameraDifference(const std::vector<CameraCalibration>& to,
                                 const std::vector<CameraCalibration>& from);

}  // namespace plumbline

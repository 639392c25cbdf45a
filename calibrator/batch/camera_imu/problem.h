// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/results.h"
#include "calibrator/base/transform.h"
#include "calibrator/linear/block_arrow.h"
#include "calibrator/linear/levenberg_marquardt.h"
#include "calibrator/residuals/imu_residual.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {

/// What joins a frame to the next one.
enum class FrameLink {
  kBroken,    ///< nothing: segments cut loose from each other
  kBiasWalk,  ///< the biases' walk alone: IMU samples are missing in between
  kInertial,  ///< pre-integrated motion and the biases' walk
};

/// Frames, intervals, views or links that one task of a parallel loop takes.
inline constexpr int kImuChunk = 64;

/// All measurements of the camera-IMU batch.
struct CameraImuProblem {
  std::vector<PackedCorners> corners;  ///< per camera, all views of the session
  /// Per camera and view, the view's stamp; empty: all views are taken at their frames' instants.
  std::vector<std::vector<TimeNs>> view_stamps;
  std::vector<ImuSample> recorded;  ///< stamps shifted by the option; without spikes
  std::vector<ImuSample> samples;   ///< the same without readings that are cut off: integrated
  std::vector<ImuSpike> spikes;     ///< what was left out, stamps as recorded
  std::vector<Frame> frames;        ///< n, ascending in time
  std::vector<FrameLink> links;     ///< n - 1, between frame i and i + 1
  std::vector<double> weights;      ///< n, how often a frame (and the link after it) counts
  AprilGrid target;
  ImuNoise noise;
  double gravity_m_s2 = MeasurementModel().gravity_m_s2;
  double pixel_sigma = 1;
  GramOptions gram;
  bool free_cameras = false;
  /// T_SC0 and all time offsets stay as they are: only states and gravity's direction move. Then
  /// the border has information 1 and no gradient there.
  bool fixed_calibration = false;
  int threads = 1;

  int frameCount() const { return static_cast<int>(frames.size()); }
};

/// All unknowns.
struct CameraImuEstimate {
  std::vector<ImuState> states;  ///< n
  Transform T_SC0;
  Eigen::Vector3d gravity_direction = -Eigen::Vector3d::UnitZ();  ///< in F, pointing down
  TimeOffsets time_offsets{TimeOffset()};
  std::vector<CameraCalibration> cameras;

  /// t_d of a camera [s].
  double timeOffset(std::size_t camera = 0) const { return offsetOf(time_offsets, camera); }
};

/// Where each parameter stands in the border.
struct BorderLayout {
  static constexpr int kExtrinsics = 0;  ///< T_SC0, 6
  static constexpr int kGravity = 6;     ///< 2
  static constexpr int kOffset = 8;      ///< 1
  static constexpr int kFixed = 9;

  std::vector<int> intrinsics;  ///< per camera, first of stacked(); empty unless cameras are free
  std::vector<int> T_C0Ci;      ///< per camera, 6, after all intrinsics; -1 for camera 0
  std::vector<int> own_offset;  ///< per camera, 1, last; -1 where it is not estimated
  int size = kFixed;

  BorderLayout(const CameraImuEstimate& estimate, bool free_cameras);
};

/// Whitening of every interval; all zero where a link is broken.
using ImuWeights = std::vector<ImuWeight>;
/// From the noise densities at the estimate. Empty where samples do not cover an inertial link.
std::optional<ImuWeights> imuWeights(const CameraImuProblem& problem,
                                     const CameraImuEstimate& estimate);

/// Normal equations and cost at an estimate.
struct CameraImuNormals {
  BlockArrow chain;
  double cost = 0;      ///< 0.5 * (robust reprojection + inertial), normalised
  double inertial = 0;  ///< the inertial part of it
  /// informationAt() only: variance that the noise of single samples at the windows' ends adds to
  /// the gradient by t_d, sum ((J_exact - J_smooth)' Omega r)^2 over intervals.
  double offset_noise = 0;
  double squared_px = 0;  ///< sum |e|^2 over used corners [px^2], unweighted by the frames' weights
};
/// Empty where the time offset has moved a window off the IMU samples.
std::optional<CameraImuNormals> normalsAt(const CameraImuProblem& problem,
                                          const CameraImuEstimate& estimate,
                                          const ImuWeights& weights);
/// The same for information: without the robust loss' curvature correction (triggs_clamp 0) and
/// with smoothOffsetDerivative().
std::optional<CameraImuNormals> informationAt(const CameraImuProblem& problem,
                                              const CameraImuEstimate& estimate,
                                              const ImuWeights& weights);

/// The corners' part of informationAt() alone: no link is added.
CameraImuNormals cameraInformationAt(const CameraImuProblem& problem,
                                     const CameraImuEstimate& estimate);

/// The estimate after a step of the chain's solution (tangents as in boxplus()).
CameraImuEstimate moved(const CameraImuEstimate& estimate, const ChainSolution& step,
                        bool free_cameras);

/// Seconds from frame i's instant to the exposure of camera c's view in it (which must exist): the
/// difference of their stamps plus what the camera's own offset differs from camera 0's. 0 for
/// cameras that are synchronised.
double exposureDelay(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                     std::size_t i, std::size_t c);

/// The sensor's pose at an exposure some milliseconds d after (or before) a frame's instant:
///   R' = R Exp(w d),   t' = t + v d + a d^2 / 2,
/// with rate w and acceleration a of the IMU half-way between the two. Error O(d^3). Derivatives in
/// the tangent of T_FS, exact for linearly interpolated samples.
struct ExposurePose {
  Transform T_FS;
  Eigen::Matrix<double, 6, 15> by_state;                          ///< of the frame, as boxplus()
  Eigen::Matrix<double, 6, BorderLayout::kFixed> by_calibration;  ///< T_SC0 (zero), gravity, t_d
  Vector6d by_delay;
};
ExposurePose exposurePose(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                          std::size_t i, double delay_s);

/// Which view: of a frame, by a camera.
struct ViewIndex {
  std::size_t frame = 0;
  std::size_t camera = 0;
};

/// Gauss-Newton terms of a view at its exposure (as in PoseGram), unscaled, in the columns: state
/// of the frame (15), T_SC0, gravity and t_d, delay, T_C0Ci, intrinsics (if cameras are free).
struct MovedView {
  static constexpr int kFixed = 15;
  static constexpr int kDelay = kFixed + BorderLayout::kFixed;
  static constexpr int kT_C0Ci = kDelay + 1;
  static constexpr int kIntrinsics = kT_C0Ci + 6;
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double cost = 0;
  double squared_error = 0;
};
MovedView movedView(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                    const GramOptions& gram, const ViewIndex& index);

/// Of the motion by t_d: exact for residuals, smooth for information (smoothOffsetDerivative()).
enum class OffsetDerivative { kExact, kSmooth };

/// Whitened rows of an inertial link k. Columns: state i (15), state j without biases (9), gravity
/// (2), t_d (1), residual (1). Empty where the samples do not cover it.
using MotionRows = Eigen::Matrix<double, 9, 28>;
std::optional<MotionRows> motionRows(const CameraImuProblem& problem,
                                     const CameraImuEstimate& estimate, const ImuWeights& weights,
                                     std::size_t k, OffsetDerivative derivative);

/// Camera c's view of the target in frame i, at its exposure.
Transform targetInCamera(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                         std::size_t i, std::size_t c);

struct CameraImuSolution {
  CameraImuEstimate estimate;
  ImuWeights weights;
  CameraImuNormals normals;  ///< at the estimate
  MinimiserEnd end = MinimiserEnd::kOutOfIterations;
  int iterations = 0;
};

/// Levenberg-Marquardt on the structured normal equations. The inertial weights are renewed after
/// the second step and whenever the time offset has moved by more than 0.2 ms since; a step with
/// new weights never counts as the last one, and it is judged by the old ones where the new raise
/// the cost.
CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const MinimiserOptions& options = {});

/// The same with the inertial weights held as they are.
CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const ImuWeights& weights, const MinimiserOptions& options = {});

}  // namespace plumbline

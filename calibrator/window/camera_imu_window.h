// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/window/linear_prior.h"

namespace plumbline {

/// On the first state (15), T_SC0 (6), gravity's direction (2) and the time offset (1), in the
/// tangents of its point (gravity: angles along tangentBasis()), which has one state.
using CameraImuPrior = LinearPrior<CameraImuEstimate>;
Displacement displacementOf(const CameraImuEstimate& to, const CameraImuEstimate& from);

/// Adds the prior's normal equations and cost to those of a chain that begins with its state.
void addPrior(const CameraImuPrior& prior, const CameraImuEstimate& estimate,
              CameraImuNormals& normals);

/// The chain's terms on its first blocks 0 .. count, and the border, with blocks 0 .. count - 1
/// eliminated one after the other (marginalised()): a cost of (block `count` (15), border), whose
/// noise is that of `corners`, the corners' part of the chain. What the chain holds after block
/// `count` is left out. Empty where a block eliminated is not determined.
std::optional<QuadraticCost> frontEliminated(const BlockArrow& chain, const BlockArrow& corners,
                                             int count);

/// All that problem and prior (on the first state, if there is one) say of frame `count` and the
/// border, the frames before it eliminated (frontEliminated()), by informationAt(). Empty where
/// those are not determined or left the IMU samples.
std::optional<QuadraticCost> frontCost(const CameraImuProblem& problem,
                                       const CameraImuEstimate& estimate, const ImuWeights& weights,
                                       const std::optional<CameraImuPrior>& prior, int count);

/// All terms of the problem's first `count` frames (their corners, the links after them, and the
/// prior on the first state, if there is one) as a prior on the frame after them. Weights of
/// information are used (informationAt()), so that the loss counts by re-weighted squares. The
/// problem's cameras are fixed. Empty where the frames dropped are not determined or left the IMU
/// samples.
std::optional<CameraImuPrior> marginaliseFront(const CameraImuProblem& problem,
                                               const CameraImuEstimate& estimate,
                                               const ImuWeights& weights,
                                               const std::optional<CameraImuPrior>& prior,
                                               int count);

struct CameraImuWindowOptions {
  int states = 3;           ///< frames in the window, at least 2
  int max_iterations = 20;  ///< of minimise(), with every frame
  double tolerance = 0.01;  ///< length of the last step in standard deviations of all parameters
  /// A solution whose last step is still longer than this is none [standard deviations].
  double max_last_step = 1;

  void check() const;  ///< throws InputError; called by the window
};

/// A frame that shall enter a window.
struct WindowFrame {
  TimeNs t = 0;                              ///< camera 0's stamp, later than the window's last
  std::vector<std::vector<Corner>> corners;  ///< per camera; ids ascending; empty: no view
  Transform T_FC0;                           ///< from its own corners
  /// To the frame given before. The biases' walk is the least: two frames cut loose could not tell
  /// the accelerometer's bias from their velocities.
  FrameLink link = FrameLink::kInertial;
};

enum class WindowEnd {
  kSolved,
  kWaiting,    ///< no inertial link reaches the frame: it waits for the next one, which then
               ///< brings it along; without such a link it is dropped
  kNotSolved,  ///< the window with the frame has no solution: it is as it was before
};

/// What a window knows at its last frame.
struct WindowKnowledge {
  /// Of (last state (15), T_SC0 (6), gravity (2), time offset (1)), all earlier states
  /// marginalised.
  Eigen::MatrixXd information;
  CameraImuEstimate estimate;  ///< with the last state alone
  TimeNs t = 0;                ///< of the last frame
  /// Variance of the gradient by these by the noise of corners, of pixel_sigma, alone
  /// (QuadraticCost::noise): what corners bring of the information.
  Eigen::MatrixXd corners{};
};

/// Fixed-lag estimator of the camera-IMU problem (the paper's, for its next best trajectory):
/// poses, velocities and biases of the last few frames, T_SC0 and gravity's direction; every
/// earlier frame stands in a linear prior (CameraImuPrior). Cameras and the time offset are held.
/// With every frame the oldest state is marginalised at its last estimate, and the window is solved
/// with the pre-integration redone at each step. The time offset's column is carried along at its
/// value, so that what is known of it can be asked for.
class CameraImuWindow {
 public:
  /// From a batch over first frames at its solution; of the problem only the last frames stay.
  /// Empty where the frames that leave are not determined. The problem's view stamps, freed cameras
  /// and held calibration are not supported.
  static std::optional<CameraImuWindow> fromBatch(const CameraImuProblem& problem,
                                                  const CameraImuEstimate& estimate,
                                                  const AprilGrid& target,
                                                  const CameraImuWindowOptions& options = {});

  /// Samples after those given before; stamps ascend.
  void addSamples(std::span<const ImuSample> samples);
  /// Samples must cover the frame's link under the time offset.
  WindowEnd add(const WindowFrame& frame);

  const CameraImuEstimate& estimate() const { return estimate_; }
  TimeNs lastStamp() const { return problem_.frames.back().t; }
  const CameraImuProblem& problem() const { return problem_; }
  const std::optional<CameraImuPrior>& prior() const { return prior_; }
  /// Cost of the window and its prior, as last solved.
  double cost() const { return cost_; }
  /// Of the window's corners [px]; 0 without any.
  double rmsePx() const;
  /// At the estimate. Empty where something is not determined (never after kSolved).
  std::optional<WindowKnowledge> knowledge() const;

 private:
  CameraImuWindow() = default;
  WindowEnd addLinked(const WindowFrame& frame);
  void append(const WindowFrame& frame, const ImuState& state);
  ImuState predicted(const WindowFrame& frame) const;
  bool marginaliseOldest();
  bool solve();
  class Steps;  // the window as minimise() wants it
  std::optional<CameraImuNormals> system(const CameraImuEstimate& estimate) const;
  void packCorners();

  CameraImuWindowOptions options_;
  AprilGrid target_;
  CameraImuProblem problem_;
  CameraImuEstimate estimate_;
  ImuWeights weights_;
  std::optional<CameraImuPrior> prior_;
  std::vector<std::vector<std::vector<Corner>>> corners_;  // per frame and camera
  std::optional<WindowFrame> waiting_;
  double cost_ = 0;
  double squared_px_ = 0;
};

/// Information of T_SC0, and with `offset` of the time offset after it, from that of (.., T_SC0
/// (6), gravity (2), time offset (1)), all else marginalised; without `offset` the offset counts as
/// known. Empty where the rest is not determined.
std::optional<Eigen::MatrixXd> calibrationInformation(const Eigen::MatrixXd& information,
                                                      bool offset);

/// True variances over those that the weights assume.
struct NoiseVariances {
  double corners = 1;
  double imu = 1;  ///< of all inertial rows alike
};

/// Covariance of T_SC0 (6) and the time offset (7 x 7) under other noise than assumed:
/// covarianceUnder() of a window. Empty where they are not determined.
std::optional<Eigen::MatrixXd> calibrationCovariance(const WindowKnowledge& known,
                                                     const NoiseVariances& variances);

}  // namespace plumbline

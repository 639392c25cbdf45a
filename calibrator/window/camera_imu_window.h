// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/window/camera_imu_prior.h"
#include "calibrator/window/window_knowledge.h"

namespace plumbline {

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

}  // namespace plumbline

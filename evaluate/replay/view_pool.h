// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/image.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera/view_terms.h"
#include "calibrator/information/predicted_error.h"
#include "evaluate/replay/frame_split.h"

namespace plumbline {

/// Cameras estimated from some frames of a pool.
struct ViewSolution {
  CameraEstimate estimate;  ///< poses of the frames used, ascending
  double entropy_nats = 0;  ///< of the cameras' parameters, poses marginalised
};

/// RMSE of the held-out frames' corners at given cameras [px].
struct HeldOutError {
  double px = 0;
  /// Corners within a tenth of the image's width or height of its border, and the others; 0 where
  /// there are none.
  double border_px = 0;
  double centre_px = 0;
  double loss_px = 0;       ///< sqrt(mean rho(|e|^2)) over all
  double border_share = 0;  ///< of the corners
};

/// A recording made ready to be calibrated on many selections of its frames: corners packed once,
/// and a start for every pose. The session must outlive it.
class ViewPool {
 public:
  /// Calibrates all frames (from scratch, or options.start) for first poses and the corners to
  /// leave out, and then the split's pool, which is the reference that every selection starts from.
  /// The split counts frames as paired by `options.frames`.
  /// Of the held-out frames at most `max_held_out` are kept, evenly spread. Fails as
  /// calibrateCameras().
  static Result<ViewPool> prepare(const Session& session, const FrameSplit& split,
                                  const CameraStageOptions& options, int max_held_out);

  const Session& session() const { return *session_; }
  /// All frames of the recording, and which of them (with a plausible pose) are in the two parts.
  const std::vector<Frame>& frames() const { return frames_; }
  const std::vector<int>& pool() const { return split_.pool; }
  const std::vector<int>& heldOut() const { return split_.held_out; }
  /// The solution of the whole pool.
  const ViewSolution& reference() const { return reference_; }

  /// Batch over these frames of the pool, in whatever order they are named; empty where they do not
  /// determine the cameras, or the solver does not converge.
  std::optional<ViewSolution> solve(std::vector<int> frames) const;

  /// Of the held-out frames, where only poses move.
  HeldOutError heldOutError(const CameraEstimate& cameras) const;

  /// What each frame of the pool tells of the cameras at the reference, its pose eliminated.
  std::vector<Eigen::MatrixXd> poolInformation() const;

  /// Frames of the recording at other cameras, their poses where their corners want them.
  struct PosedFrames {
    std::vector<RigView> views;   ///< one per frame asked for
    std::vector<double> rmse_px;  ///< of each, whatever the loss
  };
  PosedFrames posed(const CameraEstimate& cameras, const std::vector<int>& frames) const;

  /// Of the loss of every batch; 0 without.
  double cauchyPx() const { return options_.cauchy_px; }

  /// Errors of some frames' used corners at the reference [px], with where in the image they are.
  struct ImageError {
    double squared_px = 0;
    bool is_border = false;
  };
  std::vector<ImageError> referenceErrors(const std::vector<int>& pool_frames) const;

 private:
  ViewPool() = default;
  CameraProblem problemOf(const std::vector<int>& frames) const;
  RigView posedView(const CameraEstimate& cameras, int f) const;
  void addErrors(const CameraEstimate& cameras, int frame, const Transform& T_C0F,
                 std::vector<ImageError>& out) const;

  const Session* session_ = nullptr;
  CameraStageOptions options_;
  std::vector<PackedCorners> corners_;
  std::vector<Frame> frames_;
  std::vector<Transform> T_C0F_;  // per frame; identity where it has no pose
  FrameSplit split_;
  ViewSolution reference_;
};

}  // namespace plumbline

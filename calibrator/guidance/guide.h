// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/results.h"
#include "calibrator/guidance/guide_frame.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

class CameraGuide;
class CameraImuGuide;

/// The paper's interactive guide as a state machine over frames, driven by whoever has them.
///
/// First the camera stage (next best view), unless `cameras` are given; when it finishes, its views
/// are solved in batch, and the camera-IMU stage (next best trajectory) begins with the frames that
/// follow. Time is that of the frames: equal frames and options give equal decisions, whatever the
/// threads and the speed at which step() is called.
class Guide {
 public:
  Guide(const GuideRig& rig, const GuideOptions& options,
        std::optional<std::vector<CameraCalibration>> cameras = std::nullopt);
  ~Guide();
  Guide(Guide&&) noexcept;
  Guide& operator=(Guide&&) noexcept;

  /// Frames in the order in which they arrive.
  Decision step(const GuideFrame& frame);

  /// Nothing is left to ask for.
  bool finished() const;

  /// The final batch of a stage over the frames that it kept: what the operator is given. Before
  /// the stage finishes: over those kept so far.
  Result<CameraStageResult> cameraBatch() const;
  Result<CameraImuStageResult> cameraImuBatch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plumbline

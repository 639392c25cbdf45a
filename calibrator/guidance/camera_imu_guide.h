// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/results.h"
#include "calibrator/guidance/guide_frame.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// The camera-IMU stage of the Guide: next best trajectory (paper, section V). The cameras stay as
/// they are given.
class CameraImuGuide {
 public:
  /// What the stage before leaves.
  struct Begin {
    int first_suggestion = 0;  ///< suggestions are numbered from it
    /// Frames before it are dropped (their IMU samples are not).
    TimeNs busy_until = std::numeric_limits<TimeNs>::min();
  };
  /// Needs rig.imu.
  CameraImuGuide(const GuideRig& rig, std::vector<CameraCalibration> cameras,
                 const GuideOptions& options, const Begin& begin);
  CameraImuGuide(const GuideRig& rig, std::vector<CameraCalibration> cameras,
                 const GuideOptions& options);
  ~CameraImuGuide();
  CameraImuGuide(CameraImuGuide&&) noexcept;
  CameraImuGuide& operator=(CameraImuGuide&&) noexcept;

  Decision step(const GuideFrame& frame);
  bool finished() const;
  TimeNs busyUntil() const;
  int nextSuggestion() const;
  /// Batch over the frames kept so far, time offset included.
  Result<CameraImuStageResult> batch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plumbline

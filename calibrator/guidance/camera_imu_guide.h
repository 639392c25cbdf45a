// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
  /// Needs rig.imu. Suggestions are numbered from `first_suggestion`.
  CameraImuGuide(const GuideRig& rig, std::vector<CameraCalibration> cameras,
                 const GuideOptions& options, int first_suggestion = 0);
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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/frame_corners.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// A frame whose corners gave a pose; of the cameras with too few there are none.
struct PosedFrame : KeptFrame {
  Transform T_FC0 = {};
  bool after_jump = false;  ///< the frames paused before it for too long
};

/// The frame with the views of at least `min_corners` corners, and camera 0's pose by them alone.
/// Empty where they give none, or one that leaves more than `max_rms_px`. Throws InputError for
/// fewer than four corners (of one tag) or an error that is not positive.
std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras, int min_corners,
                                    double max_rms_px);

/// All that has arrived in the camera-IMU stage: IMU samples, and the frames kept.
class ImuStageRecording {
 public:
  ImuStageRecording(GuideRig rig, const GuideOptions& options);

  /// Takes the samples that are later than those before; the others are passed over.
  /// Returns how many were taken.
  int addSamples(std::span<const ImuSample> samples);
  void keep(PosedFrame frame) { frames_.push_back(std::move(frame)); }
  /// The frame of this position in the recording, which was accepted, leaves; says why
  /// (withdraw()).
  void drop(int index, const std::string& why, Decision& decision);

  const std::vector<ImuSample>& samples() const { return samples_; }
  const std::vector<PosedFrame>& frames() const { return frames_; }

  /// Longest pause between samples that counts as none [s]: five times their median interval.
  double longestInterval() const;
  /// The longest pause between samples above that, in [from, to] of the IMU's clock [s].
  std::optional<double> gapWithin(TimeNs from, TimeNs to) const;
  /// Whether the samples reach this instant of the IMU's clock.
  bool covers(TimeNs t_imu) const { return !samples_.empty() && samples_.back().t >= t_imu; }
  double cameraRateHz() const;  ///< by the median interval between frames kept

  /// The kept frames and all samples.
  Session session() const;
  CameraImuOptions batchOptions() const;

 private:
  GuideRig rig_;
  GuideOptions options_;
  std::vector<ImuSample> samples_;
  std::vector<PosedFrame> frames_;
};

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "calibrator/guidance/imu_stage_recording.h"

namespace plumbline {

/// Noise of this stage over that assumed, as residuals show it. With the first frames, and whenever
/// half as many have come, a batch over the frames kept judges corners and IMU (checkImuNoise());
/// between batches the corners' share of E (ImuReprojection) changes much more than the noise does.
struct StageNoise {
  /// Of a corner that explains the noise of poses, over that of its residual: errors that the
  /// corners of a view share. At least 1.
  double shared_px = 1;
  /// One variance for all inertial rows: the one under which E of the batch is what it is under
  /// those of gyroscope, accelerometer and biases (covarianceUnder()).
  double imu_variance = 1;
};

/// An answer is there `latency_s` after the frame that asked.
class NoiseWatch {
 public:
  NoiseWatch(std::vector<CameraCalibration> cameras, double latency_s, int threads)
      : cameras_(std::move(cameras)), latency_s_(latency_s), threads_(threads) {}

  /// Asks, if it is time to, for the frames kept until `t`.
  void look(TimeNs t, const ImuStageRecording& recording);
  /// As answered last; empty before. A batch that fails leaves it as it was.
  std::optional<StageNoise> noiseAt(TimeNs t);

 private:
  std::vector<CameraCalibration> cameras_;
  double latency_s_;
  int threads_;
  std::size_t next_frames_ = 0;  // number of frames kept that asks again
  TimeNs asked_ = 0;
  std::future<std::optional<StageNoise>> answer_;
  std::optional<StageNoise> noise_;
};

}  // namespace plumbline

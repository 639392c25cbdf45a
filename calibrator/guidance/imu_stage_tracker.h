// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/guide_stage.h"
#include "calibrator/window/camera_imu_window.h"

namespace plumbline {

using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// How camera and IMU are used together later: points at these distances, all over the images,
/// looked for where the IMU's motion puts them. Motions have every direction alike.
struct ImuUse {
  std::array<double, 3> ranges_m{1, 3, 10};
  double speed_m_s = 1;       ///< RMS of the sensor's velocity
  double rate_rad_s = 1;      ///< RMS of its rate
  int columns = 9, rows = 7;  ///< grid of pixels over each image
};

/// By how much errors of T_SC0 and of the time offset shift the points that the IMU predicts.
///
/// At the stamp t of a frame the IMU says where the sensor was at t + t_d, and T_SC0 where the
/// camera was. With errors d of T_SC0 (tangent of Transform) and e of t_d a point fixed in the
/// world is looked for at the twist
///   x = A d - e B (v, omega),   p' = p + x_rho + x_phi x p   (camera frame),
/// A as in cameraImuChain(), B the adjoint of T_CiS, v and omega the sensor's velocity and rate in
/// its own frame. The mean square of the shift of the pixel over points, cameras and motions is
///   (d, e)^T M (d, e),   M = mean J^T J   [px^2 per (m, rad, s) squared],
/// in which d and e do not mix, for motions of opposite direction are as frequent. With the
/// covariance S of (d, e) the expected squared error is E = tr(M S) [px^2].
class ImuReprojection {
 public:
  /// Pixels that the models cannot unproject are left out.
  explicit ImuReprojection(const std::vector<CameraCalibration>& cameras, const ImuUse& use = {});

  /// M at this T_SC0: rows and columns T_SC0 (3 m, 3 rad), time offset (s).
  Matrix7d gram(const Transform& T_SC0) const;
  /// E [px^2] from the information of T_SC0 and time offset (7 x 7); empty where that is singular.
  std::optional<double> expectedError(const Eigen::MatrixXd& information,
                                      const Transform& T_SC0) const;
  /// E [px^2] from their covariance (7 x 7).
  double expectedErrorUnder(const Eigen::MatrixXd& covariance, const Transform& T_SC0) const;
  /// By how much points are off with `a` from where `b` puts them: sqrt((d, e)^T M (d, e)) [px].
  double differencePx(const ImuCalibration& a, const ImuCalibration& b) const;

 private:
  struct Camera {
    Transform T_C0Ci;
    Matrix6d H;  // mean of J^T J over points, J the pixel's derivative by the twist
  };
  ImuUse use_;
  std::vector<Camera> cameras_;
};

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

/// The window of the camera-IMU stage and how frames come into it: one waits until IMU samples
/// reach it under the time offset, and is joined to the frame before by them or, across a pause of
/// the samples or of the frames, by the biases' walk alone. What became of a frame is written to
/// the decision of the frame that is at hand.
class ImuStageTracker {
 public:
  /// Frames further apart than `max_gap_s` are joined by the biases' walk alone.
  ImuStageTracker(CameraImuWindow window, double max_gap_s);

  const CameraImuWindow& window() const { return window_; }
  void addSamples(std::span<const ImuSample> samples) { window_.addSamples(samples); }
  void add(PosedFrame frame) { pending_.push_back(std::move(frame)); }
  /// Puts the frames that the recording's samples reach by now into the window. A frame without a
  /// solution is dropped from the recording.
  void drain(ImuStageRecording& recording, Decision& decision);

 private:
  FrameLink linkTo(const PosedFrame& frame, const ImuStageRecording& recording,
                   Decision& decision) const;
  void enter(const PosedFrame& frame, ImuStageRecording& recording, Decision& decision);

  CameraImuWindow window_;
  double max_gap_s_;
  TimeNs last_given_;        // stamp of the frame given to the window last
  std::optional<int> held_;  // position of the frame that the window holds back
  std::deque<PosedFrame> pending_;
};

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

/// A window, and the stamps of all frames in the batch that it began with, ascending.
struct ImuWindowStart {
  CameraImuWindow window;
  std::vector<TimeNs> stamps;
};

/// The window on the first frames of the camera-IMU stage: their batch (the time offset by
/// correlation and refined in it, then fixed), of which all but the last frames become the window's
/// prior. Frames at the end that IMU samples do not cover yet are left out, as are those that the
/// batch has no use for. Fails where calibrateCameraImu() does or where it did not converge.
Result<ImuWindowStart> startImuWindow(const ImuStageRecording& recording,
                                      const std::vector<CameraCalibration>& cameras,
                                      const TrajectoryGuideOptions& options);

}  // namespace plumbline

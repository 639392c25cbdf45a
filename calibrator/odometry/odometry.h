// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/odometry/rig_model.h"
#include "calibrator/odometry/start_estimate.h"
#include "calibrator/odometry/window.h"

namespace plumbline {

struct OdometryOptions {
  double pixel_sigma = 0.7;          ///< standard deviation of a track's coordinate [px]
  int keyframes = 10;                ///< kept in the window
  int recent_frames = 4;             ///< of the newest frames, kept whether keyframes or not
  double keyframe_parallax_px = 12;  ///< mean, without rotation, since the last keyframe
  double keyframe_share = 0.6;       ///< of the last keyframe's tracks; fewer: a new keyframe
  double keyframe_interval_s = 2;    ///< at the latest
  double start_span_s = 0.75;        ///< of the frames that the start uses
  double mono_start_span_s = 2;      ///< the same with one camera, whose scale the IMU alone knows
  int iterations = 4;                ///< of the window, a frame
  bool covariances = false;          ///< of the poses: a third more time
  double gate = 3;                   ///< a sighting farther off is dropped [sigma]
  double still_px = 0.3;             ///< median movement in still_span_s of a rig that stands
  double still_span_s = 0.25;
  double max_imu_gap_s = 0.1;  ///< between samples; longer: the motion is lost
  double max_blind_s = 1;      ///< on the IMU alone; longer: the motion is lost
  WindowModel model;
  StartOptions start;
  TriangulationLimits triangulation;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Why the estimate was begun anew.
enum class OdometryLoss {
  kImuGap,    ///< no samples between two frames
  kBlind,     ///< too few tracks for too long
  kDiverged,  ///< tracks that no longer fit, a velocity or bias beyond what can be, states that
              ///< nothing determines
};
constexpr std::array<const char*, 3> enumWords(OdometryLoss /*of*/) {
  return {"imu-gap", "blind", "diverged"};
}

/// The pose of a frame, and what is known of it.
struct OdometryPose {
  TimeNs t = 0;    ///< camera clock
  ImuState state;  ///< in W
  /// Of (dt, da) against the first frame's position and yaw, when it was last written; zero unless
  /// asked for.
  Matrix6d covariance = Matrix6d::Zero();
  bool keyframe = false;
};

struct OdometryLossEvent {
  TimeNs t = 0;  ///< first frame that could not be placed
  OdometryLoss cause = OdometryLoss::kImuGap;
};

/// How far a frame's sightings lay from where the IMU predicted them.
struct FrameInnovation {
  TimeNs t = 0;        ///< camera clock
  double squares = 0;  ///< sum of whitened squared errors, each at most 9
  int count = 0;       ///< of sightings
};

/// What an odometry made of its frames.
struct OdometryResult {
  std::vector<OdometryPose> poses;        ///< ascending; none before the start
  std::vector<OdometryLossEvent> losses;  ///< after each the poses continue elsewhere: a jump
  int frames = 0;                         ///< offered
  double mean_landmarks = 0;              ///< placed, a frame
  /// Medians that tell of the calibration without any truth, 0 without a sighting: the distance of
  /// sightings by other cameras from the epipolar lines of camera 0's, and the error of sightings
  /// at the pose that the IMU predicts, landmarks as they were known before [px].
  double stereo_px = 0, innovation_px = 0;
  std::vector<FrameInnovation> innovations;  ///< of every frame that was predicted
};

/// Visual-inertial odometry with a fixed lag: tracks and IMU samples to a trajectory, with the
/// calibration taken as it is. A window of keyframes and of the newest frames, 15 states each, and
/// the landmarks they see; minimised at every frame (WindowProblem), what leaves it is kept as a
/// linear prior (marginaliseOldest). A frame that is no keyframe leaves without its sightings, and
/// the IMU is integrated anew over it. Starts by itself, at rest or in motion (startEstimate).
/// Deterministic: one thread, no clock, no random numbers.
class Odometry {
 public:
  /// `samples` (IMU clock, strictly ascending) outlive it.
  Odometry(RigModel rig, std::span<const ImuSample> samples, OdometryOptions options = {});

  /// Takes the next frame; stamps ascend strictly. One after the last sample has no pose, and is no
  /// loss.
  void step(const FrameTracks& frame);

  /// R_SaSb of the gyro between two stamps of the camera's clock, with the bias known by now:
  /// what a tracker can expect. Over a pause of the samples their readings count as linear;
  /// identity where they do not reach from one stamp to the other.
  Eigen::Matrix3d expectedRotation(TimeNs from, TimeNs to) const;

  bool isRunning() const { return !window_.frames.empty(); }
  const Window& window() const { return window_; }
  OdometryResult result() const;

 private:
  void begin(const FrameTracks& frame);
  void fillFrom(const StartEstimate& start);
  bool startHolds() const;
  void lose(TimeNs t, OdometryLoss cause);
  bool append(const FrameTracks& frame);
  void addFrame(const FrameTracks& tracks, const ImuState& state, bool keyframe, bool still);
  std::optional<ImuLink> linkBetween(TimeNs from, TimeNs to, const ImuBias& bias) const;
  void placeLandmarks();
  void rememberInnovations();
  void rememberEpipolar(const FrameTracks& frame);
  void optimise(int iterations);
  void gate();
  bool isKeyframe(const FrameTracks& frame) const;
  bool stands() const;
  bool stoodWhileWaiting() const;
  bool shrink();
  bool dropOldest();
  void remember();
  void rememberCovariances();
  bool isSane() const;
  std::optional<OdometryLoss> isLost(const FrameTracks& frame);
  double startSpan() const;

  RigModel rig_;
  std::span<const ImuSample> samples_;
  OdometryOptions options_;
  Window window_;
  std::vector<FrameTracks> waiting_;  // before the start
  std::deque<FrameTracks> latest_;    // the last still_span_s
  std::int64_t next_serial_ = 0;
  std::int64_t last_keyframe_ = -1;
  std::map<std::int64_t, Eigen::Vector3d> keyframe_rays_;  // of camera 0, by track
  Transform resume_;                                       // where the next start begins
  ImuBias last_bias_;
  TimeNs last_fit_ = 0;                          // last frame whose tracks fitted
  std::map<std::int64_t, std::size_t> pose_of_;  // by serial, of the frames in the window
  OdometryResult result_;
  double landmark_sum_ = 0;
  std::size_t remembered_ = 0;  // frames that landmark_sum_ is of
  std::vector<float> epipolar_px_, innovations_px_;
};

}  // namespace plumbline

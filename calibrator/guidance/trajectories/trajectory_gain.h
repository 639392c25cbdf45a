// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "calibrator/guidance/trajectories/imu_reprojection.h"
#include "calibrator/guidance/trajectories/lissajous.h"
#include "calibrator/information/predicted_error.h"
#include "calibrator/window/window_knowledge.h"

namespace plumbline {

/// How a trajectory would be recorded.
struct TrajectoryRecording {
  static constexpr double kPause_s = 2;  ///< from now to the trajectory's first frame

  AprilGrid target;
  double camera_rate_hz = 20;
  double imu_rate_hz = 200;
  ImuNoise noise;
  double gravity_m_s2 = MeasurementModel().gravity_m_s2;
  double pixel_sigma = 1;     ///< standard deviation of a corner, per axis [px]
  int min_corners = 16;       ///< views of one camera with fewer count for nothing
  bool score_offset = false;  ///< the time offset counts beside T_SC0

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Of trajectories, in their order. NaN: nothing can be said.
struct TrajectoryScores {
  std::vector<double> gain_nats;  ///< expected information gain
  /// What points that the IMU predicts are expected to be off by with the trajectory, squared:
  /// E = tr(M S) [px^2] (ImuReprojection), the time offset always included.
  std::vector<double> squared_px;
};

/// What a trajectory's measurements would add, about T_SC0 (and the time offset), to what is known
/// now: 0.5 (log det after - log det before) [nats].
///
/// Camera frames and IMU samples are simulated without noise along the trajectory: corners through
/// T_FC0 and the cameras' extrinsics, the IMU through the present T_SC0, with the present biases,
/// gravity and time offset. The trajectory brings states of its own (a pose, a velocity and biases
/// with every frame), all marginalised. Shared with the present are T_SC0, the time offset, the
/// direction of gravity, and the biases: those of the trajectory's first frame follow from the
/// present ones by their walk over kPause_s. No pose or velocity is carried over. Cameras are
/// fixed. Information is that of the batch (informationAt()), without loss, for residuals are zero.
class TrajectoryScorer {
 public:
  /// Prepares what no estimate changes: motions, and what the cameras see along them.
  TrajectoryScorer(const TrajectoryRecording& recording,
                   std::vector<LissajousTrajectory> trajectories,
                   const std::vector<CameraCalibration>& cameras);

  const std::vector<LissajousTrajectory>& trajectories() const { return trajectories_; }

  /// Of each trajectory; NaN where nothing can be said: no camera sees min_corners in some frame
  /// along it, or something is not determined. Equal for any number of threads.
  TrajectoryScores scores(const WindowKnowledge& now, int threads = 1) const;
  /// E of what is known now [px^2] under this noise (calibrationCovariance()); empty where the time
  /// offset, or T_SC0, is not determined.
  std::optional<double> squaredPx(const WindowKnowledge& now,
                                  const NoiseVariances& variances = {}) const;

 private:
  /// A trajectory without what depends on the estimate.
  struct Prepared {
    std::vector<MotionState> frames;   // of camera 0, with every frame
    std::vector<MotionState> samples;  // of camera 0, with every IMU sample
    /// Per frame and camera, the information of the target's pose in that camera; zero: not seen.
    std::vector<std::vector<Matrix6d>> views;
    bool loses_target = false;  // some frame is seen by no camera
  };
  Prepared prepare(const LissajousTrajectory& trajectory) const;
  CameraImuProblem unseen(const Prepared& prepared, const WindowKnowledge& now) const;
  void addViews(const Prepared& prepared, const CameraImuEstimate& estimate,
                BlockArrow& chain) const;
  std::optional<Eigen::MatrixXd> informationWith(const Prepared& prepared,
                                                 const WindowKnowledge& now,
                                                 const Eigen::MatrixXd& carried) const;

  TrajectoryRecording recording_;
  std::vector<LissajousTrajectory> trajectories_;
  std::vector<CameraCalibration> cameras_;
  ImuReprojection reprojection_;
  std::vector<Prepared> prepared_;
};

/// When scores are asked for and when they are there, in the recording's time.
struct EvaluatorTiming {
  double every_s = 1;    ///< from one start to the next
  double latency_s = 0;  ///< from the frame whose estimate is scored to the answer
  int threads = 1;       ///< 2 or more: scores are computed beside the frames that follow
  ViewCriterion criterion = ViewCriterion::kMutualInformation;  ///< what makes a trajectory best
};

/// Scores all trajectories on snapshots of the estimate. What comes out, and when, depends on the
/// frames' stamps alone.
class TrajectoryEvaluator {
 public:
  TrajectoryEvaluator(TrajectoryScorer scorer, const EvaluatorTiming& timing);

  const TrajectoryScorer& scorer() const { return *scorer_; }
  /// Whether a new evaluation should start with the frame at `t`: the last one was answered, and it
  /// was asked for long enough ago, or before what answerBy() wants.
  bool isDue(TimeNs t) const;
  /// Besides, an evaluation is due early enough to be answered at `t`.
  void answerBy(TimeNs t) { also_due_ = t - toNanoseconds(timing_.latency_s); }
  /// Predicted errors are multiplied by `error_scale`.
  void ask(TimeNs t, WindowKnowledge now, double error_scale = 1);
  /// The scores, once, with the first frame at or after their time.
  std::optional<CandidateRound> answerAt(TimeNs t);

 private:
  std::shared_ptr<const TrajectoryScorer> scorer_;
  EvaluatorTiming timing_;
  std::optional<TimeNs> asked_;  // the last one
  std::optional<TimeNs> also_due_;
  double error_scale_ = 1;  // of the last one
  std::future<TrajectoryScores> scores_;
};

}  // namespace plumbline

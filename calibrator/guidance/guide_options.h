// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/enum_words.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/view_terms.h"
#include "calibrator/guidance/operator_pace.h"
#include "calibrator/information/predicted_error.h"

namespace plumbline {

/// 0.2 bits in nats: the threshold of Kalibr and of the paper.
inline constexpr double kGuideThresholdNats = 0.2 * 0.693147180559945309;

/// When a suggestion counts as reached, and when it is given up.
struct ReachRule {
  double reached_px = 30;  ///< within this mean corner distance [px] ...
  double reached_s = 0.3;  ///< ... held for so long [s]
  double expires_s = 10;   ///< not reached by then: it counts as not followed [s]

  /// Of a guide's options, whose part `of` names (OpenSuggestion also takes one that never
  /// expires): throws InputError naming the field that is out of its range.
  void check(const std::string& of) const;
};

/// How views are scored by their information. The loss of the measurement model weights the corners
/// of frames that were seen.
struct ViewGainOptions : MeasurementModel {
  int min_corners = 16;  ///< of one camera, for its view to count

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// And by the predicted error.
struct ViewErrorOptions : ViewGainOptions {
  /// What later use looks like: the frames seen so far, or evenly over the image, where candidate
  /// views put corners.
  LaterUseKind later_use = LaterUseKind::kImage;
  int most_seen = 60;  ///< frames that stand for those seen so far, evenly spread over them

  void check() const;
};

/// Next best view of the paper.
struct ViewGuideOptions : ViewErrorOptions, ReachRule {
  int start_frames = 5;       ///< the first N frames with the target in view start the estimate ...
  double start_move_px = 15;  ///< ... that moved by this mean corner distance since the one before
  /// So many frames in a row without plausible pose, before as many had one: the start was wrong,
  /// and the stage restarts.
  int start_anew_after = 10;
  int window = 10;                              ///< views in the fixed-lag window
  double threshold_nats = kGuideThresholdNats;  ///< views that gain less are removed
  ViewCriterion criterion = ViewCriterion::kMutualInformation;
  /// Of kPredictedError: by which share a view must lower E; and the stage is over when E raises
  /// the error of a corner by no more than `stop_excess`, with `stop_views` or more that tell the
  /// parts of the misfit apart.
  double least_lowering = 0.05;
  double stop_excess = 0.02;
  int stop_views = 8;
  /// Whatever the criterion: if positive, the stage is over when, and only when, the projections of
  /// the worst camera are predicted to be off by no more than this (Decision::projection_px)
  /// [px].
  double stop_projection_px = 0;
  /// Frames without a new view until a next best view is looked for; 0: whenever none is open.
  int patience = 0;
  int min_views = 0;  ///< never finish with fewer views

  void check() const;
};

/// When the camera-IMU stage asks for its first trajectory.
enum class FirstTrajectory {
  /// Before any can be scored (lissajousFirst()), with the first frame from which the target stays
  /// in view on the way to it; kScored where it does not along the trajectory itself. The frames
  /// that start the estimate are gathered on the way to it and along it.
  kAtOnce,
  kScored,  ///< once the estimate has started, the best by the criterion
};
constexpr std::array<const char*, 2> enumWords(FirstTrajectory /*of*/) {
  return {"at-once", "scored"};
}

/// How the curves of LissajousShape are run along.
struct LissajousOptions {
  double roll_rad = 0;   ///< turned about the line of sight by so much to either side [rad]
  double amplitude = 1;  ///< multiplies A and B; both shrink where the curve would come within
                         ///< 15 degrees of the target's plane
  double distance_ratio = 1.2;  ///< R over the target's longer side
  double duration_s = 5;        ///< longer where a limit asks for it
  double max_speed_m_s = 1.5;
  double max_rate_rad_s = 3.14159265358979;
  double max_acceleration_m_s2 = 9.80665;  ///< without gravity

  /// Throws InputError naming the field that is out of its range, after the part `of` of options.
  void check(const std::string& of = "") const;
};

/// Next best trajectory of the paper. The defaults make operators fast
/// (docs/counterfactuals.md); GuideOptions::patient() is closer to the paper's program.
struct TrajectoryGuideOptions : MeasurementModel, LissajousOptions, ReachRule {
  int start_frames = 20;  ///< frames that start the estimate, more than window; more as it takes
  int window = 3;         ///< states in the fixed-lag window
  int min_corners = 16;
  double threshold_nats = kGuideThresholdNats;
  bool score_offset = false;  ///< the time offset counts beside T_SC0
  /// By which trajectories are chosen. Of kPredictedError: by which share one must lower E, the
  /// squared error of points that the IMU predicts (ImuReprojection), to be worth asking for.
  ViewCriterion criterion = ViewCriterion::kMutualInformation;
  double least_lowering = 0.05;
  /// Whatever the criterion: if positive, the stage is over when, and only when, sqrt(E) is no more
  /// than this [px].
  double stop_reprojection_px = 0;
  FirstTrajectory first = FirstTrajectory::kAtOnce;
  double evaluate_every_s = 1;  ///< the evaluator starts again this long after its last start [s]

  /// A start is reached on the way through it.
  TrajectoryGuideOptions()
      : LissajousOptions{.roll_rad = 60 * kDegree, .amplitude = 1.5, .duration_s = 2},
        ReachRule{.reached_px = 50, .reached_s = 0.1} {}

  void check() const;
};

/// What a step costs in the recording's time. A frame that comes while the guide is busy is
/// dropped; candidate views are scored in the step, trajectories beside it.
struct GuideLatency {
  double camera_start_s = 0;  ///< each attempt to start the camera stage
  double camera_frame_s = 0;
  double next_view_s = 0;
  double camera_batch_s = 0;  ///< once, when the stage finishes
  double imu_start_s = 0;     ///< each attempt to start the camera-IMU stage
  double imu_frame_s = 0;
  double trajectories_s = 0;
  /// Once, when the stage finishes; and beside the frames, from a batch that judges the noise to
  /// its answer.
  double imu_batch_s = 0;

  void check() const;
};

struct GuideOptions {
  ViewGuideOptions views;
  TrajectoryGuideOptions trajectories;
  OperatorPace pace;
  GuideLatency latency;
  /// The camera stage ends so long after its first frame, whatever it would still ask for [s]; 0:
  /// when it says so.
  double camera_stage_s = 0;
  double lost_target_s = 2;    ///< without the target for longer: said in the log [s]
  double max_frame_gap_s = 1;  ///< a pause between frames longer than this is a jump [s]
  int threads = 1;             ///< decisions do not depend on it

  /// As the paper's program has it, and the defaults were once. Views: asked for where three frames
  /// in a row gained too little, and held for half a second within 15 px. Trajectories: scored
  /// before the first one, a second at each one's start, of their own size and without roll; and 5
  /// s for each (the program: 3 s).
  static GuideOptions patient();

  /// Throws InputError naming the field that is out of its range; of every part.
  void check() const;
};

/// What the guide knows of the sensor before it sees anything.
struct GuideRig {
  struct Camera {
    std::string name;
    Resolution resolution;
    CameraModelPair model;
  };
  AprilGrid target;
  std::vector<Camera> cameras;
  std::optional<ImuNoise> imu;  ///< empty: no IMU, no camera-IMU stage
};

/// All that arrives up to and with one camera frame.
struct GuideFrame {
  int index = 0;                             ///< position in the recording
  TimeNs t = 0;                              ///< stamp, camera 0's clock
  std::vector<std::vector<Corner>> corners;  ///< per camera; ids ascending; empty: no view
  std::vector<ImuSample> imu;  ///< samples since the frame before, ascending; stamps as recorded
};

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/error.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// What the guide is calibrating.
enum class GuideStage { kCamera, kCameraImu };
constexpr std::array<const char*, 2> enumWords(GuideStage /*of*/) {
  return {"camera", "camera-imu"};
}

/// What the guide is doing after a frame.
enum class GuideMode {
  kInitialising,  ///< gathers the first frames of a stage
  kCollecting,    ///< takes every frame that tells enough
  kSuggesting,    ///< the same, with a suggestion open
  kFinished,      ///< this stage is over
};
constexpr std::array<const char*, 4> enumWords(GuideMode /*of*/) {
  return {"initialising", "collecting", "suggesting", "finished"};
}

/// Why a frame was treated as it was.
enum class GuideReason {
  kInitialising,      ///< kept for the start
  kInitialised,       ///< the start stands with this frame
  kInitialiseFailed,  ///< the start was tried with this frame and did not succeed
  kInformative,       ///< its gain reaches the threshold (or is unbounded), by the criterion used
  kNotInformative,    ///< its gain is below the threshold
  kUsed,              ///< camera-IMU stage: every frame enters the window
  kBusy,              ///< came before the guide was done with an earlier one: dropped
  kNoTarget,          ///< too few corners in every camera
  kNoPose,            ///< its corners give no plausible pose
  kBadFit,            ///< its corners leave far more error than those of the views kept
  kTimeJump,          ///< its stamp is not after the frame before, or far after it (not used);
                      ///< or the window was cut loose here
  kNoImu,             ///< IMU samples do not cover it
  kImuGap,            ///< IMU samples are missing between it and the frame before
  kNotSolved,         ///< the window with it did not converge: left out
  kFinished,          ///< the stage was over before
};
constexpr std::array<const char*, 15> enumWords(GuideReason /*of*/) {
  return {"initialising", "initialised", "initialise-failed", "informative", "not-informative",
          "used",         "busy",        "no-target",         "no-pose",     "bad-fit",
          "time-jump",    "no-imu",      "imu-gap",           "not-solved",  "finished"};
}

/// What happened to the suggestion on a frame.
enum class SuggestionEvent {
  kNone,
  kOpened,
  kReached,
  kExpired,
  kWithdrawn,  ///< the stage finished or restarted while it was open
};
constexpr std::array<const char*, 5> enumWords(SuggestionEvent /*of*/) {
  return {"none", "opened", "reached", "expired", "withdrawn"};
}

/// A view or trajectory that the guide asked for.
struct Suggestion {
  int id = 0;  ///< counts from 0 over both stages
  GuideStage stage = GuideStage::kCamera;
  TimeNs t = 0;                      ///< when it was shown
  std::string candidate;             ///< "cam0 x -0.50 y +0.25 tilt-x 30" or "figure 8 horizontal"
  int camera = 0;                    ///< for whose image the view was made; 0 for a trajectory
  Transform T_FC0;                   ///< the view; for a trajectory, its start
  std::vector<Transform> path;       ///< T_FC0 along a trajectory; empty for a view
  std::optional<double> duration_s;  ///< of a trajectory, start to end [s]; empty for a view
  double mi_nats = 0;                ///< predicted gain; 0: asked for before any could be scored
  /// Predicted error in later use with it [px]; empty before it is known.
  std::optional<double> error_px;
  /// Predicted time until it is reached, by OperatorPace [s]; empty: the camera's pose is not
  /// known.
  std::optional<double> reach_s;
};

/// Scores of all candidates at one time.
struct CandidateRound {
  TimeNs asked = 0;     ///< stamp of the frame whose estimate they stand on
  TimeNs answered = 0;  ///< recording's time at which the answer was there
  std::vector<std::string> names;
  std::vector<Transform> T_FC0;  ///< of the view, or of the trajectory's start
  /// Gain of each; NaN: it could not be scored (no tag in view, unreachable limits, ...).
  std::vector<double> mi_nats;
  /// Predicted error in later use with each [px], NaN as above; empty: not known.
  std::vector<double> error_px;
  /// Predicted time until each is reached [s]; empty: it does not count.
  std::vector<double> reach_s;
  int best = -1;  ///< the best by the criterion; -1: none could be scored
};

/// What the guide did with one frame. Scores in nats; every number that drove it is here.
struct Decision {
  TimeNs t = 0;   ///< the frame's stamp (camera 0's clock)
  int frame = 0;  ///< its position in the recording
  GuideStage stage = GuideStage::kCamera;
  GuideMode mode = GuideMode::kInitialising;  ///< after the frame
  GuideReason reason = GuideReason::kInitialising;
  bool accepted = false;  ///< the frame entered the estimate
  /// Frames accepted before that left the estimate with this one: no pose, no solution, not used by
  /// the start, a start that was given up, or a first frame with a wrong stamp.
  std::vector<int> withdrawn;
  std::optional<double> mi_nats;  ///< its gain; infinite: the views before left parameters free
  std::optional<double> entropy_nats;  ///< of the calibration parameters, after the frame
  double threshold_nats = 0;           ///< what the gain was held against
  /// Predicted error in later use, sqrt(E) (information/predicted_error.h; of points that the IMU
  /// predicts), of the views kept after the frame, and with this frame [px]; empty: not known.
  std::optional<double> error_px, error_with_px;
  /// What it was held against (error_px in the camera-IMU stage); empty: the gain decides.
  std::optional<double> error_bound_px;
  std::optional<double> excess;  ///< share by which E raises the error of a corner
  /// Predicted RMS over the image by which projections of the worst camera are off, after the frame
  /// [px]; empty: the stage does not stop by it, or it is not known.
  std::optional<double> projection_px;
  int corners = 0;                 ///< seen by all cameras
  int views_kept = 0;              ///< accepted in this stage so far
  int frames_without_view = 0;     ///< offered since the last accepted one
  std::optional<double> rmse_px;   ///< of the window, after the frame
  std::optional<Transform> T_FC0;  ///< where the camera was
  SuggestionEvent event = SuggestionEvent::kNone;
  std::optional<int> suggestion;        ///< id of the one that is open, or was closed here
  std::optional<double> distance_px;    ///< mean corner distance to it; empty: no corner in common
  double open_s = 0;                    ///< since it was shown; when it is reached: what it took
  double held_s = 0;                    ///< how long the distance has been small enough
  std::optional<Suggestion> opened;     ///< with kOpened
  std::optional<CandidateRound> round;  ///< scores that arrived with this frame
  std::optional<Failure> failure;       ///< why a start or a batch failed with this frame
  std::string detail;                   ///< what could not be done and why; empty if nothing
};

/// Adds to a decision's detail.
inline void note(Decision& decision, const std::string& text) {
  decision.detail += (decision.detail.empty() ? "" : "; ") + text;
}

/// A frame that was accepted, by this decision or an earlier one, leaves the estimate; says why.
inline void withdraw(int frame, const std::string& why, Decision& decision) {
  if (frame == decision.frame) {
    decision.accepted = false;
    note(decision, why + ": excluded");
    return;
  }
  decision.withdrawn.push_back(frame);
  note(decision, "frame " + std::to_string(frame) + ": " + why + ": excluded");
}

}  // namespace plumbline

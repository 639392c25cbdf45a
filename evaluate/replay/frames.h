// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

struct GuideFramesOptions {
  TimeNs tolerance = FrameOptions().tolerance;  ///< of stamps within a frame [ns]
  /// How long after its stamp an image is there [s]: exposure, transfer, detection. IMU samples
  /// stamped until then arrive with it.
  double arrival_s = 0.05;

  void check() const;  ///< throws InputError naming the field that is out of its range
};

/// A recording's frames, those without corners as well: one for each that guideFrames() gives.
std::vector<Frame> pairedFrames(const Session& session, const GuideFramesOptions& options = {});

/// A recording as the guide would have got it: every frame, also those in which no target was
/// found, with the IMU samples that arrived since the frame before. The first frame brings those of
/// the second before it.
std::vector<GuideFrame> guideFrames(const Session& session, const GuideFramesOptions& options = {});

/// What a session tells of its sensor. `models` one per camera; empty: the session's own words,
/// pinhole-radtan where it has none (see CameraStageOptions).
GuideRig guideRig(const Session& session, const std::vector<CameraModelPair>& models = {});

/// Frames of a recording that are chosen from, and those that choices are judged by: positions in
/// pairFrames(session.cameras, pairing), ascending, no frame in both.
struct FrameSplit {
  std::vector<int> pool;
  std::vector<int> held_out;
};

struct FrameSplitOptions {
  double block_s = 1;      ///< frames are split into blocks of this length [s]
  int held_out_every = 3;  ///< of so many blocks the last is held out; at least 2
  double guard_s = 0.1;    ///< pool frames this close to a held-out block are in neither [s]

  /// Throws InputError for values out of range.
  void check() const;
};

/// Blocks of time rather than single frames, for neighbours show nearly the same: block b holds the
/// frames with floor((t - t_first) / block_s) = b; held out where (b + 1) % held_out_every = 0.
/// Throws InputError for options out of range.
FrameSplit splitFrames(const Session& session, const FrameSplitOptions& options = {},
                       const FrameOptions& pairing = {});

/// How a camera stage ended.
enum class CameraStageEnd {
  kItself,  ///< by its stop, or with the recording
  kTime,    ///< GuideOptions::camera_stage_s
  kHalf,    ///< likewise, at half of the recording, in the whole of which it does not say stop
};

/// A replay that has run, for those who judge it. All members outlive the judging.
struct ReplayRun {
  const Session& session;
  const std::vector<GuideFrame>& frames;
  const std::vector<Decision>& decisions;  ///< one per frame
  GuideOptions guide;
  /// Of the batches; without a tolerance of stamps, since a frame's views have one stamp here.
  CameraStageOptions camera;
  CameraImuOptions camera_imu;  ///< likewise
  CameraStageEnd camera_end = CameraStageEnd::kItself;
  std::optional<TimeNs> since = std::nullopt;  ///< Guide::since()

  /// Where times into the recording count from.
  TimeNs begin() const { return since.value_or(frames.front().t); }
  /// Positions of the frames that a stage accepted and did not withdraw later, ascending.
  std::vector<int> accepted(GuideStage stage) const;
  /// The decision with which a stage finished, or was ended; null if it went on.
  const Decision* finish(GuideStage stage) const;
  bool wasEnded(GuideStage stage) const {
    return stage == GuideStage::kCamera && camera_end != CameraStageEnd::kItself;
  }
  /// The session of some of the frames (ascending positions as GuideFrame::index has them), with
  /// all IMU samples; all views of a frame carry the frame's stamp.
  Session sessionOfFrames(const std::vector<int>& wanted) const;
  /// The same of all frames, or of those from position `first` on.
  Session sessionFrom(int first = 0) const;
};

/// The items at some positions.
template <class Item, class Position>
std::vector<Item> itemsAt(const std::vector<Item>& items, const std::vector<Position>& positions) {
  std::vector<Item> some;
  for (const Position i : positions) some.push_back(items[i]);
  return some;
}

/// At most `most` of the frames, evenly spread.
std::vector<int> thinned(const std::vector<int>& frames, int most);

}  // namespace plumbline

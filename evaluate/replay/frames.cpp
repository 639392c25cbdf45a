// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/frames.h"

#include <cassert>
#include <cstddef>
#include <numeric>
#include <set>

#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"

namespace plumbline {
namespace {

constexpr double kFirstSamples_s = 1;  // of the IMU before the first frame

std::vector<std::vector<Corner>> cornersOf(const Session& session, const Frame& frame) {
  std::vector<std::vector<Corner>> corners(session.cameras.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (frame.view[c] < 0) continue;
    corners[c] = session.cameras[c].views[static_cast<std::size_t>(frame.view[c])].corners;
  }
  return corners;
}

/// Each sample to the first frame that arrives after it; those of more than kFirstSamples_s before
/// the first frame are dropped.
void addImuSamples(const ImuStream& imu, const GuideFramesOptions& options,
                   std::vector<GuideFrame>& frames) {
  const TimeNs arrival = toNanoseconds(options.arrival_s);
  const TimeNs first = frames.front().t - toNanoseconds(kFirstSamples_s);
  auto sample = imu.samples.begin();
  while (sample != imu.samples.end() && sample->t < first) ++sample;
  for (GuideFrame& frame : frames) {
    for (; sample != imu.samples.end() && sample->t <= frame.t + arrival; ++sample) {
      frame.imu.push_back(*sample);
    }
  }
}

/// Blocks of equal length from a first stamp on.
class Blocks {
 public:
  Blocks(TimeNs first, const FrameSplitOptions& options)
      : first_(first), block_(toNanoseconds(options.block_s)), every_(options.held_out_every) {}

  bool isHeldOut(TimeNs t) const {
    if (t < first_) return false;
    // The last block of every `every_`, so that a recording shorter than that holds nothing out.
    return ((t - first_) / block_ + 1) % every_ == 0;
  }
  /// A held-out block begins or ends less than `guard` away.
  bool isNearHeldOut(TimeNs t, TimeNs guard) const {
    // A guard is shorter than a block, so no held-out block lies between t and either.
    return isHeldOut(t - guard) || isHeldOut(t + guard);
  }

 private:
  TimeNs first_;
  TimeNs block_;
  int every_;
};

}  // namespace

std::vector<Frame> pairedFrames(const Session& session, const GuideFramesOptions& options) {
  FrameOptions pairing;
  pairing.tolerance = options.tolerance;
  // A frame without the target is one that the guide has to answer, too.
  pairing.min_corners = 0;
  return pairFrames(session.cameras, pairing);
}

std::vector<GuideFrame> guideFrames(const Session& session, const GuideFramesOptions& options) {
  std::vector<GuideFrame> frames;
  for (const Frame& frame : pairedFrames(session, options)) {
    const int index = static_cast<int>(frames.size());
    // Positions count all frames; decisions and records refer to them.
    frames.push_back({index, frame.t, cornersOf(session, frame), {}});
  }
  if (session.imu && !frames.empty()) addImuSamples(*session.imu, options, frames);
  return frames;
}

GuideRig guideRig(const Session& session, const std::vector<CameraModelPair>& models) {
  CameraStageOptions asked;
  asked.models = models;
  const auto resolved = cameraModels(session, asked);
  GuideRig rig;
  rig.target = session.target;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const CameraStream& camera = session.cameras[c];
    rig.cameras.push_back({camera.name, camera.resolution, resolved[c]});
  }
  if (session.imu) rig.imu = session.imu->noise;
  return rig;
}

Session sessionOf(const Session& session, const std::vector<GuideFrame>& frames,
                  const std::vector<int>& wanted) {
  Session out = withoutViews(session);
  for (const int index : wanted) {
    const GuideFrame& frame = frames[static_cast<std::size_t>(index)];
    for (std::size_t c = 0; c < out.cameras.size(); ++c) {
      // The frame's stamp in place of each camera's own: views are paired again later, without a
      // tolerance (ReplayRun), and must come out as the same frames.
      if (!frame.corners[c].empty()) out.cameras[c].views.push_back({frame.t, frame.corners[c]});
    }
  }
  return out;
}

void FrameSplitOptions::check() const {
  if (!(block_s > 1e-3)) throw InputError("frames are split into blocks of more than 1 ms");
  if (held_out_every < 2) {
    throw InputError("one of every 2 or more blocks can be held out, not of fewer");
  }
  if (!(guard_s >= 0 && guard_s < block_s)) {
    throw InputError("the guard beside a held-out block must be shorter than a block");
  }
}

FrameSplit splitFrames(const Session& session, const FrameSplitOptions& options,
                       const FrameOptions& pairing) {
  options.check();
  FrameSplit split;
  const std::vector<Frame> frames = pairFrames(session.cameras, pairing);
  if (frames.empty()) return split;
  const Blocks blocks(frames.front().t, options);
  const TimeNs guard = toNanoseconds(options.guard_s);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (blocks.isHeldOut(frames[f].t)) {
      split.held_out.push_back(static_cast<int>(f));
    } else if (!blocks.isNearHeldOut(frames[f].t, guard)) {
      split.pool.push_back(static_cast<int>(f));
    }
  }
  return split;
}

std::vector<int> ReplayRun::accepted(GuideStage stage) const {
  std::set<int> positions;
  for (const Decision& d : decisions) {
    if (d.stage == stage && d.accepted) positions.insert(d.frame);
    // In the order of decisions, since a later one takes back what an earlier one accepted.
    for (const int frame : d.withdrawn) positions.erase(frame);
  }
  return {positions.begin(), positions.end()};
}

const Decision* ReplayRun::finish(GuideStage stage) const {
  for (const Decision& d : decisions) {
    // The frame with which it finished has a reason of its own; kFinished is that of those after
    // it.
    if (d.stage == stage && d.mode == GuideMode::kFinished && d.reason != GuideReason::kFinished) {
      return &d;
    }
  }
  return nullptr;
}

Session ReplayRun::sessionOfFrames(const std::vector<int>& wanted) const {
  return sessionOf(session, frames, wanted);
}

Session ReplayRun::sessionFrom(int first) const {
  std::vector<int> wanted(frames.size() - static_cast<std::size_t>(first));
  std::iota(wanted.begin(), wanted.end(), first);
  return sessionOfFrames(wanted);
}

std::vector<int> thinned(const std::vector<int>& frames, int most) {
  if (static_cast<int>(frames.size()) <= most) return frames;
  std::vector<int> kept;
  for (int i = 0; i < most; ++i) {
    kept.push_back(
        frames[frames.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(most)]);
  }
  return kept;
}

}  // namespace plumbline

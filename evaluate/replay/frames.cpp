// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/frames.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <set>

#include "calibrator/base/frames.h"
#include "calibrator/base/option_check.h"
#include "datasets/images/image_io.h"
#include "evaluate/replay/replay_session.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

constexpr double kFirstSamples_s = 1;  // of the IMU before the first frame

std::vector<std::vector<Corner>> cornersOf(const Session& session, const Frame& frame) {
  std::vector<std::vector<Corner>> corners(session.cameras.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (frame.view[c] < 0) continue;
    corners[c] = session.cameras[c].views[frame.view[c]].corners;
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

constexpr int kWidestImage = 400;  // [px]
constexpr int kQuality = 60;

std::string smallCopy(const ImageFile& file) {
  const GrayImage image = readGrayImage(file.path);
  // The least whole factor that makes it fit.
  return encodeJpeg(shrunk(image, (image.width() + kWidestImage - 1) / kWidestImage), kQuality);
}

}  // namespace

void GuideFramesOptions::check() const {
  requireOption(tolerance >= 0, "tolerance", tolerance, "0 or more");
  requireAtLeast(0, "arrival_s", arrival_s);
}

std::vector<Frame> pairedFrames(const Session& session, const GuideFramesOptions& options) {
  options.check();
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
  Session out = withoutViews(session);
  for (const int index : wanted) {
    const GuideFrame& frame = frames[index];
    for (std::size_t c = 0; c < out.cameras.size(); ++c) {
      // The frame's stamp in place of each camera's own: views are paired again later, without a
      // tolerance (ReplayRun), and must come out as the same frames.
      if (!frame.corners[c].empty()) out.cameras[c].views.push_back({frame.t, frame.corners[c]});
    }
  }
  return out;
}

Session ReplayRun::sessionFrom(int first) const {
  std::vector<int> wanted(frames.size() - static_cast<std::size_t>(first));
  std::iota(wanted.begin(), wanted.end(), first);
  return sessionOfFrames(wanted);
}

void addImages(const LoadedSession& loaded, const std::vector<Frame>& paired,
               std::vector<ReplayFrame>& frames, int threads, const ProgressSink& progress) {
  assert(paired.size() == frames.size());
  const bool any =
      std::ranges::any_of(loaded.images, [](const auto& images) { return !images.empty(); });
  if (!any) return;
  parallelFor(frames.size(), threads, "copying images", progress, [&](int, std::size_t i) {
    ReplayFrame& frame = frames[i];
    frame.jpeg.resize(loaded.images.size());
    for (std::size_t c = 0; c < loaded.images.size(); ++c) {
      const int view = paired[i].view[c];
      if (view < 0 || loaded.images[c].empty()) continue;
      frame.jpeg[c] = smallCopy(loaded.images[c][view]);
    }
  });
}

}  // namespace plumbline

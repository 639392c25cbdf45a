// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/guide_frames.h"

#include <cassert>
#include <cstddef>

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

}  // namespace

std::vector<Frame> pairedFrames(const Session& session, const GuideFramesOptions& options) {
  FrameOptions pairing;
  pairing.tolerance = options.tolerance;
  pairing.min_corners = 0;
  return pairFrames(session.cameras, pairing);
}

std::vector<GuideFrame> guideFrames(const Session& session, const GuideFramesOptions& options) {
  std::vector<GuideFrame> frames;
  for (const Frame& frame : pairedFrames(session, options)) {
    const int index = static_cast<int>(frames.size());
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
  Session out;
  out.name = session.name;
  out.target = session.target;
  out.imu = session.imu;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const CameraStream& camera = session.cameras[c];
    CameraStream& stream = out.cameras.emplace_back();
    stream.name = camera.name;
    stream.rostopic = camera.rostopic;
    stream.resolution = camera.resolution;
    stream.camera_model = camera.camera_model;
    stream.distortion_model = camera.distortion_model;
    for (const int index : wanted) {
      const GuideFrame& frame = frames[static_cast<std::size_t>(index)];
      if (!frame.corners[c].empty()) stream.views.push_back({frame.t, frame.corners[c]});
    }
  }
  return out;
}

}  // namespace plumbline

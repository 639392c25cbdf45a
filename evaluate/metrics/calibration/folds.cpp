// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/folds.h"

#include <cassert>
#include <cstdint>
#include <vector>

namespace plumbline {
namespace {

/// A camera's views that the frames take, in their order.
void takeViews(const CameraStream& from, const std::vector<char>& chosen, CameraStream& to) {
  to.views.clear();
  for (std::size_t v = 0; v < from.views.size(); ++v) {
    if (chosen[v] != 0) to.views.push_back(from.views[v]);
  }
}

/// Removes the IMU samples strictly between two instants of the cameras' clock.
void cutBetween(TimeNs from, TimeNs to, double time_offset_s, Session& session) {
  if (!session.imu) return;
  const TimeNs offset = toNanoseconds(time_offset_s);
  std::erase_if(session.imu->samples, [&](const ImuSample& sample) {
    return sample.t > from + offset && sample.t < to + offset;
  });
}

/// The session without views.
Session emptied(const Session& session) {
  Session out;
  out.name = session.name;
  out.target = session.target;
  out.imu = session.imu;
  for (const CameraStream& camera : session.cameras) {
    CameraStream& stream = out.cameras.emplace_back();
    stream.name = camera.name;
    stream.rostopic = camera.rostopic;
    stream.resolution = camera.resolution;
    stream.camera_model = camera.camera_model;
    stream.distortion_model = camera.distortion_model;
  }
  return out;
}

}  // namespace

Fold foldOf(const Session& session, const FrameOptions& options, const FoldChoice& choice) {
  const int index = choice.index, count = choice.count;
  assert(count >= 2 && index >= 0 && index < count);
  const auto frames = pairFrames(session.cameras, options);
  const auto n = static_cast<std::int64_t>(frames.size());
  const auto first = static_cast<std::size_t>(n * index / count);
  const auto end = static_cast<std::size_t>(n * (index + 1) / count);
  Fold fold{emptied(session), emptied(session)};
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const CameraStream& camera = session.cameras[c];
    std::vector<char> training(camera.views.size(), 0);
    std::vector<char> held_out(camera.views.size(), 0);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      if (frames[f].view[c] < 0) continue;
      auto& part = f >= first && f < end ? held_out : training;
      part[static_cast<std::size_t>(frames[f].view[c])] = 1;
    }
    takeViews(camera, training, fold.training.cameras[c]);
    takeViews(camera, held_out, fold.held_out.cameras[c]);
  }
  if (end > first) {
    cutBetween(frames[first].t, frames[end - 1].t, choice.time_offset_s, fold.training);
  }
  return fold;
}

int frameCount(const Session& session, const FrameOptions& options) {
  return static_cast<int>(pairFrames(session.cameras, options).size());
}

}  // namespace plumbline

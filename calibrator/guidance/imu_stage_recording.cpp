// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/imu_stage_recording.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/imu_rates.h"

namespace plumbline {
namespace {

// RMS error with which findPose() is content [px], above what noise and known cameras leave: then
// it does not try parts of the view and the mirrored pose.
constexpr double kGoodPose = 3;

}  // namespace

void FramePoseOptions::check() const {
  requireAtLeast(4, "min_corners", min_corners);
  requirePositive("max_rms_px", max_rms_px);
}

std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras,
                                    const FramePoseOptions& options) {
  options.check();
  PosedFrame out{frame.index, frame.t, frame.corners, {}};
  std::vector<PackedCorners> packed;
  for (auto& corners : out.corners) {
    if (static_cast<int>(corners.size()) < options.min_corners) corners.clear();
    packed.emplace_back(target, std::vector<ImageView>{{frame.t, corners}});
  }
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (out.corners[c].empty()) continue;
    views.push_back({&cameras[c].intrinsics, packed[c].view(0), cameras[c].T_C0Ci.inverse()});
  }
  const auto pose = findPose(views, kGoodPose);
  if (!pose || !(pose->errorPx() < options.max_rms_px)) return std::nullopt;
  out.T_FC0 = pose->T_C0F.inverse();
  return out;
}

namespace {

// Samples from which the IMU's rate is taken: two seconds at 200 Hz. A fixed start of the
// recording, so that what counts as a pause does not change while it grows.
constexpr std::size_t kRateSamples = 400;

}  // namespace

ImuStageRecording::ImuStageRecording(GuideRig rig, const GuideOptions& options)
    : rig_(std::move(rig)), options_(options) {
  assert(rig_.imu);
}

int ImuStageRecording::addSamples(std::span<const ImuSample> samples) {
  const std::size_t before = samples_.size();
  for (const ImuSample& sample : samples) {
    if (samples_.empty() || sample.t > samples_.back().t) samples_.push_back(sample);
  }
  return static_cast<int>(samples_.size() - before);
}

void ImuStageRecording::drop(int index) {
  std::erase_if(frames_, [index](const PosedFrame& frame) { return frame.index == index; });
}

double ImuStageRecording::longestInterval() const {
  const std::size_t count = std::min(samples_.size(), kRateSamples);
  const double median = medianSampleInterval(std::span(samples_).first(count));
  return kGapIntervals * (median > 0 ? median : 1 / rig_.imu->rate_hz);
}

std::optional<double> ImuStageRecording::gapWithin(TimeNs from, TimeNs to) const {
  auto s = std::upper_bound(samples_.begin(), samples_.end(), from,
                            [](TimeNs t, const ImuSample& sample) { return t < sample.t; });
  if (s != samples_.begin()) --s;
  double longest = longestInterval();
  bool found = false;
  for (; s != samples_.end() && s + 1 != samples_.end() && s->t < to; ++s) {
    const double pause = secondsBetween(s->t, (s + 1)->t);
    found = found || pause > longest;
    longest = std::max(longest, pause);
  }
  if (!found) return std::nullopt;
  return longest;
}

double ImuStageRecording::cameraRateHz() const {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < frames_.size(); ++i) {
    intervals.push_back(secondsBetween(frames_[i].t, frames_[i + 1].t));
  }
  assert(!intervals.empty());
  return 1 / median(std::move(intervals));
}

Session ImuStageRecording::session() const {
  Session session;
  session.target = rig_.target;
  session.imu = ImuStream{{}, *rig_.imu, samples_};
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    CameraStream& camera = session.cameras.emplace_back();
    camera.name = rig_.cameras[c].name;
    camera.resolution = rig_.cameras[c].resolution;
    for (const PosedFrame& frame : frames_) {
      if (!frame.corners[c].empty()) camera.views.push_back({frame.t, frame.corners[c]});
    }
  }
  return session;
}

CameraImuOptions ImuStageRecording::batchOptions() const {
  CameraImuOptions batch;
  batch.model() = options_.trajectories.model();
  batch.max_interval_s = options_.max_frame_gap_s;
  batch.threads = options_.threads;
  return batch;
}

}  // namespace plumbline

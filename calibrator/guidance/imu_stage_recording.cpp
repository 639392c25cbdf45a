// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/imu_stage_recording.h"

#include <algorithm>
#include <cassert>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/initialise/angular_rates.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

// RMS error with which findPose() is content [px], above what noise and known cameras leave: then
// it does not try parts of the view and the mirrored pose.
constexpr double kGoodPosePx = 3;

// Samples from which the IMU's rate is taken: two seconds at 200 Hz. A fixed start of the
// recording, so that what counts as a pause does not change while it grows.
constexpr std::size_t kRateSamples = 400;

}  // namespace

std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras, int min_corners,
                                    double max_rms_px) {
  requireAtLeast(4, "min_corners", min_corners);
  requirePositive("max_rms_px", max_rms_px);
  // Out of the frame, not only out of the pose: the window uses the same views.
  PosedFrame out{{frame.index, frame.t, usableViews(frame, cameras.size(), min_corners)}};
  const PackedFrame packed(target, out.corners);
  const CameraEstimate estimate = estimateOf(cameras);
  const auto pose = findPose(packed.views(estimate), kGoodPosePx);
  if (!pose || !(pose->errorPx() < max_rms_px)) return std::nullopt;
  out.T_FC0 = pose->T_C0F.inverse();
  return out;
}

ImuStageRecording::ImuStageRecording(GuideRig rig, const GuideOptions& options)
    : rig_(std::move(rig)), options_(options) {
  assert(rig_.imu);
}

int ImuStageRecording::addSamples(std::span<const ImuSample> samples) {
  const std::size_t before = samples_.size();
  for (const ImuSample& sample : samples) {
    // What comes twice or too late stays out: pre-integration needs stamps that ascend.
    if (samples_.empty() || sample.t > samples_.back().t) samples_.push_back(sample);
  }
  return static_cast<int>(samples_.size() - before);
}

void ImuStageRecording::drop(int index, const std::string& why, Decision& decision) {
  std::erase_if(frames_, [index](const PosedFrame& frame) { return frame.index == index; });
  withdraw(index, why, decision);
}

double ImuStageRecording::longestInterval() const {
  const std::size_t count = std::min(samples_.size(), kRateSamples);
  const double median = medianSampleInterval(std::span(samples_).first(count));
  // Of the stated rate while too few samples have come.
  return kGapIntervals * (median > 0 ? median : 1 / rig_.imu->rate_hz);
}

std::optional<double> ImuStageRecording::gapWithin(TimeNs from, TimeNs to) const {
  auto s = std::ranges::upper_bound(samples_, from, {}, &ImuSample::t);
  // From the sample before: a pause may have begun there.
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
    // Frames without a pose leave longer ones, which the median passes over.
    intervals.push_back(secondsBetween(frames_[i].t, frames_[i + 1].t));
  }
  assert(!intervals.empty());
  return 1 / median(std::move(intervals));
}

Session ImuStageRecording::session() const {
  Session session = sessionOf(rig_, frames_);
  session.imu = ImuStream{{}, *rig_.imu, samples_};
  return session;
}

CameraImuOptions ImuStageRecording::batchOptions() const {
  CameraImuOptions batch;
  batch.model() = options_.trajectories.model();
  // Pauses are the same to the batch as to the window.
  batch.max_interval_s = options_.max_frame_gap_s;
  batch.threads = options_.threads;
  return batch;
}

}  // namespace plumbline

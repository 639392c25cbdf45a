// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/start.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/imu_gravity.h"

namespace plumbline {
namespace {

/// Whether a gap overlaps [from - margin, to + margin] of the camera's clock.
bool gapBetween(TimeNs from, TimeNs to, std::span<const ImuGap> gaps,
                const FrameSelectionOptions& options) {
  const TimeNs offset = toNanoseconds(options.time_offset_s);
  const TimeNs margin = toNanoseconds(options.margin_s);
  return std::any_of(gaps.begin(), gaps.end(), [&](const ImuGap& gap) {
    return gap.from < to + offset + margin && gap.to > from + offset - margin;
  });
}

FrameLink linkBetween(TimeNs from, TimeNs to, std::span<const ImuGap> gaps,
                      const FrameSelectionOptions& options) {
  const bool joined =
      secondsBetween(from, to) <= options.max_interval_s && !gapBetween(from, to, gaps, options);
  return joined ? FrameLink::kInertial : FrameLink::kBiasWalk;
}

constexpr int kPoseIterations = 4;          // a start needs no more
constexpr TimeNs kSynchronised = 50'000;    // [ns] of median shift between cameras' stamps
constexpr double kLongestDifference = 0.3;  // [s] over which positions still give a velocity

double medianInterval(std::span<const CameraPose> poses) {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    intervals.push_back(secondsBetween(poses[i].t, poses[i + 1].t));
  }
  return median(std::move(intervals));
}

/// Mean specific force in F points up while the sensor moves to and fro.
Eigen::Vector3d downFromMeanForce(std::span<const CameraPose> poses,
                                  std::span<const ImuSample> samples, const CameraImuStart& start) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CameraPose& pose : poses) {
    const TimeNs t = pose.t + toNanoseconds(start.time_offsets.front().s);
    const auto next = std::lower_bound(samples.begin(), samples.end(), t,
                                       [](const ImuSample& s, TimeNs at) { return s.t < at; });
    if (next == samples.end()) continue;
    sum += pose.T_FC0.R * (start.T_SC0.R.transpose() * next->accel);
  }
  return sum.norm() > 0 ? Eigen::Vector3d(-sum.normalized()) : start.gravity_direction;
}

/// Pose of camera 0 from a frame's corners; empty where there is none that fits.
std::optional<Transform> framePose(const std::vector<CameraCalibration>& cameras,
                                   const std::vector<PackedCorners>& corners, const Frame& frame,
                                   double max_rms_px) {
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (frame.view[c] < 0) continue;
    views.push_back(
        {&cameras[c].intrinsics, corners[c].view(frame.view[c]), cameras[c].T_C0Ci.inverse()});
  }
  const auto fullest = std::max_element(
      views.begin(), views.end(),
      [](const FrameView& a, const FrameView& b) { return a.view.count < b.view.count; });
  if (fullest == views.end()) return std::nullopt;
  const auto start = homographyPose(*fullest->camera, fullest->view);
  if (!start) return std::nullopt;
  PoseRefinementOptions options;
  options.max_iterations = kPoseIterations;
  const auto refined = refinePose(views, fullest->T_CiC0.inverse() * *start, options);
  if (!(std::sqrt(refined.cost / refined.corners) < max_rms_px)) return std::nullopt;
  return refined.T_C0F.inverse();
}

}  // namespace

std::vector<ImuSample> shiftedSamples(const std::vector<ImuSample>& samples, TimeNs shift) {
  std::vector<ImuSample> out = samples;
  for (ImuSample& s : out) s.t += shift;
  return out;
}

std::vector<ImuGap> imuGaps(std::span<const ImuSample> samples, double max_intervals) {
  if (samples.size() < 2) return {};
  std::vector<double> intervals;
  intervals.reserve(samples.size());
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    intervals.push_back(secondsBetween(samples[k].t, samples[k + 1].t));
  }
  const double longest = max_intervals * median(intervals);
  std::vector<ImuGap> gaps;
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    if (intervals[k] > longest) gaps.push_back({samples[k].t, samples[k + 1].t});
  }
  return gaps;
}

FrameSelection selectFrames(std::span<const TimeNs> stamps, std::span<const ImuSample> samples,
                            std::span<const ImuGap> gaps, const FrameSelectionOptions& options) {
  FrameSelection out;
  if (samples.empty()) return out;
  std::vector<int> covered;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double after_first = secondsBetween(samples.front().t, stamps[i]) + options.time_offset_s;
    const double before_last = secondsBetween(stamps[i], samples.back().t) - options.time_offset_s;
    if (after_first < options.margin_s || before_last < options.margin_s) continue;
    covered.push_back(static_cast<int>(i));
  }
  const auto stamp = [&](int index) { return stamps[static_cast<std::size_t>(index)]; };
  const auto isJoined = [&](std::size_t a, std::size_t b) {
    return linkBetween(stamp(covered[a]), stamp(covered[b]), gaps, options) == FrameLink::kInertial;
  };
  for (std::size_t k = 0; k < covered.size(); ++k) {
    const bool left = k > 0 && isJoined(k - 1, k);
    const bool right = k + 1 < covered.size() && isJoined(k, k + 1);
    if (left || right) out.chosen.push_back(covered[k]);
  }
  for (std::size_t k = 0; k + 1 < out.chosen.size(); ++k) {
    const TimeNs from = stamp(out.chosen[k]);
    const TimeNs to = stamp(out.chosen[k + 1]);
    out.links.push_back(linkBetween(from, to, gaps, options));
    if (gapBetween(from, to, gaps, options)) ++out.gaps_used;
  }
  return out;
}

std::vector<TimeNs> PosedFrames::stamps() const {
  std::vector<TimeNs> out;
  for (const CameraPose& pose : poses) out.push_back(pose.t);
  return out;
}

PosedFrames poseFrames(const Session& session, const std::vector<PackedCorners>& corners,
                       const std::vector<CameraCalibration>& cameras,
                       const CameraImuOptions& options) {
  std::vector<Frame> all = pairFrames(session.cameras, options.frames);
  if (options.frame_stamps) {
    std::erase_if(all, [&](const Frame& f) {
      return !std::binary_search(options.frame_stamps->begin(), options.frame_stamps->end(), f.t);
    });
  }
  std::vector<std::optional<Transform>> poses(all.size());
  forChunks(static_cast<int>(all.size()), 16, options.threads, [&](const Chunk& chunk) {
    for (int i = chunk.begin; i < chunk.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      poses[at] = framePose(cameras, corners, all[at], options.max_start_rms_px);
    }
  });
  PosedFrames out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!poses[i]) {
      ++out.without_pose;
      continue;
    }
    out.poses.push_back({all[i].t, *poses[i]});
    out.frames.push_back(std::move(all[i]));
  }
  return out;
}

Result<CameraImuStart> startCameraImu(std::span<const CameraPose> poses,
                                      std::span<const ImuSample> samples, const AprilGrid& target,
                                      const CameraImuOptions& options) {
  // Each step stands on those before it: the offset (rates must be paired before they are aligned),
  // the rotation, then gravity and the lever arm, which need both. What contradicts its description
  // is refused at the first step that shows it.
  SanityOptions sanity = options.sanity;
  sanity.gravity_m_s2 = options.gravity_m_s2;
  if (const auto failure = checkSampleUnits(samples, sanity)) return *failure;
  const std::vector<CameraRate> rates = cameraRates(poses, 2.5 * medianInterval(poses));
  const GyroIntegral gyro(samples);
  const auto offset = estimateTimeOffset(rates, gyro, options.offset_search);
  if (!offset) return offset.failure();
  const RateAlignment& alignment = offset->alignment;
  if (const auto failure = checkExcitation(alignment, sanity)) return *failure;
  if (const auto failure = checkRates(alignment, sanity)) return *failure;

  CameraImuStart start;
  start.time_offsets = {{offset->offset_s}};
  start.T_SC0.R = alignment.R_SC0;
  start.bias.gyro = alignment.gyro_bias;
  start.excitation = alignment.excitation;
  start.gravity_direction = downFromMeanForce(poses, samples, start);
  const auto inertial =
      alignInertially(poses, samples, alignment.R_SC0, alignment.gyro_bias, offset->offset_s);
  if (!inertial) return start;
  if (const auto failure = checkInertial(*inertial, target, sanity)) return *failure;
  start.check = {inertial->scale, inertial->scale_std, inertial->gravity_F.norm()};
  start.T_SC0.t = inertial->t_SC0;
  start.gravity_direction = inertial->gravity_F.normalized();
  start.bias.accel = inertial->accel_bias;
  return start;
}

void freeOwnOffsets(const Session& session, const std::vector<Frame>& frames,
                    TimeOffsets& offsets) {
  const std::vector<TimeNs> shifts = stampShifts(session.cameras, frames);
  offsets.resize(session.cameras.size(), {offsets.front().s});
  for (std::size_t c = 1; c < shifts.size(); ++c) {
    offsets[c].estimated = std::llabs(shifts[c]) > kSynchronised;
  }
}

CameraImuStart startFromCalibration(std::span<const CameraPose> poses,
                                    std::span<const ImuSample> samples, const ImuCalibration& imu) {
  CameraImuStart start;
  start.T_SC0 = imu.T_SC0;
  start.time_offsets = imu.time_offsets;
  start.gravity_direction = downFromMeanForce(poses, samples, start);
  return start;
}

std::vector<ImuState> startStates(std::span<const CameraPose> poses, const CameraImuStart& start) {
  const Transform T_C0S = start.T_SC0.inverse();
  std::vector<ImuState> states(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    states[i].T_FS = poses[i].T_FC0 * T_C0S;
    states[i].gyro_bias = start.bias.gyro;
    states[i].accel_bias = start.bias.accel;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::size_t a = i > 0 ? i - 1 : i;
    std::size_t b = std::min(i + 1, poses.size() - 1);
    if (secondsBetween(poses[a].t, poses[b].t) > kLongestDifference) {
      const bool later_is_nearer =
          secondsBetween(poses[i].t, poses[b].t) < secondsBetween(poses[a].t, poses[i].t);
      const bool only_later = a == i;
      (only_later || (later_is_nearer && b != i) ? a : b) = i;
    }
    if (a == b) continue;
    states[i].v_F = (states[b].T_FS.t - states[a].T_FS.t) / secondsBetween(poses[a].t, poses[b].t);
  }
  return states;
}

}  // namespace plumbline

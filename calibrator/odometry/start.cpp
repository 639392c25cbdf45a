// SPDX-License-Identifier: BSD-3-Clause
// How an odometry begins: frames that wait, the window's first frames, what is known of them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/odometry/odometry.h"

namespace plumbline {

namespace {

constexpr double kGaugeSigma = 1e-4;       // [m], [rad] of the first frame's position and yaw
constexpr double kMostWaitingSpans = 2;    // frames kept for a start, in its spans
constexpr std::size_t kFewestTracks = 12;  // to tell that the rig stands

/// Whether the tracks that camera 0 has in both frames are where they were.
bool isUnmoved(const FrameTracks& then, const FrameTracks& now, double still_px) {
  std::map<std::int64_t, Eigen::Vector2d> places;
  for (const TrackPoint& p : then.points) {
    if (p.camera == 0) places[p.id] = p.uv;
  }
  std::vector<double> moved;
  for (const TrackPoint& p : now.points) {
    const auto place = places.find(p.id);
    if (p.camera == 0 && place != places.end()) moved.push_back((p.uv - place->second).norm());
  }
  return moved.size() >= kFewestTracks && median(std::move(moved)) < still_px;
}

/// The yaw and the position of a pose, upright.
Transform levelled(const Transform& T) {
  const Eigen::AngleAxisd yaw(std::atan2(T.R(1, 0), T.R(0, 0)), Eigen::Vector3d::UnitZ());
  return {yaw.toRotationMatrix(), T.t};
}

/// About `most` of 0 .. count - 1, evenly, the last one among them.
std::vector<std::size_t> chosenOf(std::size_t count, int most) {
  const auto keep = static_cast<std::size_t>(most);
  const std::size_t stride = std::max<std::size_t>(1, (count + keep - 1) / keep);
  std::vector<std::size_t> chosen;
  for (std::size_t k = (count - 1) % stride; k < count; k += stride) chosen.push_back(k);
  return chosen;
}

/// Position and yaw of the first frame, which nothing observes, and what is known of its biases:
/// that they are zero, give or take their sigma. So the gradient at the state's own bias b is H b.
/// Row 5 is the turn about W's z axis.
WindowPrior gaugePrior(const OdometryFrame& first, const StartOptions& s) {
  WindowPrior prior;
  prior.frames = {first.serial};
  prior.points = {first.state};
  const double gauge = 1 / (kGaugeSigma * kGaugeSigma);
  prior.cost = {Eigen::MatrixXd::Zero(kState, kState), Eigen::VectorXd::Zero(kState), 0};
  prior.cost.H.diagonal().head<3>().setConstant(gauge);
  prior.cost.H(5, 5) = gauge;
  prior.cost.H.diagonal().segment<3>(9).setConstant(1 / (s.gyro_bias_sigma * s.gyro_bias_sigma));
  prior.cost.H.diagonal().tail<3>().setConstant(1 / (s.accel_bias_sigma * s.accel_bias_sigma));
  prior.cost.b.segment<3>(9) = prior.cost.H(9, 9) * first.state.gyro_bias;
  prior.cost.b.tail<3>() = prior.cost.H(12, 12) * first.state.accel_bias;
  return prior;
}

}  // namespace

void Odometry::begin(const FrameTracks& frame) {
  // A start across a gap would be lost at once.
  const bool linked =
      waiting_.empty() || linkBetween(waiting_.back().t, frame.t, last_bias_).has_value();
  if (!linked) waiting_.clear();
  waiting_.push_back(frame);
  const double span = secondsBetween(waiting_.front().t, frame.t);
  if (span < startSpan()) return;
  std::vector<StartFrame> frames;
  for (const FrameTracks& f : waiting_) {
    StartFrame s{f.t, {}};
    for (const TrackPoint& p : f.points) {
      const auto seen = rig_.sighting(p.camera, p.uv, options_.pixel_sigma);
      if (seen) s.seen.emplace_back(p.id, *seen);
    }
    frames.push_back(std::move(s));
  }
  StartOptions options = options_.start;
  if (stoodWhileWaiting()) options.velocity_sigma = options_.model.still_sigma_m_s;
  const auto start = startEstimate(frames, samples_, rig_, options);
  if (start) fillFrom(*start);
  if (isRunning()) return;
  const auto excess = [&] {
    return secondsBetween(waiting_.front().t, frame.t) > kMostWaitingSpans * startSpan();
  };
  while (excess()) waiting_.erase(waiting_.begin());
}

/// The window's first frames: keyframes, evenly chosen among those that waited, the newest one
/// among them. The others get no pose.
void Odometry::fillFrom(const StartEstimate& start) {
  const Transform T_resume = levelled(resume_);
  for (const std::size_t k : chosenOf(waiting_.size(), options_.keyframes)) {
    ImuState state = start.states[k];
    state.T_FS = T_resume * state.T_FS;
    state.v_F = T_resume.R * state.v_F;
    addFrame(waiting_[k], state, true, false);
  }
  for (std::size_t i = 0; i + 1 < window_.frames.size(); ++i) {
    OdometryFrame& frame = window_.frames[i];
    frame.link = linkBetween(frame.t, window_.frames[i + 1].t, biasOf(frame.state));
  }
  window_.prior = gaugePrior(window_.frames.front(), options_.start);
  last_fit_ = waiting_.back().t;
  // By turns: better states place more landmarks, and sightings that do not fit leave only once
  // they are judged by states that do.
  for (int round = 0; round < 3; ++round) {
    placeLandmarks();
    optimise(10);
    gate();
  }
  if (!startHolds()) {
    result_.poses.resize(result_.poses.size() - window_.frames.size());
    window_ = {};
    pose_of_.clear();
    keyframe_rays_.clear();
    return;
  }
  waiting_.clear();
  remember();
}

/// Whether most of what the newest frame saw has its place, and the sensors can be so.
bool Odometry::startHolds() const {
  if (!isSane()) return false;
  const std::int64_t newest = window_.frames.back().serial;
  int seen = 0, placed = 0;
  for (const auto& [id, landmark] : window_.landmarks) {
    if (landmark.last_frame != newest) continue;
    ++seen;
    placed += landmark.p_W.has_value() ? 1 : 0;
  }
  return placed >= options_.start.min_landmarks && 2 * placed > seen;
}

/// Whether the tracks have not moved for still_span_s.
bool Odometry::stands() const {
  if (latest_.size() < 3) return false;
  const FrameTracks& then = latest_.front();
  const FrameTracks& now = latest_.back();
  // Frames do not fall on the ends of the span.
  if (secondsBetween(then.t, now.t) < 0.7 * options_.still_span_s) return false;
  return isUnmoved(then, now, options_.still_px);
}

/// Whether the rig stands and stood at every frame that waits: what the start is told of is the
/// velocity of the first.
bool Odometry::stoodWhileWaiting() const {
  return stands() && std::all_of(waiting_.begin(), waiting_.end(), [&](const FrameTracks& then) {
           return isUnmoved(then, waiting_.back(), options_.still_px);
         });
}

double Odometry::startSpan() const {
  return rig_.cameras.size() > 1 ? options_.start_span_s : options_.mono_start_span_s;
}

}  // namespace plumbline

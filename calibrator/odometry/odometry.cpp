// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/odometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/odometry/window_problem.h"

namespace plumbline {
namespace {

constexpr std::size_t kFewTracks = 6;   // fewer do not carry a pose
constexpr double kFittingShare = 0.15;  // of a frame's sightings, landmarks that fit
constexpr double kFastest = 50;         // [m/s]
constexpr double kLargestGyroBias = 1, kLargestAccelBias = 5;  // [rad/s], [m/s^2]
constexpr double kRelinkGyro = 2e-3, kRelinkAccel = 0.05;  // change of bias after which a link is
                                                           // integrated anew

}  // namespace

void OdometryOptions::check() const {
  requirePositive("pixel_sigma", pixel_sigma);
  requireOption(keyframes >= 2, "keyframes", keyframes, "2 or more");
  requireOption(recent_frames >= 2, "recent_frames", recent_frames, "2 or more");
  requirePositive("keyframe_parallax_px", keyframe_parallax_px);
  requireWithin(0, 1, "keyframe_share", keyframe_share);
  requirePositive("keyframe_interval_s", keyframe_interval_s);
  requirePositive("start_span_s", start_span_s);
  requirePositive("mono_start_span_s", mono_start_span_s);
  requireOption(iterations >= 1, "iterations", iterations, "1 or more");
  requirePositive("gate", gate);
  requirePositive("still_px", still_px);
  requirePositive("still_span_s", still_span_s);
  requirePositive("max_imu_gap_s", max_imu_gap_s);
  requirePositive("max_blind_s", max_blind_s);
  requireAtLeast(0, "model.cauchy", model.cauchy);
  requirePositive("model.still_sigma_m_s", model.still_sigma_m_s);
  requirePositive("triangulation.min_angle_rad", triangulation.min_angle_rad);
  requirePositive("triangulation.min_depth_m", triangulation.min_depth_m);
  requirePositive("triangulation.max_depth_m", triangulation.max_depth_m);
  requirePositive("triangulation.max_error", triangulation.max_error);
  start.check();
}

Odometry::Odometry(RigModel rig, std::span<const ImuSample> samples, OdometryOptions options)
    : rig_(std::move(rig)), samples_(samples), options_(options) {
  options_.check();
}

Eigen::Matrix3d Odometry::expectedRotation(TimeNs from, TimeNs to) const {
  const auto motion = preintegrate(samples_, {from, to, rig_.time_offset_s}, last_bias_);
  return motion ? motion->R : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
}

void Odometry::step(const FrameTracks& frame) {
  ++result_.frames;
  // The recording of the IMU has ended: not a gap, for nothing continues after it.
  if (samples_.empty() || samples_.back().t < frame.t + toNanoseconds(rig_.time_offset_s)) return;
  latest_.push_back(frame);
  const auto isOld = [&](const FrameTracks& f) {
    return secondsBetween(f.t, frame.t) > options_.still_span_s;
  };
  // The front stays the last frame that is older than the span.
  while (latest_.size() > 2 && isOld(latest_[1])) latest_.pop_front();
  if (!isRunning()) return begin(frame);
  if (!append(frame)) return begin(frame);
  // Before anything is adapted to the new frame: what the IMU and the map predicted of it.
  rememberInnovations();
  rememberEpipolar(frame);
  placeLandmarks();
  optimise(options_.iterations);
  gate();
  auto cause = isLost(frame);
  if (!cause) {
    remember();
    if (!shrink()) cause = OdometryLoss::kDiverged;
  }
  if (!cause) return;
  // The frame that shows the loss has no pose, so that begin() may start with it.
  result_.poses.pop_back();
  lose(frame.t, *cause);
  begin(frame);
}

void Odometry::lose(TimeNs t, OdometryLoss cause) {
  result_.losses.push_back({t, cause});
  if (!result_.poses.empty()) resume_ = result_.poses.back().state.T_FS;
  window_ = {};
  pose_of_.clear();
  keyframe_rays_.clear();
  waiting_.clear();
}

/// Adds a frame at the IMU's prediction. False where there is none.
bool Odometry::append(const FrameTracks& tracks) {
  OdometryFrame& last = window_.frames.back();
  last.link = linkBetween(last.t, tracks.t, biasOf(last.state));
  if (!last.link) {
    lose(tracks.t, OdometryLoss::kImuGap);
    return false;
  }
  addFrame(tracks, predicted(last.state, *last.link, rig_.gravity_m_s2), isKeyframe(tracks),
           stands());
  return true;
}

void Odometry::addFrame(const FrameTracks& tracks, const ImuState& state, bool keyframe,
                        bool still) {
  OdometryFrame frame;
  frame.serial = next_serial_++;
  frame.t = tracks.t;
  frame.state = state;
  frame.keyframe = keyframe;
  frame.still = still;
  window_.frames.push_back(frame);
  pose_of_[frame.serial] = result_.poses.size();
  result_.poses.push_back({frame.t, state, Matrix6d::Zero(), keyframe});
  if (keyframe) {
    keyframe_rays_.clear();
    last_keyframe_ = frame.serial;
  }
  for (const TrackPoint& p : tracks.points) {
    const auto seen = rig_.sighting(p.camera, p.uv, options_.pixel_sigma);
    if (!seen) continue;
    Landmark& landmark = window_.landmarks[p.id];
    landmark.sightings.push_back({frame.serial, *seen});
    landmark.last_frame = frame.serial;
    if (keyframe && p.camera == 0) keyframe_rays_[p.id] = seen->f;
  }
}

std::optional<ImuLink> Odometry::linkBetween(TimeNs from, TimeNs to, const ImuBias& bias) const {
  return imuLink(samples_, rig_, from, to, bias, options_.max_imu_gap_s);
}

/// Of the newest frame, which stands where the IMU predicts it.
void Odometry::rememberInnovations() {
  constexpr double kLargest = 9;  // three deviations: beyond it a track is wrong, not the motion
  const OdometryFrame& newest = window_.frames.back();
  FrameInnovation innovation{newest.t, 0, 0};
  for (const auto& [id, landmark] : window_.landmarks) {
    // Known before this frame, since placeLandmarks() comes later: a prediction, not a fit.
    if (!landmark.p_W || landmark.last_frame != newest.serial) continue;
    for (const LandmarkSighting& s : landmark.sightings) {
      if (s.frame != newest.serial) continue;
      const auto e = sightingError(s.seen, rig_, newest.state.T_FS, *landmark.p_W);
      if (!e) continue;
      innovations_px_.push_back(static_cast<float>(e->norm() * options_.pixel_sigma));
      innovation.squares += std::min(kLargest, e->squaredNorm());
      ++innovation.count;
    }
  }
  if (innovation.count > 0) result_.innovations.push_back(innovation);
}

/// The ray of a point in another camera lies in the plane of the baseline and camera 0's ray; its
/// way off the plane is -(n . f) n, which the sighting turns into pixels.
void Odometry::rememberEpipolar(const FrameTracks& frame) {
  std::map<std::int64_t, Eigen::Vector3d> first;
  for (const TrackPoint& p : frame.points) {
    if (p.camera != 0) continue;
    if (const auto seen = rig_.sighting(0, p.uv, 1)) first[p.id] = seen->f;
  }
  for (const TrackPoint& p : frame.points) {
    const auto ray = p.camera > 0 ? first.find(p.id) : first.end();
    if (ray == first.end()) continue;
    const auto seen = rig_.sighting(p.camera, p.uv, 1);
    if (!seen) continue;
    const Transform T_C1C0 = rig_.T_SC[p.camera].inverse() * rig_.T_SC[0];
    const Eigen::Vector3d normal = T_C1C0.t.cross(T_C1C0.R * ray->second);
    if (!(normal.norm() > 0)) continue;
    const Eigen::Vector3d n = normal.normalized();
    epipolar_px_.push_back(static_cast<float>((seen->M * n).norm() * std::abs(n.dot(seen->f))));
  }
}

void Odometry::placeLandmarks() {
  for (auto& [id, landmark] : window_.landmarks) {
    if (landmark.p_W || landmark.sightings.size() < 2) continue;
    landmark.p_W = triangulated(window_, rig_, landmark.sightings, options_.triangulation);
  }
}

void Odometry::optimise(int iterations) {
  for (std::size_t i = 0; i + 1 < window_.frames.size(); ++i) {
    OdometryFrame& frame = window_.frames[i];
    if (!frame.link) continue;
    // motionAt() follows the biases to first order (Forster et al., RSS 2015): beyond this they
    // have left where that holds.
    const bool far = (frame.state.gyro_bias - frame.link->at.gyro).norm() > kRelinkGyro ||
                     (frame.state.accel_bias - frame.link->at.accel).norm() > kRelinkAccel;
    if (!far) continue;
    auto link = linkBetween(frame.link->from, frame.link->to, biasOf(frame.state));
    if (link) frame.link = std::move(link);
  }
  WindowProblem problem(window_, rig_, options_.model);
  MinimiserOptions minimiser;
  minimiser.max_iterations = iterations;
  minimiser.tolerance = 0.05;  // of a standard deviation of everything: far below what is reported
  minimise(problem, minimiser);
}

/// Drops the sightings that do not fit.
void Odometry::gate() {
  window_.dropSightings([&](const Landmark& landmark, const LandmarkSighting& s) {
    if (!landmark.p_W) return false;
    const Transform& T_WS = window_.frame(s.frame).state.T_FS;
    const auto e = sightingError(s.seen, rig_, T_WS, *landmark.p_W);
    return !e || !(e->norm() < options_.gate);
  });
}

bool Odometry::isKeyframe(const FrameTracks& frame) const {
  const int last = window_.indexOf(last_keyframe_);
  if (last < 0 || keyframe_rays_.empty()) return true;
  const OdometryFrame& keyframe = window_.frames[last];
  if (secondsBetween(keyframe.t, frame.t) > options_.keyframe_interval_s) return true;
  const Eigen::Matrix3d& R_SC = rig_.T_SC[0].R;
  // The last keyframe to now, by the window up to its last frame and by the gyroscope from there;
  // what rotation leaves of the rays is parallax.
  const Eigen::Matrix3d R_kf_now = (keyframe.state.T_FS.R * R_SC).transpose() *
                                   (window_.frames.back().state.T_FS.R *
                                    expectedRotation(window_.frames.back().t, frame.t) * R_SC);
  const double pixels_per_radian = pixelsPerRadian(rig_.cameras[0]);
  double parallax = 0;
  int common = 0;
  for (const TrackPoint& p : frame.points) {
    const auto ray = keyframe_rays_.find(p.id);
    if (p.camera != 0 || ray == keyframe_rays_.end()) continue;
    const auto seen = rig_.sighting(0, p.uv, 1);
    if (!seen) continue;
    ++common;
    // Chord of the angle between the rays: pixels in the middle of the image.
    parallax += (R_kf_now * seen->f - ray->second).norm() * pixels_per_radian;
  }
  if (common < options_.keyframe_share * static_cast<double>(keyframe_rays_.size())) return true;
  return parallax > options_.keyframe_parallax_px * common;
}

/// A velocity or bias beyond these is not of the sensor: the minimisation has run away.
bool Odometry::isSane() const {
  const ImuState& s = window_.frames.back().state;
  return s.v_F.norm() < kFastest && s.gyro_bias.norm() < kLargestGyroBias &&
         s.accel_bias.norm() < kLargestAccelBias;
}

/// Lost where nothing, or next to nothing of what is seen, has fitted for max_blind_s.
std::optional<OdometryLoss> Odometry::isLost(const FrameTracks& frame) {
  if (!isSane()) return OdometryLoss::kDiverged;
  const std::int64_t newest = window_.frames.back().serial;
  std::size_t fitting = 0;
  for (const auto& [id, landmark] : window_.landmarks) {
    fitting += landmark.p_W && landmark.sightings.back().frame == newest ? 1 : 0;
  }
  const std::size_t seen = frame.points.size();
  if (fitting >= kFewTracks && fitting >= kFittingShare * static_cast<double>(seen)) {
    last_fit_ = frame.t;
  }
  if (secondsBetween(last_fit_, frame.t) <= options_.max_blind_s) return std::nullopt;
  // Nothing to see, or plenty that does not fit.
  return seen < 2 * kFewTracks ? OdometryLoss::kBlind : OdometryLoss::kDiverged;
}

/// Poses of the frames that may still move are written again.
void Odometry::remember() {
  if (options_.covariances) rememberCovariances();
  const std::size_t n = window_.frames.size();
  const auto recent = static_cast<std::size_t>(options_.recent_frames);
  for (std::size_t i = 0; i < n; ++i) {
    const OdometryFrame& frame = window_.frames[i];
    const auto pose = pose_of_.find(frame.serial);
    if (pose == pose_of_.end()) continue;
    result_.poses[pose->second].state = frame.state;
    // Older ones are final, so that the trajectory has one lag throughout. Until the first frame is
    // marginalised (the prior is then still that of the gauge, of one frame) all of the start are
    // written.
    if (i + recent < n && window_.prior.frames.size() > 1) pose_of_.erase(pose);
  }
  last_bias_ = biasOf(window_.frames.back().state);
  ++remembered_;
  for (const auto& [id, landmark] : window_.landmarks) landmark_sum_ += landmark.p_W ? 1 : 0;
}

void Odometry::rememberCovariances() {
  const QuadraticCost cost = WindowProblem(window_, rig_, options_.model).reduced();
  if (cost.H.size() == 0) return;
  // Regular: the prior has fixed the first frame's position and yaw, and carries that on.
  const SymmetricFactor factor(cost.H);
  for (std::size_t i = 0; i < window_.frames.size(); ++i) {
    const auto pose = pose_of_.find(window_.frames[i].serial);
    if (pose == pose_of_.end()) continue;
    const Eigen::Index row = kState * i;
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(cost.H.rows(), 6);
    // Six columns of the inverse, those of the pose.
    unit.middleRows<6>(row).setIdentity();
    result_.poses[pose->second].covariance = factor.solve(unit).middleRows<6>(row);
  }
}

/// False where the window has lost its prior.
bool Odometry::shrink() {
  const auto recent = static_cast<std::size_t>(options_.recent_frames);
  // From the second: a frame that is dropped needs a link to it and one from it.
  for (std::size_t i = 1; i + recent < window_.frames.size();) {
    const OdometryFrame& frame = window_.frames[i];
    // The prior speaks of frames with a first estimate: they leave by marginalisation alone.
    if (frame.keyframe || frame.first_estimate) {
      ++i;
      continue;
    }
    // The IMU is integrated over it, its sightings are given up.
    OdometryFrame& before = window_.frames[i - 1];
    before.link = linkBetween(before.t, window_.frames[i + 1].t, biasOf(before.state));
    window_.dropFrame(i);
  }
  while (window_.frames.size() > options_.keyframes + recent) {
    if (!dropOldest()) return false;
  }
  return true;
}

/// With it go the landmarks that it saw and that are no longer tracked: nothing will be added to
/// what they say. Those that are tracked lose its sighting.
bool Odometry::dropOldest() {
  const std::int64_t oldest = window_.frames.front().serial;
  const std::int64_t newest = window_.frames.back().serial;
  std::set<std::int64_t> leaving;
  for (auto& [id, landmark] : window_.landmarks) {
    const bool sees = std::any_of(landmark.sightings.begin(), landmark.sightings.end(),
                                  [&](const LandmarkSighting& s) { return s.frame == oldest; });
    if (!sees || landmark.last_frame >= newest) continue;
    leaving.insert(id);
    // Not in frames that will be dropped: the prior would hold them in the window.
    std::erase_if(landmark.sightings, [&](const LandmarkSighting& s) {
      const OdometryFrame& frame = window_.frame(s.frame);
      return !frame.keyframe && !frame.first_estimate;
    });
  }
  return marginaliseOldest(window_, leaving, rig_, options_.model);
}

OdometryResult Odometry::result() const {
  OdometryResult out = result_;
  out.mean_landmarks = landmark_sum_ / static_cast<double>(std::max<std::size_t>(1, remembered_));
  const auto middle = [](const auto& v) {
    return v.empty() ? 0 : static_cast<double>(middleOf(v));
  };
  out.stereo_px = middle(epipolar_px_);
  out.innovation_px = middle(innovations_px_);
  return out;
}

}  // namespace plumbline

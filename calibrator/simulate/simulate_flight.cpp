// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/simulate_flight.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "calibrator/base/image.h"
#include "calibrator/base/option_check.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

/// Uniform over the box's surface: a side is chosen by its area.
std::vector<Eigen::Vector3d> pointsOnWalls(const Eigen::Vector3d& room, int count,
                                           std::uint64_t seed) {
  RandomStream random(seed, RandomPurpose::kLandmarks);
  const Eigen::Vector3d area(room.y() * room.z(), room.x() * room.z(), room.x() * room.y());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d p;
    for (double& x : p) x = random.uniform(-0.5, 0.5);
    const double side = random.uniform() * area.sum();
    // Half of the areas suffice: opposite sides are alike, and p's sign chooses between them.
    const int axis = side < area.x() ? 0 : side < area.x() + area.y() ? 1 : 2;
    p[axis] = p[axis] < 0 ? -0.5 : 0.5;
    points.emplace_back(p.cwiseProduct(room) + Eigen::Vector3d(0, 0, 0.5 * room.z()));
  }
  return points;
}

/// Follows landmarks from frame to frame as a tracker with an unlucky hand would. Every frame a
/// track is lost with the same probability 1 - exp(-1 / (life_s rate)): lives are exponential, with
/// mean life_s.
class Tracker {
 public:
  Tracker(SimulatedFlight& flight, const TrackOptions& options, std::uint64_t seed)
      : flight_(flight),
        options_(options),
        seed_(seed),
        lost_(options.life_s > 0
                  ? 1 - std::exp(-1 / (options.life_s * flight.recording.camera_rate_hz))
                  : 0) {}

  void see(std::size_t frame) {
    look(frame);
    // Stream 0 is the luck's; the noise of camera c has stream c + 1.
    RandomStream luck(seed_, RandomPurpose::kTracks, {0, frame});
    std::erase_if(followed_, [&](const auto& track) {
      return luck.uniform() < lost_ || !seen_[0][track.second];
    });
    for (int p = 0; p < static_cast<int>(flight_.landmarks.size()); ++p) {
      // What was lost may begin again at once, as another track.
      if (static_cast<int>(followed_.size()) >= options_.tracks) break;
      // Begun anywhere, so that not the same few points are followed by all flights' frames.
      const int point =
          static_cast<int>((static_cast<std::size_t>(p) + 37 * frame) % flight_.landmarks.size());
      if (!seen_[0][point] || isFollowed(point)) continue;
      followed_[static_cast<int>(flight_.landmark_of.size())] = point;
      flight_.landmark_of.push_back(point);
    }
    for (std::size_t camera = 0; camera < seen_.size(); ++camera) write(camera, frame);
  }

 private:
  /// Where every camera sees every landmark.
  void look(std::size_t frame) {
    const SimulatedSession& r = flight_.recording;
    seen_.clear();
    for (std::size_t c = 0; c < r.truth.cameras.size(); ++c) {
      const Intrinsics& camera = r.truth.cameras[c].intrinsics;
      const Transform T_CF = r.cameraPose(static_cast<int>(c), r.frame_stamps[frame]).inverse();
      std::vector<std::optional<Eigen::Vector2d>> views;
      for (const Eigen::Vector3d& p_F : flight_.landmarks) {
        const Eigen::Vector3d p_C = T_CF * p_F;
        auto uv = p_C.z() > options_.least_depth_m ? project(camera, p_C) : std::nullopt;
        if (uv && !isInImage(*uv, camera.resolution)) uv.reset();
        views.push_back(uv);
      }
      seen_.push_back(std::move(views));
    }
  }

  bool isFollowed(int point) const {
    return std::any_of(followed_.begin(), followed_.end(),
                       [&](const auto& track) { return track.second == point; });
  }

  void write(std::size_t camera, std::size_t frame) {
    CameraStream& stream = flight_.recording.session.cameras[camera];
    ImageView view{flight_.recording.frame_stamps[frame], {}};
    RandomStream noise(seed_, RandomPurpose::kTracks, {camera + 1, frame});
    for (const auto& [id, point] : followed_) {
      const auto& exact = seen_[camera][point];
      if (!exact) continue;
      const double n_u = noise.normal(), n_v = noise.normal();
      const bool anywhere = noise.uniform() < options_.outlier_share;
      const double u = noise.uniform(), v = noise.uniform();
      // All numbers of a sighting are drawn whether it is an outlier or not: the share of outliers
      // moves nobody else's noise.
      Eigen::Vector2d uv = *exact + options_.sigma_px * Eigen::Vector2d(n_u, n_v);
      if (anywhere) uv = {u * (stream.resolution.width - 1), v * (stream.resolution.height - 1)};
      if (isInImage(uv, stream.resolution)) view.corners.push_back({id, uv});
    }
    stream.views.push_back(std::move(view));
  }

  SimulatedFlight& flight_;
  const TrackOptions& options_;
  std::uint64_t seed_;
  double lost_;                                                    // probability per frame
  std::map<int, int> followed_;                                    // track -> landmark
  std::vector<std::vector<std::optional<Eigen::Vector2d>>> seen_;  // by camera and landmark
};

/// Streams without views, and where every camera stood at every frame.
void addStreams(SimulatedSession& recording) {
  for (std::size_t c = 0; c < recording.truth.cameras.size(); ++c) {
    recording.session.cameras.push_back(emptyStream(recording.truth.cameras[c]));
    std::vector<Transform> poses;
    for (const TimeNs t : recording.frame_stamps) {
      poses.push_back(recording.cameraPose(static_cast<int>(c), t));
    }
    recording.view_poses.push_back(std::move(poses));
  }
}

}  // namespace

void TrackOptions::check() const {
  requireWithin(10, 1e6, "tracks.landmarks", landmarks);
  requireWithin(1, 1e5, "tracks.tracks", tracks);
  requireWithin(0, 100, "tracks.sigma_px", sigma_px);
  requireWithin(0, 1e6, "tracks.life_s", life_s);
  requireWithin(0, 1, "tracks.outlier_share", outlier_share);
  requireWithin(0.01, 10, "tracks.least_depth_m", least_depth_m);
}

SimulatedFlight simulateFlight(const SimulatedRig& rig, const SimulationOptions& simulation,
                               const FlightOptions& flight, const TrackOptions& tracks) {
  flight.check();
  tracks.check();
  const Eigen::Vector3d gravity_F(0, 0, -rig.calibration.imu.value().gravity_m_s2);
  const FlightMotion motion(rig, simulation.duration_s, flight);
  SimulatedFlight out{
      .recording = simulateMotion(rig, AnalyticTrajectory(motion), gravity_F, simulation),
      .rests = motion.rests(),
      .turns = motion.turns(),
      .landmarks = pointsOnWalls(flight.room_m, tracks.landmarks, flight.seed)};
  out.recording.session.target.rows = out.recording.session.target.cols = 0;  // there is none
  addStreams(out.recording);
  Tracker tracker(out, tracks, simulation.seed);
  const auto& states = out.recording.states;
  for (std::size_t k = 0; k < states.size(); ++k) {
    tracker.see(k);
    if (k > 0) out.length_m += (states[k].T_FS.t - states[k - 1].T_FS.t).norm();
  }
  return out;
}

}  // namespace plumbline

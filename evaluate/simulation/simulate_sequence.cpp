// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/simulate_sequence.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/fields/calibration_fields.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/render_room.h"
#include "calibrator/simulate/rig.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/file_io.h"
#include "datasets/session/session_writer.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

/// EuRoC's vicon0/data.csv: stamp [ns], p [m], q (w x y z).
std::string motionCaptureCsv(const Trajectory& trajectory) {
  std::string text = "#timestamp [ns], p_x [m], p_y [m], p_z [m], q_w [], q_x [], q_y [], q_z []\n";
  for (const StampedPose& pose : trajectory.poses) {
    fmt::format_to(std::back_inserter(text),
                   "{},{:.9g},{:.9g},{:.9g},{:.12g},{:.12g},{:.12g},{:.12g}\n", pose.t, pose.p.x(),
                   pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
  }
  return text;
}

}  // namespace

void MotionCaptureOptions::check() const {
  requireWithin(1, 1e4, "rate_hz", rate_hz);
  requireWithin(-1e3, 1e3, "clock_offset_s", clock_offset_s);
  requireWithin(0, 1, "noise_m", noise_m);
  requireWithin(0, 1, "noise_rad", noise_rad);
  requireWithin(0, 100, "drop_outs", drop_outs);
  requireWithin(0, 100, "drop_out_s", drop_out_s);
}

MotionCapture simulateMotionCapture(const SimulatedSession& session,
                                    const MotionCaptureOptions& o) {
  o.check();
  const double span_s = secondsBetween(session.frame_stamps.front(), session.frame_stamps.back());
  // Streams of their own: with more gaps the noise of the poses that stay is the same.
  RandomStream places(o.seed, RandomPurpose::kMotionCapture, {0});
  RandomStream noise(o.seed, RandomPurpose::kMotionCapture, {1});
  MotionCapture capture;
  capture.trajectory.name = "mocap0";
  for (int i = 0; i < o.drop_outs; ++i) {
    // A gap ends within nine tenths: first and last poses stay, however short the recording is.
    const double begin = places.uniform(0.15, 0.8) * span_s;
    capture.gaps_s.emplace_back(begin, begin + std::min(o.drop_out_s, 0.1 * span_s));
  }
  // By W, which is level: where T_VW turns about z alone, V is level, too.
  const Transform T_VF = o.T_VW * session.T_WF();
  // To the last frame and beyond it by less than a period.
  const auto count = static_cast<int>(std::ceil(span_s * o.rate_hz));
  for (int k = 0; k <= count; ++k) {
    const double t_s = k / o.rate_hz;
    // Drawn in gaps as well: the noise of the other poses does not depend on them.
    Vector6d error;
    error.head<3>() = o.noise_m * noise.normalVector();
    error.tail<3>() = o.noise_rad * noise.normalVector();
    const bool in_gap =
        std::any_of(capture.gaps_s.begin(), capture.gaps_s.end(),
                    [&](const auto& gap) { return t_s >= gap.first && t_s < gap.second; });
    if (in_gap) continue;
    // The motion goes by the IMU's clock, which shows start_ns at its begin.
    const TimeNs t_imu = session.start_ns + toNanoseconds(t_s);
    const Transform T_VM = boxplus(T_VF * session.motionAtImuTime(t_imu).T_FB * o.T_SM, error);
    // t_imu = t_mocap + clock_offset_s.
    capture.trajectory.poses.push_back(
        {t_imu - toNanoseconds(o.clock_offset_s), T_VM.t, T_VM.quaternion()});
  }
  return capture;
}

Json writeMotionCapture(const SimulatedSession& session, const MotionCaptureOptions& o,
                        const fs::path& folder, const fs::path& place) {
  const MotionCapture capture = simulateMotionCapture(session, o);
  makeFoldersIn(folder, place / "mav0" / "mocap0");
  writeFileAtomically((folder / place / "mav0" / "mocap0" / "data.csv").string(),
                      motionCaptureCsv(capture.trajectory));
  Json gaps = Json::array();
  for (const auto& [begin, end] : capture.gaps_s) gaps.push_back({begin, end});
  return {{"clock_offset_s", o.clock_offset_s},
          {"T_SM", toJson(o.T_SM)},
          {"T_VW", toJson(o.T_VW)},
          {"noise_m", o.noise_m},
          {"noise_rad", o.noise_rad},
          {"gaps_s", gaps}};
}

namespace {

std::string landmarksCsv(const std::vector<Eigen::Vector3d>& landmarks) {
  std::string text = "#landmark_id,x [m],y [m],z [m]\n";
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3d& p = landmarks[i];
    fmt::format_to(std::back_inserter(text), "{},{:.12g},{:.12g},{:.12g}\n", i, p.x(), p.y(),
                   p.z());
  }
  return text;
}

/// The landmark of each track: one that is followed again has a new track.
std::string tracksCsv(const std::vector<int>& landmark_of) {
  std::string text = "#track_id,landmark_id\n";
  for (std::size_t i = 0; i < landmark_of.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{},{}\n", i, landmark_of[i]);
  }
  return text;
}

/// Rests and turns as many as were made: the same options make the same flight.
Json jsonOf(const SequenceOptions& o, const SimulatedFlight& flight) {
  const SimulationOptions& s = o.simulation;
  return {{"seed", s.seed},
          {"duration_s", s.duration_s},
          {"start_ns", s.start_ns},
          {"imu_margin_s", s.imu_margin_s},
          {"imu_noise", s.imu_noise},
          {"initial_gyro_bias", toJson(s.initial_gyro_bias)},
          {"initial_accel_bias", toJson(s.initial_accel_bias)},
          {"pace", o.flight.pace},
          {"first_rest_s", o.flight.first_rest_s},
          {"rests", restsInFlight(o.flight, flight)},
          {"rest_s", o.flight.rest_s},
          {"ramp_s", o.flight.ramp_s},
          {"turns", flight.turns},
          {"turn_rad", o.flight.turn_rad},
          {"turn_s", o.flight.turn_s},
          {"room_m", toJson(o.flight.room_m)},
          {"landmarks", o.tracks.landmarks},
          {"tracks", o.tracks.tracks},
          {"track_sigma_px", o.tracks.sigma_px},
          {"track_life_s", o.tracks.life_s},
          {"outlier_share", o.tracks.outlier_share},
          {"images", o.images.rendered},
          {"exposure_s", o.images.exposure_s},
          {"noise_sigma", o.images.noise_sigma}};
}

std::string truthOf(const SequenceOptions& o, const SimulatedFlight& flight, const Json& capture) {
  Json truth{{"schema", 1},
             {"rig", o.rig},
             {"options", jsonOf(o, flight)},
             {"camera_rate_hz", flight.recording.camera_rate_hz}};
  truth.update(toJson(flight.recording.truth));
  Json rests = Json::array();
  // The first rest begins long before the recording.
  for (const auto& [from, to] : flight.rests) rests.push_back({std::max(from, 0.0), to});
  truth.update({{"gravity_F", toJson(flight.recording.gravity_F)},
                {"length_m", flight.length_m},
                {"rests_s", rests},
                {"motion_capture", capture}});
  return truth.dump(2) + "\n";
}

void renderRoom(const SequenceOptions& o, const SimulatedSession& recording, const fs::path& folder,
                const ProgressSink& progress) {
  RenderOptions look;
  look.seed = o.simulation.seed;
  look.noise_sigma = o.images.noise_sigma;
  // One for all cameras, since they see one room.
  const auto texture = std::make_shared<RoomTexture>(o.flight.room_m, o.simulation.seed);
  std::vector<RoomRenderer> renderers;
  for (const CameraCalibration& camera : recording.truth.cameras) {
    renderers.emplace_back(camera.intrinsics, texture, look);
  }
  SimulatedSessionFormat format;
  format.threads = o.images.threads;
  format.progress = [&](std::size_t done, std::size_t all) {
    if (progress) progress("rendering", static_cast<double>(done) / static_cast<double>(all));
  };
  writeImages(recording.session, folder, format, [&](int camera, std::size_t view) {
    const auto c = static_cast<std::size_t>(camera);
    const TimeNs t = recording.session.cameras[c].views[view].t;
    // Of its own for every image: no two have the same noise.
    const std::uint64_t number = (static_cast<std::uint64_t>(c) << 32U) + view;
    return renderers[c].render(exposurePoses(recording, camera, t, o.images.exposure_s), number);
  });
}

}  // namespace

int restsInFlight(const FlightOptions& options, const SimulatedFlight& flight) {
  return static_cast<int>(flight.rests.size()) - (options.first_rest_s > 0 ? 1 : 0);
}

void SequenceOptions::check() const {
  simulation.check();
  flight.check();
  tracks.check();
  motion_capture.check();
  requireWithin(0, 1, "images.exposure_s", images.exposure_s);
  requireWithin(0, 100, "images.noise_sigma", images.noise_sigma);
  requireWithin(0, 1024, "images.threads", images.threads);
}

SimulatedFlight simulateSequence(const SequenceOptions& options, const fs::path& folder,
                                 const ProgressSink& progress) {
  options.check();
  SequenceOptions o = options;
  // One seed for all.
  o.flight.seed = o.motion_capture.seed = o.simulation.seed;
  SimulatedFlight flight = simulateFlight(simulatedRig(o.rig), o.simulation, o.flight, o.tracks);
  const SimulatedSession& recording = flight.recording;
  const ViewFormat views = o.images.rendered ? ViewFormat::kImages : ViewFormat::kTracks;
  writeSession(recording.session, recording.camera_rate_hz, views, folder);
  // Beside the exact truth, as a laboratory would have it: its own clock, world and marker body.
  const Json capture = writeMotionCapture(recording, o.motion_capture, folder, {});
  writeNewFile(folder, "truth/camchain-imucam.yaml", kalibrCamchainText(recording.truth));
  writeNewFile(folder, "truth/trajectory.csv", trajectoryCsv(recording));
  writeNewFile(folder, "truth/landmarks.csv", landmarksCsv(flight.landmarks));
  writeNewFile(folder, "truth/truth.json", truthOf(o, flight, capture));
  if (o.images.rendered) {
    renderRoom(o, recording, folder, progress);
  } else {
    // Ids are those of mav0/camN/tracks.csv, which images stand in for.
    writeNewFile(folder, "truth/tracks.csv", tracksCsv(flight.landmark_of));
  }
  return flight;
}

}  // namespace plumbline

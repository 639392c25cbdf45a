// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/simulate_sequence.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/fields/calibration_fields.h"
#include "calibrator/simulate/render_room.h"
#include "calibrator/simulate/rig.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/file_io.h"
#include "datasets/session/session_writer.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

std::string landmarksCsv(const std::vector<Eigen::Vector3d>& landmarks) {
  std::string text = "#landmark_id,x [m],y [m],z [m]\n";
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3d& p = landmarks[i];
    text += fmt::format("{},{:.12g},{:.12g},{:.12g}\n", i, p.x(), p.y(), p.z());
  }
  return text;
}

/// The landmark of each track: one that is followed again has a new track.
std::string tracksCsv(const std::vector<int>& landmark_of) {
  std::string text = "#track_id,landmark_id\n";
  for (std::size_t i = 0; i < landmark_of.size(); ++i) {
    text += fmt::format("{},{}\n", i, landmark_of[i]);
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

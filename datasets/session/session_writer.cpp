// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/session_writer.h"

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "calibrator/fields/calibration_fields.h"
#include "calibrator/fields/json_fields.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/images/image_io.h"
#include "datasets/session/target.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

Json jsonOf(const SimulationOptions& o) {
  return {{"seed", o.seed},
          {"trajectory",
           {{"seed", o.trajectory.seed},
            {"kind", toString(o.trajectory.kind)},
            {"axis_S", toJson(o.trajectory.axis_S)},
            {"pace", o.trajectory.pace},
            {"distance_ratio", o.trajectory.distance_ratio}}},
          {"target", toJson(o.target)},
          {"duration_s", o.duration_s},
          {"start_ns", o.start_ns},
          {"imu_margin_s", o.imu_margin_s},
          {"corner_sigma_px", o.corner_sigma_px},
          {"outlier_fraction", o.outlier_fraction},
          {"outlier_px", o.outlier_px},
          {"dropped_fraction", o.dropped_fraction},
          {"stamp_jitter_s", o.stamp_jitter_s},
          {"border_px", o.border_px},
          {"min_tag_px", o.min_tag_px},
          {"imu_noise", o.imu_noise},
          {"initial_gyro_bias", toJson(o.initial_gyro_bias)},
          {"initial_accel_bias", toJson(o.initial_accel_bias)},
          {"down_F", toJson(o.down_F)}};
}

Json jsonOf(const InjectedFault& injected) {
  const Fault& fault = injected.fault;
  const FaultDescription& d = describe(fault.kind);
  Json json{{"name", d.name}, {"value", fault.value}, {"unit", unitOf(d.value.quantity)}};
  if (!fault.spec.empty()) json["spec"] = fault.spec;
  if (d.extent.quantity != Quantity::kNone) {
    json["extent"] = fault.extent;
    json["extent_unit"] = unitOf(d.extent.quantity);
  }
  if (d.instant == TakesInstant::kYes) json["at_s"] = fault.at_s;
  if (fault.axis) json["axis"] = std::string(1, "xyz"[*fault.axis]);
  if (fault.camera) json["camera"] = *fault.camera;
  if (!injected.stamps.empty()) json["stamps_ns"] = injected.stamps;
  return json;
}

void appendVector(std::string& text, const Eigen::Vector3d& v) {
  for (const double value : v) text += fmt::format(",{:.12g}", value);
}

// Of every view, those without a corner too: by the list the reader knows the frames that saw no
// target.
std::string frameList(const CameraStream& camera) {
  std::string text = "#timestamp [ns],filename\n";
  for (const ImageView& view : camera.views) {
    text += fmt::format("{0},{0}.png\n", view.t);
  }
  return text;
}

/// `id`: what the rows' second column is called.
/// Nine decimals of a pixel, and twelve digits of a sample below: what they cut is far beneath any
/// noise.
std::string cornerList(const CameraStream& camera, const char* id) {
  std::string text = fmt::format("#timestamp [ns],{},u [px],v [px]\n", id);
  for (const ImageView& view : camera.views) {
    for (const Corner& c : view.corners) {
      text += fmt::format("{},{},{:.9f},{:.9f}\n", view.t, c.id, c.uv.x(), c.uv.y());
    }
  }
  return text;
}

std::string cameraYaml(const CameraStream& camera, double rate_hz) {
  std::string text =
      fmt::format("sensor_type: camera\nrate_hz: {}\nresolution: [{}, {}]\n", yamlNumber(rate_hz),
                  camera.resolution.width, camera.resolution.height);
  if (!camera.camera_model.empty()) text += "camera_model: " + camera.camera_model + "\n";
  if (!camera.distortion_model.empty()) {
    text += "distortion_model: " + camera.distortion_model + "\n";
  }
  text += "rostopic: " +
          yamlText(camera.rostopic.empty() ? "/" + camera.name + "/image_raw" : camera.rostopic) +
          "\n";
  return text;
}

std::string sampleList(const ImuStream& imu) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuSample& s : imu.samples) {
    text += fmt::format("{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}\n", s.t, s.gyro.x(),
                        s.gyro.y(), s.gyro.z(), s.accel.x(), s.accel.y(), s.accel.z());
  }
  return text;
}

std::string noiseYaml(const ImuNoise& noise) {
  return fmt::format(
      "accelerometer_noise_density: {}  # [m/s^2/sqrt(Hz)]\n"
      "accelerometer_random_walk: {}  # [m/s^3/sqrt(Hz)]\n"
      "gyroscope_noise_density: {}  # [rad/s/sqrt(Hz)]\n"
      "gyroscope_random_walk: {}  # [rad/s^2/sqrt(Hz)]\n",
      yamlNumber(noise.accel_density), yamlNumber(noise.accel_random_walk),
      yamlNumber(noise.gyro_density), yamlNumber(noise.gyro_random_walk));
}

/// `target` is the real one, which the session may state wrongly.
void writeTargetImages(const SimulatedSession& simulated, const AprilGrid& target,
                       const fs::path& folder, const SimulatedSessionFormat& format) {
  std::vector<TargetRenderer> renderers;
  for (const CameraCalibration& camera : simulated.truth.cameras) {
    renderers.emplace_back(camera.intrinsics, target, format.render);
  }
  writeImages(simulated.session, folder, format, [&](int camera, std::size_t view) {
    const auto i = static_cast<std::size_t>(camera);
    // Its noise by camera and view, whichever thread renders it.
    const std::uint64_t number = (static_cast<std::uint64_t>(i) << 32U) + view;
    return renderers[i].render(simulated.view_poses[i][view], number);
  });
}

}  // namespace

std::string truthJson(const SimulatedSession& simulated, const SimulationOptions& options) {
  Json faults = Json::array();
  for (const InjectedFault& fault : simulated.faults) faults.push_back(jsonOf(fault));
  Json truth{{"schema", 1},
             {"session", simulated.session.name},
             {"options", jsonOf(options)},
             {"camera_rate_hz", simulated.camera_rate_hz}};
  truth.update(toJson(simulated.truth));
  truth.update({{"gravity_F", toJson(simulated.gravity_F)},
                {"T_WF", toJson(simulated.T_WF())},
                {"faults", faults}});
  return truth.dump(2) + "\n";
}

// EuRoC's state_groundtruth_estimate0: R is the world, S the IMU, velocities are in R; a row for
// every sample of the IMU.
std::string trajectoryCsv(const SimulatedSession& simulated) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
      "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], "
      "b_a_RS_S_z [m s^-2]\n";
  const Transform T_WF = simulated.T_WF();
  const std::vector<ImuSample>& samples = simulated.session.imu->samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const MotionState m = simulated.motionAtImuTime(samples[i].t);
    const Transform T_WS = T_WF * m.T_FB;
    const Eigen::Quaterniond q = T_WS.quaternion();
    text += fmt::format("{}", samples[i].t);
    appendVector(text, T_WS.t);
    text += fmt::format(",{:.12g}", q.w());
    appendVector(text, q.vec());
    appendVector(text, T_WF.R * m.v_F);
    appendVector(text, simulated.biases[i].gyro);
    appendVector(text, simulated.biases[i].accel);
    text += '\n';
  }
  return text;
}

std::vector<TextFile> sessionFiles(const Session& session, double camera_rate_hz,
                                   ViewFormat views) {
  std::vector<TextFile> files;
  for (const CameraStream& camera : session.cameras) {
    const std::string folder = "mav0/" + camera.name + "/";
    files.push_back({folder + "data.csv", frameList(camera)});
    files.push_back({folder + "sensor.yaml", cameraYaml(camera, camera_rate_hz)});
    if (views == ViewFormat::kCorners) {
      files.push_back({folder + "corners.csv", cornerList(camera, "corner_id")});
    }
    if (views == ViewFormat::kTracks) {
      files.push_back({folder + "tracks.csv", cornerList(camera, "track_id")});
    }
  }
  if (session.target.tagCount() > 0) {
    files.push_back({"target.yaml", kalibrTargetText(session.target)});
  }
  if (!session.imu) return files;
  const ImuStream& imu = *session.imu;
  const std::string topic = yamlText(imu.rostopic.empty() ? "/imu0" : imu.rostopic);
  files.push_back({"mav0/imu0/data.csv", sampleList(imu)});
  files.push_back(
      {"mav0/imu0/sensor.yaml", fmt::format("sensor_type: imu\n"
                                            "rate_hz: {}\n{}",
                                            yamlNumber(imu.noise.rate_hz), noiseYaml(imu.noise))});
  // The same densities twice: EuRoC's file for its readers, Kalibr's for its tools.
  files.push_back({"imu.yaml", fmt::format("rostopic: {}\nupdate_rate: {}  # [Hz]\n{}", topic,
                                           yamlNumber(imu.noise.rate_hz), noiseYaml(imu.noise))});
  return files;
}

void SimulatedSessionFormat::check() const {
  if (threads >= 0) return;
  throw BadInput(InputFault::kBadOption, "the number of threads must be 0 (all cores) or more");
}

void writeSession(const Session& session, double camera_rate_hz, ViewFormat views,
                  const fs::path& folder) {
  for (const TextFile& file : sessionFiles(session, camera_rate_hz, views)) {
    writeNewFile(folder, file.path, file.text);
  }
}

void writeImages(const Session& session, const fs::path& folder,
                 const SimulatedSessionFormat& format, const ViewRenderer& render) {
  std::vector<fs::path> folders;
  std::vector<std::pair<std::size_t, std::size_t>> jobs;  // camera and view
  for (std::size_t i = 0; i < session.cameras.size(); ++i) {
    const CameraStream& camera = session.cameras[i];
    folders.push_back(folder / "mav0" / camera.name / "data");
    makeFoldersIn(folder, fs::path("mav0") / camera.name / "data");
    for (std::size_t k = 0; k < camera.views.size(); ++k) jobs.emplace_back(i, k);
  }
  std::mutex mutex;
  std::size_t done = 0;
  const auto write = [&](std::size_t index) {
    const auto [camera, view] = jobs[index];
    const TimeNs t = session.cameras[camera].views[view].t;
    writePng(folders[camera] / fmt::format("{}.png", t), render(static_cast<int>(camera), view),
             PngEffort::kFast);
    const std::lock_guard lock(mutex);
    ++done;
    if (format.progress) format.progress(done, jobs.size());
  };
  const int cores = tbb::this_task_arena::max_concurrency();
  tbb::task_arena arena(format.threads > 0 ? std::min(format.threads, cores) : cores);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, jobs.size(), write); });
}

void writeSimulatedSession(const SimulatedSession& simulated, const SimulationOptions& options,
                           const fs::path& folder, const SimulatedSessionFormat& format) {
  format.check();
  if (format.views == ViewFormat::kImages) {
    checkRendered(options.faults);
    if (options.target.shape.terms[kTargetTerms - 1] != 0) {
      throw BadInput(InputFault::kUnsupported,
                     "tag_edge is an error of a detector and cannot be rendered; write corners, or "
                     "omit it");
    }
  }
  writeSession(simulated.session, simulated.camera_rate_hz, format.views, folder);
  std::vector<TextFile> truths = {{"camchain-imucam.yaml", kalibrCamchainText(simulated.truth)},
                                  {"trajectory.csv", trajectoryCsv(simulated)},
                                  {"truth.json", truthJson(simulated, options)}};
  if (!options.target.shape.isFlat()) {
    truths.push_back({kTargetShapeFile, targetShapeText(options.target)});
  }
  for (const TextFile& file : truths) {
    writeNewFile(folder, fs::path("truth") / file.path, file.text);
  }
  if (format.views == ViewFormat::kImages) {
    writeTargetImages(simulated, options.target, folder, format);
  }
}

}  // namespace plumbline

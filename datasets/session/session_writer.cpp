// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/session_writer.h"

#include <iterator>

#include <fmt/format.h>

#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/yaml_numbers.h"

namespace plumbline {
namespace {

std::string frameList(const CameraStream& camera) {
  std::string text = "#timestamp [ns],filename\n";
  for (const ImageView& view : camera.views) {
    fmt::format_to(std::back_inserter(text), "{0},{0}.png\n", view.t);
  }
  return text;
}

std::string cornerList(const CameraStream& camera) {
  std::string text = "#timestamp [ns],corner_id,u [px],v [px]\n";
  for (const ImageView& view : camera.views) {
    for (const Corner& c : view.corners) {
      fmt::format_to(std::back_inserter(text), "{},{},{:.9f},{:.9f}\n", view.t, c.id, c.uv.x(),
                     c.uv.y());
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
          (camera.rostopic.empty() ? "/" + camera.name + "/image_raw" : camera.rostopic) + "\n";
  return text;
}

std::string sampleList(const ImuStream& imu) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuSample& s : imu.samples) {
    fmt::format_to(std::back_inserter(text), "{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}\n",
                   s.t, s.gyro.x(), s.gyro.y(), s.gyro.z(), s.accel.x(), s.accel.y(), s.accel.z());
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

}  // namespace

std::vector<TextFile> sessionFiles(const Session& session, double camera_rate_hz,
                                   ViewFormat views) {
  std::vector<TextFile> files;
  for (const CameraStream& camera : session.cameras) {
    const std::string folder = "mav0/" + camera.name + "/";
    files.push_back({folder + "data.csv", frameList(camera)});
    files.push_back({folder + "sensor.yaml", cameraYaml(camera, camera_rate_hz)});
    if (views == ViewFormat::kCorners) {
      files.push_back({folder + "corners.csv", cornerList(camera)});
    }
  }
  files.push_back({"target.yaml", kalibrTargetText(session.target)});
  if (!session.imu) return files;
  const ImuStream& imu = *session.imu;
  const std::string topic = imu.rostopic.empty() ? "/imu0" : imu.rostopic;
  files.push_back({"mav0/imu0/data.csv", sampleList(imu)});
  files.push_back(
      {"mav0/imu0/sensor.yaml", fmt::format("sensor_type: imu\n"
                                            "rate_hz: {}\n{}",
                                            yamlNumber(imu.noise.rate_hz), noiseYaml(imu.noise))});
  files.push_back({"imu.yaml", fmt::format("rostopic: {}\nupdate_rate: {}  # [Hz]\n{}", topic,
                                           yamlNumber(imu.noise.rate_hz), noiseYaml(imu.noise))});
  return files;
}

}  // namespace plumbline

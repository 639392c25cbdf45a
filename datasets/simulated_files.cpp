// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/simulated_files.h"

#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  return fmt::format(
      "sensor_type: camera\n"
      "comment: simulated\n"
      "rate_hz: {}\n"
      "resolution: [{}, {}]\n"
      "camera_model: {}\n"
      "distortion_model: {}\n"
      "rostopic: {}\n",
      rate_hz, camera.resolution.width, camera.resolution.height, camera.camera_model,
      camera.distortion_model,
      camera.rostopic.empty() ? "/" + camera.name + "/image_raw" : camera.rostopic);
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
      noise.accel_density, noise.accel_random_walk, noise.gyro_density, noise.gyro_random_walk);
}

std::string targetYaml(const AprilGrid& target) {
  return fmt::format(
      "target_type: aprilgrid\n"
      "tagCols: {}\n"
      "tagRows: {}\n"
      "tagSize: {}  # [m]\n"
      "tagSpacing: {}  # ratio of the gap to tagSize\n",
      target.cols, target.rows, target.tag_size, target.spacing);
}

std::string list(const Eigen::VectorXd& v) {
  return fmt::format("[{}]", fmt::join(v.data(), v.data() + v.size(), ", "));
}

std::string matrixYaml(const char* key, const Transform& T) {
  std::string text = fmt::format("  {}:\n", key);
  const Eigen::Matrix4d M = T.matrix();
  for (Eigen::Index i = 0; i < 4; ++i) text += "  - " + list(M.row(i)) + "\n";
  return text;
}

std::string overlaps(std::size_t camera, std::size_t count) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < count; ++i) {
    if (i != camera) others.push_back(i);
  }
  return fmt::format("[{}]", fmt::join(others, ", "));
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
  files.push_back({"target.yaml", targetYaml(session.target)});
  if (!session.imu) return files;
  const ImuStream& imu = *session.imu;
  const std::string topic = imu.rostopic.empty() ? "/imu0" : imu.rostopic;
  files.push_back({"mav0/imu0/data.csv", sampleList(imu)});
  files.push_back({"mav0/imu0/sensor.yaml", fmt::format("sensor_type: imu\ncomment: simulated\n"
                                                        "rate_hz: {}\n{}",
                                                        imu.noise.rate_hz, noiseYaml(imu.noise))});
  files.push_back({"imu.yaml", fmt::format("rostopic: {}\nupdate_rate: {}  # [Hz]\n{}", topic,
                                           imu.noise.rate_hz, noiseYaml(imu.noise))});
  return files;
}

std::string camchainText(const Calibration& calibration) {
  std::string text;
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) {
    const CameraCalibration& camera = calibration.cameras[i];
    const Intrinsics& k = camera.intrinsics;
    text += fmt::format("cam{}:\n", i);
    if (calibration.imu) {
      const Transform T_SCi = calibration.imu->T_SC0 * camera.T_C0Ci;
      text += matrixYaml("T_cam_imu", T_SCi.inverse());
    }
    if (i > 0) {
      const Transform& T_C0Cprevious = calibration.cameras[i - 1].T_C0Ci;
      text += matrixYaml("T_cn_cnm1", camera.T_C0Ci.inverse() * T_C0Cprevious);
    }
    text += fmt::format(
        "  cam_overlaps: {}\n  camera_model: {}\n  distortion_coeffs: {}\n"
        "  distortion_model: {}\n  intrinsics: {}\n  resolution: [{}, {}]\n  rostopic: {}\n",
        overlaps(i, calibration.cameras.size()), toString(k.projection_model), list(k.distortion),
        toString(k.distortion_model), list(k.projection), k.resolution.width, k.resolution.height,
        camera.rostopic);
    if (calibration.imu) {
      text += fmt::format("  timeshift_cam_imu: {}\n", calibration.imu->time_offset_s);
    }
  }
  return text;
}

}  // namespace plumbline

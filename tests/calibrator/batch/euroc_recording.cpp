// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/batch/euroc_recording.h"

#include <charconv>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace plumbline::test {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error("cannot read " + path +
                             ": set PLUMBLINE_SHARED_DATA to the folder of real recordings");
  }
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Numbers of a CSV text, one after the other; lines that start with # are left out.
class CsvNumbers {
 public:
  explicit CsvNumbers(const std::string& text)
      : at_(text.data()), end_(text.data() + text.size()) {}

  bool nextLine() {
    while (at_ < end_ && (*at_ == '\n' || *at_ == '\r' || *at_ == '#')) {
      const bool comment = *at_ == '#';
      ++at_;
      while (comment && at_ < end_ && *at_ != '\n') ++at_;
    }
    return at_ < end_;
  }

  template <class T>
  T next() {
    T value{};
    const auto [after, error] = std::from_chars(at_, end_, value);
    if (error != std::errc()) throw std::runtime_error("not a number in a CSV file");
    at_ = after;
    if (at_ < end_ && *at_ == ',') ++at_;
    return value;
  }

 private:
  const char* at_;
  const char* end_;
};

CameraStream readCamera(const std::string& folder, const std::string& name) {
  CameraStream camera;
  camera.name = name;
  camera.resolution = {752, 480};
  const std::string text = contents(folder + "/" + name + "/corners.csv");
  CsvNumbers csv(text);
  while (csv.nextLine()) {
    const auto t = csv.next<TimeNs>();
    if (camera.views.empty() || camera.views.back().t != t) {
      camera.views.push_back({t, {}});
      camera.views.back().corners.reserve(144);
    }
    Corner corner;
    corner.id = csv.next<int>();
    corner.uv.x() = csv.next<double>();
    corner.uv.y() = csv.next<double>();
    camera.views.back().corners.push_back(corner);
  }
  for (ImageView& view : camera.views) view.corners.shrink_to_fit();
  return camera;
}

ImuStream readImu(const std::string& folder) {
  ImuStream imu;  // its default noise is EuRoC's
  const std::string text = contents(folder + "/imu0/data.csv");
  CsvNumbers csv(text);
  while (csv.nextLine()) {
    ImuSample s;
    s.t = csv.next<TimeNs>();
    for (int k = 0; k < 3; ++k) s.gyro(k) = csv.next<double>();
    for (int k = 0; k < 3; ++k) s.accel(k) = csv.next<double>();
    imu.samples.push_back(s);
  }
  return imu;
}

CameraCalibration camera(const std::string& name, const Eigen::Vector4d& projection,
                         const Eigen::Vector4d& distortion) {
  CameraCalibration c;
  c.name = name;
  c.intrinsics.resolution = {752, 480};
  c.intrinsics.projection = projection;
  c.intrinsics.distortion = distortion;
  return c;
}

std::vector<CameraCalibration> publishedCameras() {
  std::vector<CameraCalibration> cameras = {
      camera("cam0", {458.654, 457.296, 367.215, 248.375},
             {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}),
      camera("cam1", {457.587, 456.134, 379.999, 255.238},
             {-0.28368365, 0.07451284, -0.00010473, -3.555907e-05})};
  Eigen::Matrix4d T_C1C0;
  T_C1C0 << 0.999997256478, 0.002312067192, 0.000376008102, -0.110073808127,  //
      -0.002317135723, 0.999898048507, 0.014089835847, 0.000399121547,        //
      -0.000343393121, -0.014090668453, 0.999900662638, -0.000853702503,      //
      0, 0, 0, 1;
  cameras[1].T_C0Ci = Transform::fromMatrix(T_C1C0).inverse();
  return cameras;
}

}  // namespace

EurocRecording readEurocRecording(const std::string& shared_data) {
  const std::string folder = shared_data + "/euroc_imu_april";
  EurocRecording recording;
  recording.session.name = "euroc_imu_april";
  recording.session.cameras = {readCamera(folder, "cam0"), readCamera(folder, "cam1")};
  recording.session.imu = readImu(folder);
  recording.published = publishedCameras();
  return recording;
}

}  // namespace plumbline::test

// SPDX-License-Identifier: BSD-3-Clause
// Keys and types as ORB-SLAM3's Settings reads them (File.version "1.0").
#include <cmath>

#include <fmt/format.h>

#include "datasets/calibration/export/tools.h"

namespace plumbline {
namespace {

constexpr double kAssumedRate = 20;

// Not calibration, but the tool stops without them.
constexpr const char* kOrbSlam3Settings = R"(
# From here on: settings of the tool with the values of its own examples. They are no results of
# the calibration; tune them.
ORBextractor.nFeatures: 1200
ORBextractor.scaleFactor: 1.2
ORBextractor.nLevels: 8
ORBextractor.iniThFAST: 20
ORBextractor.minThFAST: 7
Viewer.KeyFrameSize: 0.05
Viewer.KeyFrameLineWidth: 1.0
Viewer.GraphLineWidth: 0.9
Viewer.PointSize: 2.0
Viewer.CameraSize: 0.08
Viewer.CameraLineWidth: 3.0
Viewer.ViewpointX: 0.0
Viewer.ViewpointY: -0.7
Viewer.ViewpointZ: -1.8
Viewer.ViewpointF: 500.0
)";

bool isFisheye(const CameraCalibration& camera) {
  return camera.intrinsics.distortion_model == DistortionModel::kEquidistant;
}

constexpr PinholeWords kCameraTypes{"PinHole", "KannalaBrandt8"};

/// The type of all cameras.
std::string checkedType(const ExportSource& source) {
  source.atMostCameras(2);
  std::string type;
  for (const CameraCalibration& camera : source.calibration.cameras) {
    type = source.distortionWord(camera, kCameraTypes);
  }
  // One Camera.type and one image size stand for both cameras.
  source.oneModel();
  source.oneResolution();
  source.knownNoise();
  return type;
}

std::vector<std::string> orbSlam3Warnings(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  std::vector<std::string> warnings = offsetWarnings(source, "ORB-SLAM3 takes it for 0.");
  if (calibration.imu && options.offset_known) {
    const double td = calibration.imu->timeOffset();
    warnings.push_back(fmt::format(
        "ORB-SLAM3 has no time offset between camera and IMU: add {} to every image stamp before "
        "you run it (t_imu = t_cam + t_d).",
        secondsText(td)));
  }
  const bool distorted =
      calibration.cameras.front().intrinsics.distortion_model != DistortionModel::kNone;
  if (calibration.cameras.size() == 2 && distorted) {
    warnings.push_back(
        "Known fault of ORB-SLAM3: it takes camera 2's distortion from camera 1 (PinHole and "
        "KannalaBrandt8 alike). Rectify the images first, and use Camera.type \"Rectified\", when "
        "you judge a stereo calibration with it.");
  }
  if (!options.camera_rate_hz) {
    warnings.push_back(fmt::format(
        "Camera.fps is assumed to be {:.0f} Hz; set it to the rate of the images.", kAssumedRate));
  }
  return warnings;
}

/// The names of KannalaBrandt8's and PinHole's coefficients; without distortion the keys are left
/// out.
std::string cameraText(const CameraCalibration& camera, int number) {
  const Intrinsics& k = camera.intrinsics;
  const std::string prefix = fmt::format("Camera{}.", number);
  std::string text;
  const char* projection[] = {"fx", "fy", "cx", "cy"};
  for (int i = 0; i < 4; ++i) text += numberLine(prefix + projection[i], k.projection[i]);
  if (k.distortion_model == DistortionModel::kNone) return text + "\n";
  const char* radtan[] = {"k1", "k2", "p1", "p2"};
  const char* fisheye[] = {"k1", "k2", "k3", "k4"};
  for (int i = 0; i < 4; ++i) {
    text += numberLine(prefix + (isFisheye(camera) ? fisheye[i] : radtan[i]), k.distortion[i]);
  }
  return text + "\n";
}

/// For fisheye pairs, of which the tool wants to know the columns that both cameras see.
std::string overlapText(const Calibration& calibration) {
  std::string text =
      "# Columns that both cameras see: set to all columns, narrow them if you know the overlap.\n";
  for (int i = 1; i <= 2; ++i) {
    text += fmt::format("Camera{0}.overlappingBegin: 0\nCamera{0}.overlappingEnd: {1}\n", i,
                        calibration.cameras.front().intrinsics.resolution.width - 1);
  }
  return text;
}

// Both transforms of the file are of floats, as in the tool's own settings; their rounding is below
// a micrometre.
std::string stereoText(const Calibration& calibration) {
  std::string text = "# Camera 2 into camera 1.\n" +
                     opencvMatrix("Stereo.T_c1_c2", calibration.cameras[1].T_C0Ci, 'f') +
                     "# Points nearer than this many baselines count as close (a setting).\n"
                     "Stereo.ThDepth: 60.0\n";
  if (isFisheye(calibration.cameras.front())) text += overlapText(calibration);
  return text + "\n";
}

std::string imageText(const Calibration& calibration, const ExportOptions& options) {
  const Resolution& size = calibration.cameras.front().intrinsics.resolution;
  return fmt::format(
      "Camera.width: {}\nCamera.height: {}\n# Must be a whole number, otherwise the tool "
      "stops.\nCamera.fps: {}\nCamera.RGB: 1\n",
      size.width, size.height, std::lround(options.camera_rate_hz.value_or(kAssumedRate)));
}

std::string orbSlam3Imu(const ImuCalibration& imu) {
  return "\n# Camera 1 into the IMU (body).\n" + opencvMatrix("IMU.T_b_c1", imu.T_SC0, 'f') +
         "# Continuous-time densities; the tool multiplies by the root of the frequency itself.\n" +
         numberLine("IMU.NoiseGyro", imu.noise.gyro_density) +
         numberLine("IMU.NoiseAcc", imu.noise.accel_density) +
         numberLine("IMU.GyroWalk", imu.noise.gyro_random_walk) +
         numberLine("IMU.AccWalk", imu.noise.accel_random_walk) +
         numberLine("IMU.Frequency", imu.noise.rate_hz);
}

}  // namespace

ExportedFiles exportOrbSlam3(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  const std::string type = checkedType(source);
  const double rate = options.camera_rate_hz.value_or(kAssumedRate);
  if (rate < 1 || rate != std::round(rate)) {
    source.refuse(InputFault::kBadCameraRate,
                  fmt::format("Camera.fps must be a whole number, 1 or more, not {:g}", rate),
                  "round the rate of the images as you see fit");
  }
  ExportedFiles out;
  out.warnings = orbSlam3Warnings(source);
  std::string text = opencvHeader(options, out.warnings) +
                     fmt::format("\nFile.version: \"1.0\"\nCamera.type: \"{}\"\n\n", type);
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) {
    text += cameraText(calibration.cameras[i], static_cast<int>(i) + 1);
  }
  if (calibration.cameras.size() == 2) text += stereoText(calibration);
  text += imageText(calibration, options);
  if (calibration.imu) text += orbSlam3Imu(*calibration.imu);
  out.files.push_back({"orbslam3.yaml", text + kOrbSlam3Settings});
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Keys as OKVIS2's ViParametersReader reads them. It stops where one is missing, and where a real
// number has no decimal point.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/calibration/export/tools.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

constexpr const char* kOkvis2Settings = R"(
# From here on: settings of the tool with the values of its own examples. They are no results of
# the calibration; tune them.
frontend_parameters:
    detection_threshold: 38.0
    absolute_threshold: 150.0
    matching_threshold: 60.0
    octaves: 0
    max_num_keypoints: 700
    keyframe_overlap: 0.60
    use_cnn: false
    parallelise_detection: true
    num_matching_threads: 4
estimator_parameters:
    num_keyframes: 5
    num_loop_closure_frames: 3
    num_imu_frames: 3
    do_loop_closures: true
    do_final_ba: false
    enforce_realtime: false
    realtime_min_iterations: 3
    realtime_max_iterations: 10
    realtime_time_limit: 0.035
    realtime_num_threads: 3
    full_graph_iterations: 15
    full_graph_num_threads: 3
output_parameters:
    display_matches: true
    display_overhead: false
)";

constexpr PinholeWords kOkvis2Words{"radialtangential", "equidistant", "radialtangential8"};

// radialtangential wants four numbers, zeros where there is no distortion; radialtangential8 wants
// eight, in OpenCV's order, which is ours.
Eigen::VectorXd coefficients(const Intrinsics& k) {
  if (k.distortion_model == DistortionModel::kRational) return k.distortion;
  return fourCoefficients(k);
}

std::string cameraText(const CameraCalibration& camera, const Transform& T_SC,
                       const ExportSource& source) {
  const Intrinsics& k = camera.intrinsics;
  const std::string indent = "        ";
  // First: it refuses what follows.
  const char* distortion = source.distortionWord(camera, kOkvis2Words);
  return fmt::format("     - {{T_SC:\n{0}{1},\n{0}image_dimension: [{2}, {3}],\n", indent,
                     sixteenNumbers(T_SC, indent), k.resolution.width, k.resolution.height) +
         fmt::format("{}distortion_coefficients: {},\n{}distortion_type: {},\n", indent,
                     yamlList(coefficients(k)), indent, distortion) +
         fmt::format("{0}focal_length: {1},\n{0}principal_point: {2},\n", indent,
                     yamlList(k.projection.head(2)), yamlList(k.projection.tail(2))) +
         fmt::format("{0}camera_type: gray,\n{0}slam_use: okvis}}\n", indent);
}

/// image_delay = -t_d. Subtracted from 0.0, so that an offset of zero is not written as "-0.0".
std::string cameraParameters(const Calibration& calibration) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) all.push_back(i);
  return fmt::format(
             "\ncamera_parameters:\n    timestamp_tolerance: 0.005\n    sync_cameras: [{}]\n",
             fmt::join(all, ", ")) +
         "    # Minus our time offset: t_imu = t_cam - image_delay.\n" +
         numberLine("    image_delay", 0.0 - calibration.imu->timeOffset()) +
         "    online_calibration:\n        do_extrinsics: false\n"
         "        do_extrinsics_final_ba: false\n        sigma_r: 0.01\n"
         "        sigma_alpha: 0.05\n";
}

// T_BS is the identity: the body of OKVIS2's states is then our IMU.
std::string imuParameters(const ImuCalibration& imu) {
  return "\nimu_parameters:\n    use: true\n"
         "    # Saturation [m/s^2, rad/s], priors of the biases and their starts: not calibrated.\n"
         "    a_max: 176.0\n    g_max: 7.8\n    sigma_bg: 0.01\n    sigma_ba: 0.1\n"
         "    g0: [0.0, 0.0, 0.0]\n    a0: [0.0, 0.0, 0.0]\n"
         "    # Continuous-time densities.\n" +
         numberLine("    sigma_g_c", imu.noise.gyro_density) +
         numberLine("    sigma_a_c", imu.noise.accel_density) +
         numberLine("    sigma_gw_c", imu.noise.gyro_random_walk) +
         numberLine("    sigma_aw_c", imu.noise.accel_random_walk) +
         numberLine("    g", imu.gravity_m_s2) + "    T_BS:\n        " +
         sixteenNumbers(Transform(), "        ") + "\n";
}

}  // namespace

ExportedFiles exportOkvis2(const ExportSource& source) {
  const auto& [calibration, options, tool] = source;
  const ImuCalibration& imu = source.neededImu();
  ExportedFiles out;
  const std::vector<std::string> notes{
      "OKVIS2 uses the time offset with the opposite sign: image_delay is minus our time offset.",
      "a_max and g_max are those of the tool's EuRoC example: set them to your IMU's range, or "
      "samples beyond them count as saturated."};
  out.warnings = offsetWarnings(source, "image_delay is written as 0.");
  out.warnings.insert(out.warnings.end(), notes.begin(), notes.end());
  std::string text =
      opencvHeader(options, out.warnings) + "\n# T_SC maps camera to IMU.\ncameras:\n";
  for (const CameraCalibration& camera : calibration.cameras) {
    text += cameraText(camera, imu.T_SC0 * camera.T_C0Ci, source);
  }
  text += cameraParameters(calibration) + imuParameters(imu);
  out.files.push_back({"okvis2.yaml", text + kOkvis2Settings});
  return out;
}

}  // namespace plumbline

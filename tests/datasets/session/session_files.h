// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tests/datasets/temporary_folder.h"

namespace plumbline {

// The files of a small, faultless session: two frames of two cameras, three IMU samples.

inline const std::string kTargetText =
    "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n";
inline const std::string kImuYamlText =
    "rostopic: /imu0\nupdate_rate: 200.0\naccelerometer_noise_density: 2.0e-3\n"
    "accelerometer_random_walk: 3.0e-3\ngyroscope_noise_density: 1.6968e-4\n"
    "gyroscope_random_walk: 1.9393e-5\n";
inline const std::string kSensorText =
    "camera_model: pinhole\ndistortion_model: radial-tangential\nresolution: [752, 480]\n";
inline const std::string kCornersText =
    "#timestamp [ns],corner_id,u [px],v [px]\n"
    "1400000000000000000,0,100.5,200.25\n1400000000000000000,1,110.5,200.25\n"
    "1400000000050000000,0,101.5,201.25\n";
inline const std::string kSamplesText =
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
    "1400000000000000000,0.1,0.2,0.3,9.7,0.5,0.6\n1400000000005000000,0.1,0.2,0.3,9.7,0.5,0.6\n"
    "1400000000010000000,0.1,0.2,0.3,9.7,0.5,0.6\n";

/// Writes them into `folder`, below `level` ("" or "mav0/").
inline void writeGoodSession(const TemporaryFolder& folder, const std::string& level = "") {
  folder.write("target.yaml", kTargetText);
  folder.write("imu.yaml", kImuYamlText);
  folder.write(level + "imu0/data.csv", kSamplesText);
  for (const char* camera : {"cam0/", "cam1/"}) {
    folder.write(level + camera + "sensor.yaml", kSensorText);
    folder.write(level + camera + "corners.csv", kCornersText);
  }
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// A camera-IMU rig whose true calibration is known. `calibration.imu` is always there; its
/// noise.rate_hz is the IMU's rate.
struct SimulatedRig {
  std::string name;
  Calibration calibration;
  double camera_rate_hz = 20;
};

/// The presets:
/// - "euroc": two 752x480 pinhole-radtan cameras, 11 cm apart, ADIS16448; 20 Hz and 200 Hz
///   (values of the sensor.yaml files that Burri et al. publish with the data set);
/// - "tumvi": two 512x512 pinhole-equidistant fisheye cameras, 10 cm apart, BMI160; 20 Hz and
///   200 Hz (after Schubert et al.'s published calibration);
/// - "d435i": two 640x480 pinhole-radtan cameras, 5 cm apart, 15 Hz and 400 Hz, with the noise
///   densities the paper uses for the RealSense D435i.
/// Each has a time offset unlike zero. Throws InputError for another name.
SimulatedRig simulatedRig(const std::string& name);

/// Names that simulatedRig() knows.
std::vector<std::string> simulatedRigNames();

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/rig.h"
#include "evaluate/lint/lint.h"

namespace plumbline {

/// A calibration of the euroc rig under a file's name, `k` tenths of a millimetre, of a
/// milliradian, of a pixel and of a millisecond off: as repeats of a calibration differ.
inline LintedCalibration repeatOf(const SimulatedRig& rig, const std::string& name, int k = 0) {
  LintedCalibration linted{name, rig.calibration, true};
  Calibration& c = linted.calibration;
  const double off = 1e-4 * k;
  c.imu->T_SC0 = Transform(Eigen::Matrix3d(expSO3({off, -off, off}) * c.imu->T_SC0.R),
                           c.imu->T_SC0.t + Eigen::Vector3d(off, off, -off));
  c.imu->time_offsets = {{5e-3 + off}};
  for (CameraCalibration& camera : c.cameras) camera.intrinsics.projection.array() += 0.1 * k;
  return linted;
}

/// One mistake that people make, and the rule that must name it.
struct LintCase {
  const char* what;
  std::function<void(Calibration&)> inject;
  const char* rule;
  const char* field;  ///< in the advice
};

inline void swapCameras(Calibration& c) {
  const Transform T_C0C1 = c.cameras[1].T_C0Ci;
  std::swap(c.cameras[0].intrinsics, c.cameras[1].intrinsics);
  c.cameras[1].T_C0Ci = T_C0C1.inverse();
  if (c.imu) c.imu->T_SC0 = c.imu->T_SC0 * T_C0C1;
}

inline void invertImu(Calibration& c) { c.imu->T_SC0 = c.imu->T_SC0.inverse(); }
inline void negateOffset(Calibration& c) { c.imu->time_offsets[0].s *= -1; }
inline void invertBaseline(Calibration& c) { c.cameras[1].T_C0Ci = c.cameras[1].T_C0Ci.inverse(); }
inline void makeDensitiesDiscrete(Calibration& c) {
  c.imu->noise.gyro_density *= std::sqrt(c.imu->noise.rate_hz);
  c.imu->noise.accel_density *= std::sqrt(c.imu->noise.rate_hz);
}

inline std::string rulesOf(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text += f.rule + ": " + f.evidence + " -> " + f.advice + "\n";
  }
  return text;
}

}  // namespace plumbline

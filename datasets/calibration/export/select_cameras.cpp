// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/export/select_cameras.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

std::string namesOf(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const CameraCalibration& camera : calibration.cameras) names.push_back(camera.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

const CameraCalibration& named(const Calibration& calibration, const std::string& name,
                               const std::string& path) {
  for (const CameraCalibration& camera : calibration.cameras) {
    if (camera.name == name) return camera;
  }
  throw InputError(path, 0,
                   fmt::format("has no camera '{}'; expected some of {}; correct --only", name,
                               namesOf(calibration)));
}

// Of the cameras chosen, where the cameras have offsets of their own; the first one's is that of
// all else.
void selectOffsets(const Calibration& from, ImuCalibration& imu,
                   const std::vector<CameraCalibration>& chosen) {
  const std::vector<double>& own = from.imu->camera_time_offsets_s;
  if (own.size() != from.cameras.size()) return;
  imu.camera_time_offsets_s.clear();
  for (const CameraCalibration& camera : chosen) {
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (from.cameras[i].name == camera.name) imu.camera_time_offsets_s.push_back(own[i]);
    }
  }
  imu.time_offset_s = imu.camera_time_offsets_s.front();
}

}  // namespace

Calibration selectCameras(const Calibration& calibration, const std::vector<std::string>& names,
                          const std::string& path) {
  if (names.empty()) return calibration;
  Calibration chosen{{}, calibration.imu};
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1) {
      throw InputError(path, 0,
                       fmt::format("camera '{}' is asked for twice; correct --only", name));
    }
    chosen.cameras.push_back(named(calibration, name, path));
  }
  if (chosen.imu) selectOffsets(calibration, *chosen.imu, chosen.cameras);
  if (names.front() == calibration.cameras.front().name) return chosen;
  const Transform T_C0Cn = chosen.cameras.front().T_C0Ci;
  for (CameraCalibration& camera : chosen.cameras) {
    camera.T_C0Ci = T_C0Cn.inverse() * camera.T_C0Ci;
    camera.T_C0Ci_std.reset();
  }
  chosen.cameras.front().T_C0Ci = Transform();
  if (chosen.imu) {
    chosen.imu->T_SC0 = chosen.imu->T_SC0 * T_C0Cn;
    chosen.imu->T_SC0_std.reset();
  }
  return chosen;
}

}  // namespace plumbline

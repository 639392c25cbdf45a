// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/export/export_checks.h"

#include <cassert>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {

void ExportChecks::refuse(const std::string& what, const std::string& cure) const {
  throw InputError(options_.source, 0, fmt::format("{}: {}; {}", tool_, what, cure));
}

void ExportChecks::atMostCameras(std::size_t count) const {
  if (calibration_.cameras.size() <= count) return;
  refuse(fmt::format("it takes at most {} cameras, this calibration has {}", count,
                     calibration_.cameras.size()),
         "choose with --only, e.g. --only cam0,cam1");
}

void ExportChecks::oneResolution() const {
  const Resolution& first = calibration_.cameras.front().intrinsics.resolution;
  for (const CameraCalibration& camera : calibration_.cameras) {
    const Resolution& size = camera.intrinsics.resolution;
    if (size == first) continue;
    refuse(fmt::format("it takes one image size, {} has {}x{} and {} has {}x{}",
                       calibration_.cameras.front().name, first.width, first.height, camera.name,
                       size.width, size.height),
           "export one camera with --only");
  }
}

void ExportChecks::oneModel() const {
  const CameraCalibration& first = calibration_.cameras.front();
  for (const CameraCalibration& camera : calibration_.cameras) {
    if (modelName(camera.intrinsics) == modelName(first.intrinsics)) continue;
    refuse(fmt::format("it takes one camera model, {} is {} and {} is {}", first.name,
                       modelName(first.intrinsics), camera.name, modelName(camera.intrinsics)),
           "calibrate both cameras with the same model, or export one camera with --only");
  }
}

const ImuCalibration& ExportChecks::neededImu() const {
  if (!calibration_.imu) {
    refuse("it needs an IMU, and this calibration has none",
           "calibrate with the recording's IMU, or export to kalibr, orbslam3 or camera_info");
  }
  knownNoise();
  return *calibration_.imu;
}

void ExportChecks::knownNoise() const {
  if (!calibration_.imu) return;
  if (!options_.noise_known) {
    refuse("it needs the IMU's noise densities, and this file does not state them",
           "give them with --imu imu.yaml (Kalibr's)");
  }
  const ImuNoise& n = calibration_.imu->noise;
  const bool positive = n.gyro_density > 0 && n.gyro_random_walk > 0 && n.accel_density > 0 &&
                        n.accel_random_walk > 0 && n.rate_hz > 0;
  if (!positive) {
    refuse("a noise density or the IMU's rate is not positive",
           "correct the calibration, or give --imu imu.yaml");
  }
}

void ExportChecks::refuseModel(const CameraCalibration& camera, const std::string& known) const {
  refuse(fmt::format("it cannot represent {}, which is {}; it has {}", camera.name,
                     modelName(camera.intrinsics), known),
         "calibrate this camera with a model that it has, or export to another tool "
         "(docs/export.md)");
}

std::string modelName(const Intrinsics& intrinsics) {
  return toString(intrinsics.projection_model) + "-" + toString(intrinsics.distortion_model);
}

bool isPinhole(const Intrinsics& intrinsics, DistortionModel distortion) {
  return intrinsics.projection_model == ProjectionModel::kPinhole &&
         intrinsics.distortion_model == distortion;
}

Eigen::Vector4d fourCoefficients(const Intrinsics& intrinsics) {
  if (intrinsics.distortion_model == DistortionModel::kNone) return Eigen::Vector4d::Zero();
  assert(intrinsics.distortion.size() == 4);
  return intrinsics.distortion;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

/// Refusals that tools share. Each throws InputError with the tool's name and what to do.
class ExportChecks {
 public:
  /// `tool` as its authors write it; both references must outlive the checks.
  ExportChecks(const Calibration& calibration, const ExportOptions& options, std::string tool)
      : calibration_(calibration), options_(options), tool_(std::move(tool)) {}

  void atMostCameras(std::size_t count) const;
  void oneResolution() const;
  /// The same projection and distortion for all cameras.
  void oneModel() const;
  /// The IMU with noise that is known and positive.
  const ImuCalibration& neededImu() const;
  /// As neededImu() where there is an IMU.
  void knownNoise() const;
  /// A camera whose model the tool does not have; `known` lists those that it has.
  [[noreturn]] void refuseModel(const CameraCalibration& camera, const std::string& known) const;
  [[noreturn]] void refuse(const std::string& what, const std::string& cure) const;

 private:
  const Calibration& calibration_;
  const ExportOptions& options_;
  std::string tool_;
};

/// "pinhole-radtan".
std::string modelName(const Intrinsics& intrinsics);

/// Whether the camera is a pinhole with this distortion.
bool isPinhole(const Intrinsics& intrinsics, DistortionModel distortion);

/// The distortion's four coefficients (radtan k1 k2 p1 p2; equidistant k1 k2 k3 k4), zeros for
/// none.
Eigen::Vector4d fourCoefficients(const Intrinsics& intrinsics);

}  // namespace plumbline

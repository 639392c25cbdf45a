// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/enum_words.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"

namespace plumbline {

/// What a study changes before it calibrates again.
enum class PerturbationKind {
  kImuShift,           ///< adds `amount` ms to every IMU stamp
  kTargetSize,         ///< states the target `amount` % larger than it is
  kNoiseDensities,     ///< multiplies the four densities by `amount`
  kInitialIntrinsics,  ///< starts the camera stage from focal lengths that are `amount` % off
  kDroppedFrames,      ///< leaves each frame out with a chance of `amount` %
  kDroppedImu,         ///< leaves each IMU sample out with a chance of `amount` %
  kCornerNoise,        ///< adds normal noise of `amount` px to both coordinates of every corner
};

constexpr std::array<const char*, 7> enumWords(PerturbationKind /*of*/) {
  return {"imu-shift",      "target-size", "noise-densities", "initial-intrinsics",
          "dropped-frames", "dropped-imu", "corner-noise"};
}
/// Of `amount`: "ms", "%", "x" (a factor), "px".
std::string unitOf(PerturbationKind kind);
/// Whether anything is drawn, so that repeats under other seeds differ.
bool isRandom(PerturbationKind kind);

struct Perturbation {
  PerturbationKind kind = PerturbationKind::kImuShift;
  double amount = 0;
  std::uint64_t seed = 0;  ///< only where isRandom()

  /// Throws InputError where percents are not above -100 (or below 100 where something is dropped),
  /// a factor not above 0, noise below 0.
  void check() const;
};

/// What a calibration starts from.
struct StudyInputs {
  const Session* session = nullptr;
  std::vector<CameraCalibration> cameras;  ///< given ones, or those of the base calibration
  bool cameras_fixed = false;  ///< they were given: no perturbation calibrates them again
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
};

/// The inputs with one perturbation applied.
struct PerturbedInputs {
  std::optional<Session> session;  ///< changed copy; empty: the study's own
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
  bool calibrate_cameras = false;  ///< the change touches what the cameras were calibrated from
};

/// Applies `p`, of which check() holds.
PerturbedInputs perturbed(const StudyInputs& inputs, const Perturbation& p);

}  // namespace plumbline

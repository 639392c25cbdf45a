// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

struct EffectiveScores;

/// T_SC0's tangent by each component of the specific force.
inline constexpr int kMountTerms = 3 * 6;

/// Columns of faults that the batch does not estimate, behind those of its border.
struct FaultColumns {
  FaultColumns(const CameraImuEstimate& estimate, bool free_cameras);

  BorderLayout border;           ///< the calibration's own columns
  int samples = 0;               ///< first of SampleFaults
  int drift = 0;                 ///< of the IMU's clock: t_d grows by this a second
  int sway = 0;                  ///< target displaced by a sine, a cosine along x, y, z of F [m]
  int gyro_jump = 0;             ///< of the gyroscope's bias in one link, 3 [rad/s]
  int accel_jump = 0;            ///< of the accelerometer's bias in one link, 3 [m/s^2]
  int target_jump = 0;           ///< of the target in one link, along x, y, z of F [m]
  int of_links = 0;              ///< links touch no column from here on
  int line_delay = 0;            ///< readout time of the image's height, of all cameras [s]
  int column_delay = 0;          ///< readout time of the image's width, of all cameras [s]
  int target_size = 0;           ///< relative; the target is larger than stated
  int shape = 0;                 ///< kBoardTerms, of TargetBasis [m]
  int soft_mount = 0;            ///< kMountTerms, see UnmodelledFault::kSoftMount
  std::vector<int> line_delays;  ///< per camera; of the only one, line_delay
  std::vector<int> own_offset;   ///< per camera, less camera 0's [s]; -1 for camera 0
  std::vector<int> T_C0Ci;       ///< per camera, 6; -1 for camera 0
  std::vector<int> intrinsics;   ///< per camera, first of stacked()
  int size = 0;
};

/// A fault with its columns.
struct FaultCandidate {
  UnmodelledFault fault{};
  int camera = -1;
  std::vector<int> columns;
  bool begins = false;                   ///< at an instant
  std::vector<int> nuisance{};           ///< free beside it, though the batch holds them
  std::optional<TimeNs> at{};            ///< where its instant was found already
  std::optional<double> frequency_hz{};  ///< likewise its frequency
  int changes = 0;                       ///< at so many instants, evenly spaced
  double dispersion = 0;                 ///< of what it explains by chance, where that is known
};

std::vector<int> columnRange(int first, int count);

/// All parameters of cameras that were not calibrated on the recording, in the order of the
/// cameras' own stage.
std::vector<int> givenCameras(const FaultColumns& columns, const CameraImuEstimate& estimate);

/// The faults that are tested, with what effectiveScores() found about their instants and
/// frequencies.
std::vector<FaultCandidate> faultCandidates(const FaultColumns& columns,
                                            const CameraImuEstimate& estimate,
                                            const EffectiveScores& found);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/faults/fault_columns.h"

#include <numeric>
#include <utility>

#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/faults/score_tests.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {

/// What the batch estimates already keeps its column in the border.
FaultColumns::FaultColumns(const CameraImuEstimate& estimate, bool free_cameras)
    : border(estimate, free_cameras) {
  int at = border.size;
  const auto take = [&at](int count) {
    const int first = at;
    at += count;
    return first;
  };
  // First what links touch, so that their J_B need not be wider; then what views alone show.
  samples = take(SampleFaults::kCount);
  drift = take(1);
  sway = take(6);
  gyro_jump = take(3);
  accel_jump = take(3);
  target_jump = take(3);
  of_links = at;
  line_delay = take(1);
  column_delay = take(1);
  target_size = take(1);
  shape = take(kBoardTerms);
  soft_mount = take(kMountTerms);
  const bool one = estimate.cameras.size() == 1;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    line_delays.push_back(one ? line_delay : take(1));
  }
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    // A fault's column only where the batch does not estimate the camera's offset already.
    const bool own = border.own_offset[c] >= 0;
    own_offset.push_back(c == 0 ? -1 : own ? border.own_offset[c] : take(1));
  }
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    T_C0Ci.push_back(c == 0 ? -1 : free_cameras ? border.T_C0Ci[c] : take(6));
  }
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const auto count = static_cast<int>(estimate.cameras[c].intrinsics.stacked().size());
    intrinsics.push_back(free_cameras ? border.intrinsics[c] : take(count));
  }
  size = at;
}

std::vector<int> columnRange(int first, int count) {
  std::vector<int> out(count);
  std::iota(out.begin(), out.end(), first);
  return out;
}

std::vector<int> givenCameras(const FaultColumns& columns, const CameraImuEstimate& estimate) {
  std::vector<int> out;
  const auto add = [&](int first, int count) {
    for (int k = 0; k < count; ++k) out.push_back(first + k);
  };
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    add(columns.intrinsics[c], static_cast<int>(estimate.cameras[c].intrinsics.stacked().size()));
  }
  for (std::size_t c = 1; c < estimate.cameras.size(); ++c) add(columns.T_C0Ci[c], 6);
  return out;
}

std::vector<FaultCandidate> faultCandidates(const FaultColumns& columns,
                                            const CameraImuEstimate& estimate,
                                            const EffectiveScores& found) {
  using Fault = UnmodelledFault;
  std::vector<FaultCandidate> out;
  const auto add = [&](Fault fault, std::vector<int> of) -> FaultCandidate& {
    return out.emplace_back(FaultCandidate{.fault = fault, .columns = std::move(of)});
  };
  // Of the inertial samples, all along. Of a 3 x 3 matrix, row by row.
  const int a = columns.samples + SampleFaults::kAccel;
  const int g = columns.samples + SampleFaults::kGyro;
  add(Fault::kAccelScale, {a, a + 4, a + 8});
  add(Fault::kAccelMisalignment, {a + 1, a + 2, a + 3, a + 5, a + 6, a + 7});
  add(Fault::kGyroScale, {g, g + 4, g + 8});
  add(Fault::kGyroMisalignment, {g + 1, g + 2, g + 3, g + 5, g + 6, g + 7});
  add(Fault::kGSensitivity, columnRange(columns.samples + SampleFaults::kGSensitivity, 9));
  add(Fault::kImuDelay, {columns.samples + SampleFaults::kDelay});
  // Of the stamps; an offset of its own in each eighth of the recording.
  add(Fault::kClockDrift, {columns.drift});
  // One readout time of all cameras, and of each alone.
  add(Fault::kLineDelay, {columns.line_delay});
  const auto cameras = columns.line_delays.size();
  for (std::size_t c = 0; c < (cameras > 1 ? cameras : 0); ++c) {
    add(Fault::kLineDelay, {columns.line_delays[c]}).camera = static_cast<int>(c);
  }
  add(Fault::kColumnDelay, {columns.column_delay});
  add(Fault::kClockStep, {BorderLayout::kOffset}).begins = true;
  add(Fault::kStampsWander, {BorderLayout::kOffset}).changes = 7;
  // A mount that gives way to the rig's own force, all along.
  add(Fault::kSoftMount, columnRange(columns.soft_mount, kMountTerms));
  // Of the target, and an IMU that slipped. Beside the target's shape stands what a calibration of
  // the cameras has adapted to it.
  add(Fault::kTargetSize, {columns.target_size});
  add(Fault::kImuMoved, columnRange(BorderLayout::kExtrinsics, 6)).begins = true;
  add(Fault::kTargetShape, columnRange(columns.shape, kBoardTerms)).nuisance =
      givenCameras(columns, estimate);
  // Jumps, whose instants were found. Those of the biases are measured against the stated walk of
  // the biases, which a pixel_sigma that is too large does not touch, though the calibration's
  // deviations do shrink by it.
  const auto addJump = [&](Fault fault, int column, TimeNs at, double dispersion) {
    FaultCandidate& jump = add(fault, columnRange(column, 3));
    jump.at = at;
    jump.dispersion = dispersion;
  };
  const JumpPlaces& jumps = found.jumps;
  addJump(Fault::kTargetMoved, columns.target_jump, jumps.target_at, jumps.target_dispersion);
  add(Fault::kTargetSways, columnRange(columns.sway, 6)).frequency_hz = found.sway_hz;
  addJump(Fault::kGyroBiasJump, columns.gyro_jump, jumps.gyro_at, 1);
  addJump(Fault::kAccelBiasJump, columns.accel_jump, jumps.accel_at, 1);
  for (std::size_t c = 1; c < columns.T_C0Ci.size(); ++c) {
    const int camera = static_cast<int>(c);
    // Otherwise the batch estimates it already.
    if (columns.own_offset[c] >= columns.border.size) {
      add(Fault::kCameraDelay, {columns.own_offset[c]}).camera = camera;
    }
    FaultCandidate& moved = add(Fault::kCameraMoved, columnRange(columns.T_C0Ci[c], 6));
    moved.camera = camera;
    moved.begins = true;
  }
  return out;
}

}  // namespace plumbline

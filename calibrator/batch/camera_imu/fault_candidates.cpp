// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/diagnosis.h"

namespace plumbline {
namespace {

std::vector<int> columnRange(int first, int count) {
  std::vector<int> out;
  for (int k = 0; k < count; ++k) out.push_back(first + k);
  return out;
}

/// Faults of the inertial samples, which act all along.
std::vector<Candidate> sampleFaults(const FaultColumns& columns) {
  const int a = columns.samples + SampleFaults::kAccel;
  const int g = columns.samples + SampleFaults::kGyro;
  const int sensitivity = columns.samples + SampleFaults::kGSensitivity;
  // Of a 3 x 3 matrix, row by row.
  const auto diagonal = [](int m) { return std::vector<int>{m, m + 4, m + 8}; };
  const auto rest = [](int m) {
    return std::vector<int>{m + 1, m + 2, m + 3, m + 5, m + 6, m + 7};
  };
  return {
      {.fault = UnmodelledFault::kAccelScale, .columns = diagonal(a)},
      {.fault = UnmodelledFault::kAccelMisalignment, .columns = rest(a)},
      {.fault = UnmodelledFault::kGyroScale, .columns = diagonal(g)},
      {.fault = UnmodelledFault::kGyroMisalignment, .columns = rest(g)},
      {.fault = UnmodelledFault::kGSensitivity, .columns = columnRange(sensitivity, 9)},
      {.fault = UnmodelledFault::kImuDelay, .columns = {columns.samples + SampleFaults::kDelay}}};
}

/// Jumps of the biases. They are measured against the stated walk of the biases, which a
/// pixel_sigma that is too large does not touch, though the calibration's deviations do shrink
/// by it.
std::vector<Candidate> biasJumps(const FaultColumns& columns, const EffectiveScores& found) {
  constexpr double kWalk = 1;
  return {{.fault = UnmodelledFault::kGyroBiasJump,
           .columns = columnRange(columns.gyro_jump, 3),
           .at = found.jumps.gyro_at,
           .dispersion = kWalk},
          {.fault = UnmodelledFault::kAccelBiasJump,
           .columns = columnRange(columns.accel_jump, 3),
           .at = found.jumps.accel_at,
           .dispersion = kWalk}};
}

/// Faults of the stamps.
std::vector<Candidate> clockFaults(const FaultColumns& columns) {
  // An offset of its own in each eighth of the recording.
  constexpr int kChanges = 7;
  return {
      {.fault = UnmodelledFault::kClockDrift, .columns = {columns.drift}},
      {.fault = UnmodelledFault::kLineDelay, .columns = {columns.line_delay}},
      {.fault = UnmodelledFault::kClockStep, .columns = {BorderLayout::kOffset}, .begins = true},
      {.fault = UnmodelledFault::kStampsWander,
       .columns = {BorderLayout::kOffset},
       .changes = kChanges}};
}

/// Faults of the target, and an IMU that slipped.
std::vector<Candidate> bodyFaults(const FaultColumns& columns, const CameraImuEstimate& estimate,
                                  const EffectiveScores& found) {
  return {{.fault = UnmodelledFault::kTargetSize, .columns = {columns.target_size}},
          {.fault = UnmodelledFault::kImuMoved,
           .columns = columnRange(BorderLayout::kExtrinsics, 6),
           .begins = true},
          {.fault = UnmodelledFault::kTargetShape,
           .columns = columnRange(columns.shape, kBoardTerms),
           // What a calibration of the cameras has adapted to the target.
           .nuisance = givenCameras(columns, estimate).columns},
          {.fault = UnmodelledFault::kTargetMoved,
           .columns = columnRange(columns.target_jump, 3),
           .at = found.jumps.target_at,
           .dispersion = found.jumps.target_dispersion},
          {.fault = UnmodelledFault::kTargetSways,
           .columns = columnRange(columns.sway, 6),
           .frequency_hz = found.sway_hz}};
}

/// Faults of every camera but the first.
std::vector<Candidate> cameraFaults(const FaultColumns& columns) {
  std::vector<Candidate> out;
  for (std::size_t c = 1; c < columns.T_C0Ci.size(); ++c) {
    const int camera = static_cast<int>(c);
    // Otherwise the batch estimates it already.
    if (columns.own_offset[c] >= columns.border.size) {
      out.push_back({.fault = UnmodelledFault::kCameraDelay,
                     .camera = camera,
                     .columns = {columns.own_offset[c]}});
    }
    out.push_back({.fault = UnmodelledFault::kCameraMoved,
                   .camera = camera,
                   .columns = columnRange(columns.T_C0Ci[c], 6),
                   .begins = true});
  }
  return out;
}

}  // namespace

std::vector<Candidate> faultCandidates(const FaultColumns& columns,
                                       const CameraImuEstimate& estimate,
                                       const EffectiveScores& found) {
  std::vector<Candidate> out = sampleFaults(columns);
  for (const std::vector<Candidate>& more :
       {clockFaults(columns), bodyFaults(columns, estimate, found), biasJumps(columns, found),
        cameraFaults(columns)}) {
    out.insert(out.end(), more.begin(), more.end());
  }
  return out;
}

Candidate givenCameras(const FaultColumns& columns, const CameraImuEstimate& estimate) {
  Candidate out;
  out.fault = UnmodelledFault::kGivenCameras;
  const auto add = [&](int first, int count) {
    for (int k = 0; k < count; ++k) out.columns.push_back(first + k);
  };
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    add(columns.intrinsics[c], static_cast<int>(estimate.cameras[c].intrinsics.stacked().size()));
  }
  for (std::size_t c = 1; c < estimate.cameras.size(); ++c) add(columns.T_C0Ci[c], 6);
  return out;
}

Terms heldCameras(const FaultColumns& columns, const CameraImuEstimate& estimate) {
  Terms out;
  for (const int column : givenCameras(columns, estimate).columns) out.push_back({column, 0});
  for (const Term& term : termRange(columns.shape, kBoardTerms)) out.push_back(term);
  return out;
}

}  // namespace plumbline

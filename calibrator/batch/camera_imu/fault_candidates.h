// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/batch/camera_imu/effective_scores.h"
#include "calibrator/batch/camera_imu/score_tests.h"

namespace plumbline {

/// A fault with its columns.
struct Candidate {
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

/// The faults that are tested, with what the search of fault_search.h found about their instants
/// and frequencies.
std::vector<Candidate> faultCandidates(const FaultColumns& columns,
                                       const CameraImuEstimate& estimate,
                                       const EffectiveScores& found);

/// The cameras' parameters in the order of their own stage, then the board's terms.
Terms heldCameras(const FaultColumns& columns, const CameraImuEstimate& estimate);

}  // namespace plumbline

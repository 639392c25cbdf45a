// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/records/calibration_record.h"

namespace plumbline::test {

struct SyntheticRecordOptions {
  int frames = 120;
  int tags_seen = 20;      ///< per view
  double sigma_px = 0.35;  ///< of a corner coordinate
  bool camera_imu = true;  ///< with the second stage
  bool images = true;      ///< of the worst view
  unsigned seed = 1;
};

/// A record as a stereo rig with an IMU would leave it: a 6 x 6 grid seen from a smooth path,
/// residuals with noise and a few outliers, slowly drifting biases, covariances with plausible
/// sizes and correlations. Equal options give equal records.
CalibrationRecord syntheticRecord(const SyntheticRecordOptions& options = {});

}  // namespace plumbline::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/odometry/feature_tracker.h"
#include "calibrator/odometry/odometry.h"
#include "evaluate/odometry/sequence.h"

namespace plumbline {

struct BuiltinOptions {
  OdometryOptions odometry;
  FeatureTrackerOptions tracker;
  int cameras = 0;               ///< of the calibration, the first of them; 0: all
  double corner_sigma_px = 0.3;  ///< standard deviation of a coordinate where the tracks are a
                                 ///< board's corners, which are found better than others [px]
  double most_skipped = 0.02;    ///< share of the frames that may be missing or undecodable

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// What the built-in odometry made of a sequence.
struct BuiltinRun {
  OdometryResult result;
  std::size_t frames = 0;   ///< of camera 0, offered
  std::size_t skipped = 0;  ///< images of any camera that are missing or cannot be decoded
  double seconds = 0;
  std::vector<double> frame_s;  ///< wall time of each frame, images read included
};

/// Runs the built-in odometry on the images, or on the tracks where the sequence has these in their
/// place. Deterministic. A frame whose first image is missing or
/// damaged is skipped; where it is another camera's, that camera is left out of the frame. Throws
/// InputError for more than most_skipped of them, with the first one's fault, and for a calibration
/// of another rig: more cameras than the sequence has, or images of another size.
BuiltinRun runBuiltin(const OdometrySequence& sequence, const Calibration& calibration,
                      const BuiltinOptions& options);

/// TUM's format: t [s, 9 decimals] x y z qx qy qz qw, body = IMU, camera clock.
std::string tumText(const std::vector<StampedPose>& poses);
std::vector<StampedPose> posesOf(const OdometryResult& result);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/image.h"
#include "calibrator/odometry/corner_picker.h"
#include "calibrator/odometry/patch_tracker.h"
#include "calibrator/odometry/rig_model.h"

namespace plumbline {

struct FeatureTrackerOptions {
  int levels = 4;        ///< of the image pyramids
  int max_tracks = 180;  ///< of camera 0
  CornerPickerOptions corners;
  PatchTrackerOptions patch;
  double epipolar_px = 3;  ///< largest distance of a track from its epipolar plane
  int ransac_rounds = 60;  ///< of the direction of motion between two frames
  double nearest_m = 0.3;  ///< of the scene, where a stereo match is looked for

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Images to tracks: the front end of the odometry. Corners of camera 0 are followed from frame to
/// frame (trackThereAndBack, from where the gyro's rotation moves them) and into the other cameras
/// (from where they would be at the distance they had; the first time from the best place along
/// their epipolar line); what does not fit one motion with the
/// gyro's rotation (RANSAC over its direction from two tracks), or the rig's epipolar planes, is
/// dropped; cells that fall empty get new corners. Deterministic.
class FeatureTracker {
 public:
  FeatureTracker(RigModel rig, FeatureTrackerOptions options = {});

  /// `images`: one per camera at one stamp; an empty one where a camera has none (not camera 0).
  /// `R_before_now`: rotation R_SaSb of the IMU from the frame before to this one.
  FrameTracks track(TimeNs t, std::span<const GrayImageView> images,
                    const Eigen::Matrix3d& R_before_now);

 private:
  struct Feature {
    std::int64_t id = 0;
    Eigen::Vector2f at;                   // in camera 0
    Eigen::Vector3d ray;                  // likewise
    std::optional<double> inverse_depth;  // [1/m] along the ray, as stereo had it last
  };

  void follow(const Eigen::Matrix3d& R_before_now);
  void keepOneMotion(std::vector<Feature>& moved, const std::vector<Eigen::Vector3d>& before,
                     const Eigen::Matrix3d& R_now_before) const;
  void addCorners();
  void matchInto(std::size_t camera, FrameTracks& out);
  std::optional<double> searched(const Feature& feature, std::size_t camera,
                                 const Transform& T_C0) const;

  RigModel rig_;
  FeatureTrackerOptions options_;
  std::vector<ImagePyramid> before_, now_;
  std::vector<Feature> features_;
  std::int64_t next_id_ = 0;
};

}  // namespace plumbline

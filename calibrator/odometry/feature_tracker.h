// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/image.h"
#include "calibrator/odometry/rig_model.h"

namespace plumbline {

/// An image and its halves: level k has pixel (x, y) where level 0 has (2^k x, 2^k y). Each level
/// is the one below, smoothed by (1 4 6 4 1)/16 along both axes and thinned.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// `levels` >= 1; fewer where the image becomes smaller than 16 pixels.
  ImagePyramid(const GrayImageView& image, int levels);

  bool empty() const { return levels_.empty(); }
  int levels() const { return static_cast<int>(levels_.size()); }
  GrayImageView level(int k) const { return levels_[k].view(); }

 private:
  std::vector<GrayImage> levels_;
};

struct PatchTrackerOptions {
  int iterations = 12;            ///< a level, at most
  float step_px = 0.01F;          ///< a step shorter than this ends a level
  float min_eigenvalue = 4;       ///< of the mean squared gradient [grey levels^2/px^2]
  float min_correlation = 0.75F;  ///< of the patches' grey levels at the end
  float round_trip_px = 0.6F;     ///< there and back again
  int round_trip_levels = 2;      ///< of the way back, which begins near its end

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Finds the square of 15 x 15 pixels about `at` of one image in another one, from `guess` on, with
/// sub-pixel accuracy: translation only, from the coarsest level down, mean and contrast of the
/// grey levels free (exposure). The gradient is the template's, so that it is inverted once a
/// level. Sources: Lucas and Kanade, IJCAI 1981; Baker and Matthews, "Lucas-Kanade 20 years on",
/// IJCV 2004 (inverse compositional); Bouguet, "Pyramidal implementation of the affine Lucas Kanade
/// feature tracker", 2001. Empty where the patch leaves the image, has no texture, or does not look
/// alike at the end.
std::optional<Eigen::Vector2f> trackPatch(const ImagePyramid& from, const ImagePyramid& to,
                                          const Eigen::Vector2f& at, const Eigen::Vector2f& guess,
                                          int levels, const PatchTrackerOptions& options);

/// Correlation of the square about `at` with the one about `place`, at one level of both; -1 where
/// one of them leaves its image.
float patchCorrelation(const ImagePyramid& from, const ImagePyramid& to, const Eigen::Vector2f& at,
                       const Eigen::Vector2f& place, int level);

/// trackPatch() there and back: empty where it does not come back to where it began.
std::optional<Eigen::Vector2f> trackThereAndBack(const ImagePyramid& from, const ImagePyramid& to,
                                                 const Eigen::Vector2f& at,
                                                 const Eigen::Vector2f& guess, int levels,
                                                 const PatchTrackerOptions& options);

struct CornerPickerOptions {
  int cell_px = 40;             ///< one corner a cell
  double min_distance_px = 20;  ///< from what is tracked already
  float min_eigenvalue = 20;    ///< of the mean squared gradient about it [grey levels^2/px^2]

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// New points to track: in each cell of the image without one of `taken`, the pixel with the
/// greatest smaller eigenvalue of the gradient's second moments over 7 x 7 pixels, if that is large
/// enough. At least 12 pixels from the border. Those with the greatest eigenvalue first.
/// Source: Shi and Tomasi, "Good features to track", CVPR 1994.
std::vector<Eigen::Vector2f> pickCorners(const GrayImageView& image,
                                         const std::vector<Eigen::Vector2f>& taken,
                                         const CornerPickerOptions& options);

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

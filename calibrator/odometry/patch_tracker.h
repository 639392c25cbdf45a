// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/image.h"

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

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/image.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/printed_board.h"

namespace plumbline {

/// The look of rendered images, in grey levels of 0 to 255.
struct RenderOptions {
  std::uint64_t seed = 1;      ///< of the noise
  double black_level = 25;     ///< printed black
  double white_level = 215;    ///< paper
  double wall_level = 105;     ///< what surrounds the paper
  double shading = 0.15;       ///< illumination changes by +- this ratio across the target
  double vignetting = 0.2;     ///< ratio of light lost in the corners of the image
  double blur_sigma_px = 0.7;  ///< lens blur (Gaussian), besides the area of a pixel; 0: none
  double noise_sigma = 2;      ///< standard deviation of a pixel's noise [grey levels]
  double margin_ratio = 0.3;   ///< paper around the target as a ratio of the tag size

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// Renders an AprilGrid (tag36h11, 2-bit border and corner squares, as Kalibr prints it), bent and
/// stretched as its shape says, as one camera sees it. Exact inverse mapping: each pixel's square,
/// centred on its integer coordinates, is cast on the board through unproject(); where more than
/// one surface lies in it, 64 points of a Hammersley set give the shares. Light falls off radially,
/// the lens blurs, the sensor adds noise and rounds. Safe to use from several threads at once.
class TargetRenderer {
 public:
  /// Computes the camera's rays, about 1 us per pixel. Throws InputError for a target with more
  /// tags than the family or options out of range.
  TargetRenderer(const Intrinsics& camera, const AprilGrid& target,
                 const RenderOptions& options = {});

  /// The image taken at T_FC (camera in the target's frame). `image` selects the noise: same
  /// number, same noise.
  GrayImage render(const Transform& T_FC, std::uint64_t image) const;

 private:
  /// A lattice point of the pixels' corners on the board, as a point of the even grid.
  struct Hit {
    float x = 0, y = 0;  // [m]
    GridPattern::Cell cell;
  };
  /// A camera's pose, prepared for casting rays.
  struct View {
    Eigen::Matrix3f R_FC;
    Eigen::Vector3f c_F;  // the camera's centre
  };

  Hit cast(const View& view, const Eigen::Vector3f& n) const;  // n: a ray in F
  std::vector<Hit> castRow(const View& view, int lattice_row) const;
  float pixelLight(const View& view, int x, int y, const Hit* above, const Hit* below) const;
  float mixedLight(const View& view, int x, int y, float light) const;
  std::vector<float> illuminate(const Transform& T_FC) const;
  const Eigen::Vector3f& ray(int x, int y) const {
    return rays_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
                 static_cast<std::size_t>(x)];
  }

  int width_, height_;
  AprilGrid target_;
  RenderOptions options_;
  GridPattern pattern_;
  BoardSurface surface_;
  bool is_flat_;
  std::vector<Eigen::Vector3f> rays_;  // of the pixels' corners (x - 0.5, y - 0.5); zero: none
  std::vector<float> gain_;            // of each pixel: vignetting
};

}  // namespace plumbline

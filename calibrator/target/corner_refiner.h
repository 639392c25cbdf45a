// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/image.h"
#include "calibrator/target/corner_window.h"

namespace plumbline {

/// Finds the point p that the gradients g around it point across best,
///   min_p sum_x w(x - p) (g(x) . (x - p))^2,
/// iterated with the weights moving along (W. Foerstner and E. Guelch, 1987), w falling smoothly to
/// zero at the edge of the window. Unbiased for blur and noise that are alike on all sides of
/// straight edges; hundredths of a pixel off where a lens bends them or their ends reach into the
/// window. fitCorner() starts from it. Keeps a buffer: not for two threads at once.
class CornerRefiner {
 public:
  /// The corner [px], or nothing if the gradients do not single out a point, the point leaves
  /// max_shift_px, still moves after 15 steps (3 of 6674 in EuRoC's photographs, none of 16030 in
  /// rendered images), or the four sectors around it are not dark, light, dark, light.
  std::optional<Eigen::Vector2d> refine(const GrayImageView& image, const CornerWindow& window);

 private:
  struct Patch {
    int x0 = 0, y0 = 0, width = 0, height = 0;
    bool empty() const { return width < 3 || height < 3; }
  };
  /// Ellipse of the weights: they are zero where x' inverse_shape x >= 1.
  struct Window {
    Eigen::Matrix2d inverse_shape;
    Eigen::Vector2d reach;  ///< half of its extent in x and y [px]
  };
  /// The pixels of the patch that lie within reach of a point; may be empty.
  static Patch within(const Patch& patch, const Eigen::Vector2d& centre,
                      const Eigen::Vector2d& reach);
  void fillGradients(const GrayImageView& image, const Patch& patch);
  std::optional<Eigen::Vector2d> step(const Patch& patch, const Window& window,
                                      const Eigen::Vector2d& p) const;

  std::vector<float> gx_, gy_, smooth_, slope_;
};

}  // namespace plumbline

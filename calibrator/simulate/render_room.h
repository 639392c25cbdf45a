// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/image.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/render.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// What the six sides of a box-shaped room are covered with: noise of five sizes (0.05 to 0.8 m)
/// under turned rectangles with sharp edges (0.04 to 0.5 m), as grey levels on a grid. The box is
/// that of FlightOptions::room_m.
class RoomTexture {
 public:
  static constexpr double kTexel_m = 0.004;

  RoomTexture(const Eigen::Vector3d& room_m, std::uint64_t seed);

  const Eigen::Vector3f& half() const { return half_; }

  /// Light from the side `2 axis + (1 if the positive one)` at the place p of its plane, measured
  /// from the box's middle [m]; bilinear between texels, beyond the side its border.
  float at(int side, const Eigen::Vector3f& p) const;

 private:
  Eigen::Vector3f half_;
  std::array<GrayImage, 6> sides_;
};

/// Renders a room as one camera sees it, by casting the rays of each pixel through unproject() on
/// the box's inside: the mapping is exact, whatever the lens. An exposure is the mean of its
/// sub-exposures, each with rays through another place of the pixel, so that motion blurs and
/// pixels are areas; then light falls off, the lens blurs, the sensor adds noise and rounds as
/// TargetRenderer has them. Of `options` the seed, vignetting, blur and noise count. Safe to use
/// from several threads at once.
class RoomRenderer {
 public:
  RoomRenderer(const Intrinsics& camera, std::shared_ptr<const RoomTexture> texture,
               const RenderOptions& options = {});

  /// The mean over the poses T_FC, all within the room. `image` selects the noise.
  GrayImage render(const std::vector<Transform>& T_FC, std::uint64_t image) const;

 private:
  static constexpr std::size_t kPlaces = 4;  // in a pixel

  void expose(const Transform& T_FC, const std::vector<Eigen::Vector3f>& rays,
              std::vector<float>& light) const;

  int width_, height_;
  RenderOptions options_;
  std::shared_ptr<const RoomTexture> texture_;
  std::array<std::vector<Eigen::Vector3f>, kPlaces> rays_;  // zero: none
  std::vector<float> gain_;
};

/// Poses of a camera at evenly spread instants of an exposure whose middle is the stamp: as many
/// (4 to 16) as the blur in the image's middle has pixels.
std::vector<Transform> exposurePoses(const SimulatedSession& session, int camera, TimeNs t,
                                     double exposure_s);

}  // namespace plumbline

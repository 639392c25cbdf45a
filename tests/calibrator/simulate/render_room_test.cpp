// SPDX-License-Identifier: BSD-3-Clause
// Rendered rooms show every point of the walls where the camera's model projects it.
#include "calibrator/simulate/render_room.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_flight.h"

namespace plumbline {
namespace {

RenderOptions sharp() {
  RenderOptions options;
  options.noise_sigma = options.vignetting = options.blur_sigma_px = 0;
  return options;
}

SimulatedFlight flown(const std::string& rig) {
  SimulationOptions simulation;
  simulation.duration_s = 12;
  return simulateFlight(simulatedRig(rig), simulation, {}, {});
}

struct Scene {
  SimulatedFlight flight;
  std::shared_ptr<const RoomTexture> texture =
      std::make_shared<RoomTexture>(FlightOptions().room_m, 1);
  explicit Scene(const std::string& rig) : flight(flown(rig)) {}
};

// Beyond 131 m a float has no thousandth of a texel.
TEST(RoomTexture, OfALongRoomEndsWithItsLastTexel) {
  const RoomTexture texture({140, 0.1, 0.1}, 1);
  const Eigen::Vector3f end = texture.half(), past = 2 * end;
  for (int side = 0; side < 6; ++side) EXPECT_EQ(texture.at(side, end), texture.at(side, past));
}

float interpolated(const GrayImage& image, const Eigen::Vector2d& uv) {
  const int x = static_cast<int>(uv.x()), y = static_cast<int>(uv.y());
  const double a = uv.x() - x, b = uv.y() - y;
  const auto at = [&](int i, int k) {
    return static_cast<double>(
        image.data()[static_cast<std::size_t>(y + k) * static_cast<std::size_t>(image.width()) +
                     static_cast<std::size_t>(x + i)]);
  };
  return static_cast<float>((1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) +
                            b * ((1 - a) * at(0, 1) + a * at(1, 1)));
}

/// Where the image lies against the texture seen through the model: the shift (du, dv) [px] that
/// explains image - texture best, by least squares over points on the walls.
Eigen::Vector2d shiftOf(const GrayImage& image, const Scene& scene, const Intrinsics& camera,
                        const Transform& T_FC) {
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  const Eigen::Vector3d half = scene.texture->half().cast<double>();
  for (const Eigen::Vector3d& p_F : scene.flight.landmarks) {
    const Eigen::Vector3d p_C = T_FC.inverse() * p_F;
    const auto uv = p_C.z() > 0.2 ? project(camera, p_C) : std::nullopt;
    const double border = 5;
    if (!uv || uv->minCoeff() < border || uv->x() > image.width() - border ||
        uv->y() > image.height() - border) {
      continue;
    }
    const Eigen::Vector3d p = p_F - Eigen::Vector3d(0, 0, half.z());
    int axis = 0;
    p.cwiseQuotient(half).cwiseAbs().maxCoeff(&axis);
    const float light = scene.texture->at(2 * axis + (p[axis] > 0 ? 1 : 0), p.cast<float>());
    const Eigen::Vector2d du(0.5, 0), dv(0, 0.5);
    const Eigen::Vector2d slope(interpolated(image, *uv + du) - interpolated(image, *uv - du),
                                interpolated(image, *uv + dv) - interpolated(image, *uv - dv));
    if (slope.norm() > 12) continue;  // edges, of which a pixel's mean is not the middle's light
    H += slope * slope.transpose();
    b += slope * (light - interpolated(image, *uv));
  }
  return H.ldlt().solve(b);
}

TEST(RoomRenderer, WallsLieWhereTheModelPutsThem) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const Scene scene(rig);
    const SimulatedSession& r = scene.flight.recording;
    for (const int camera : {0, 1}) {
      const Intrinsics& lens = r.truth.cameras[static_cast<std::size_t>(camera)].intrinsics;
      const RoomRenderer renderer(lens, scene.texture, sharp());
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      int images = 0;
      for (std::size_t frame = 60; frame < r.frame_stamps.size(); frame += 30, ++images) {
        const Transform T_FC = r.cameraPose(camera, r.frame_stamps[frame]);
        sum += shiftOf(renderer.render({T_FC}, 0), scene, lens, T_FC);
      }
      // A pixel's centre taken for its corner would show as 0.7; the edges near some of the points,
      // the same in all images, leave 0.03 to 0.05.
      EXPECT_LT((sum / images).norm(), 0.08) << rig << camera;
    }
  }
}

TEST(RoomRenderer, TheMiddleOfTheExposureIsTheStamp) {
  const Scene scene("euroc");
  const SimulatedSession& r = scene.flight.recording;
  const Intrinsics& lens = r.truth.cameras[0].intrinsics;
  std::size_t fastest = 0;
  const auto speed = [&](std::size_t k) {
    return r.motionAtCameraTime(r.frame_stamps[k]).omega_B.norm();
  };
  for (std::size_t k = 0; k < r.frame_stamps.size(); ++k) {
    if (speed(k) > speed(fastest)) fastest = k;
  }
  ASSERT_GT(speed(fastest), 2);
  const TimeNs t = r.frame_stamps[fastest];
  const std::vector<Transform> poses = exposurePoses(r, 0, t, 0.004);
  EXPECT_GE(poses.size(), 4U);
  EXPECT_LE(poses.size(), 16U);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Transform& T : poses) mean += T.t / static_cast<double>(poses.size());
  EXPECT_LT((mean - r.cameraPose(0, t).t).norm(), 1e-5);
  const GrayImage blurred = RoomRenderer(lens, scene.texture, sharp()).render(poses, 0);
  EXPECT_LT(shiftOf(blurred, scene, lens, r.cameraPose(0, t)).norm(), 0.3);
  // Of the exposure's begin it is half the blur away.
  EXPECT_GT(shiftOf(blurred, scene, lens, poses.front()).norm(), 0.8);
}

TEST(RoomRenderer, NoiseIsThatOfItsImage) {
  const Scene scene("euroc");
  const SimulatedSession& r = scene.flight.recording;
  const Intrinsics& lens = r.truth.cameras[0].intrinsics;
  RenderOptions noisy = sharp();
  noisy.noise_sigma = 3;
  const Transform T_FC = r.cameraPose(0, r.frame_stamps[100]);
  const GrayImage exact = RoomRenderer(lens, scene.texture, sharp()).render({T_FC}, 0);
  const RoomRenderer renderer(lens, scene.texture, noisy);
  const GrayImage a = renderer.render({T_FC}, 7), again = renderer.render({T_FC}, 7);
  const std::size_t pixels =
      static_cast<std::size_t>(a.width()) * static_cast<std::size_t>(a.height());
  EXPECT_TRUE(std::equal(a.data(), a.data() + pixels, again.data()));
  double squares = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double d = static_cast<double>(a.data()[i]) - exact.data()[i];
    squares += d * d;
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(pixels)), 3, 0.1);
}

}  // namespace
}  // namespace plumbline

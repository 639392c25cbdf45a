// SPDX-License-Identifier: BSD-3-Clause
// What the 3D scene begins with.
#include "report/html/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/report/synthetic_record.h"

namespace plumbline::html_internal {
namespace {

// A picture of 900 x 520, 30 degrees high, as the viewer's; nothing is cut, and it is used.
TEST(Scene, ShowsAllThatIsDrawnFromItsFirstEye) {
  const Scene scene = buildScene(test::syntheticRecord());
  const Eigen::Vector3d ahead = (scene.focus - scene.eye).normalized();
  const Eigen::Vector3d right = ahead.cross(scene.up).normalized();
  const Eigen::Vector3d top = right.cross(ahead);
  const double high = std::tan(15 * std::numbers::pi / 180), wide = high * 900 / 520;
  double farthest = 0;  // of half the picture
  for (const SceneObject& object : scene.objects) {
    for (const Eigen::Vector3d& point : object.points) {
      const Eigen::Vector3d q = point - scene.eye;
      const double depth = q.dot(ahead);
      ASSERT_GT(depth, 0) << object.layer;
      farthest = std::max({farthest, std::abs(q.dot(top)) / (high * depth),
                           std::abs(q.dot(right)) / (wide * depth)});
    }
  }
  EXPECT_LT(farthest, 1);
  EXPECT_GT(farthest, 0.9);
}

}  // namespace
}  // namespace plumbline::html_internal

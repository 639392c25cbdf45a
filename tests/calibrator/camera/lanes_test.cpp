// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/camera/lanes.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/camera/camera_dispatch.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

template <int W>
void expectFunctionsPerLane() {
  for (double a = 1e-12; a < 1e6; a *= 1.07) {
    Lanes<W> lanes;
    for (int i = 0; i < W; ++i) lanes[i] = a * (1 + 0.37 * i);
    const Lanes<W> root = squareRoot(lanes);
    const Lanes<W> angle = arcTangent(lanes);
    for (int i = 0; i < W; ++i) {
      EXPECT_EQ(root[i], std::sqrt(lanes[i]));
      EXPECT_NEAR(angle[i], std::atan(lanes[i]), 2 * kEpsilon * std::atan(lanes[i])) << lanes[i];
    }
  }
}

TEST(Lanes, SquareRootAndArcTangentEqualTheLibrarysInEveryLane) {
  expectFunctionsPerLane<2>();
  expectFunctionsPerLane<4>();
}

TEST(Lanes, ArcTangentMeetsItsEnds) {
  const Lanes<4> a = {0, 1, std::numeric_limits<double>::max(), 0.66};
  const Lanes<4> angle = arcTangent(a);
  EXPECT_EQ(angle[0], 0);
  EXPECT_NEAR(angle[1], std::atan(1.0), kEpsilon);
  EXPECT_NEAR(angle[2], std::acos(0.0), kEpsilon);
  EXPECT_NEAR(angle[3], std::atan(0.66), kEpsilon);
}

TEST(Lanes, ModelsGiveTheSameInLanesAsInScalars) {
  const double x[4] = {0, 1e-6, 0.4, -1.3};
  const double y[4] = {0, -2e-6, -0.1, 0.8};
  for (const Intrinsics& camera : test::everyModel()) {
    std::visit(
        [&]<class Model>(Model) {
          const CameraValues values(camera);
          const double* k = values.k.data();
          const Lanes<4> X = {x[0], x[1], x[2], x[3]};
          const Lanes<4> Y = {y[0], y[1], y[2], y[3]};
          const Lanes<4> Z = {1, 1, 1.2, 1.5};
          const auto lanes = Model::image(k, X, Y, Z);
          for (int i = 0; i < 4; ++i) {
            const auto one = Model::image(k, x[i], y[i], double(Z[i]));
            EXPECT_NEAR(lanes.x[i], one.x, 4 * kEpsilon);
            EXPECT_NEAR(lanes.y[i], one.y, 4 * kEpsilon);
            EXPECT_NEAR(lanes.J_point[0][1][i], one.J_point[0][1], 16 * kEpsilon);
            EXPECT_NEAR(lanes.J_point[1][2][i], one.J_point[1][2], 16 * kEpsilon);
            for (int j = 0; j < Model::kShape; ++j) {
              EXPECT_NEAR(lanes.J_k[1][j][i], one.J_k[1][j], 16 * kEpsilon);
            }
          }
        },
        cameraModelOf(camera));
  }
}

}  // namespace
}  // namespace plumbline

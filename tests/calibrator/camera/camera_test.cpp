// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/camera/camera.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/camera/equidistant.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Intrinsics simpleCamera(DistortionModel model, const Eigen::Vector4d& distortion) {
  Intrinsics camera;
  camera.distortion_model = model;
  camera.projection = Eigen::Vector4d(100, 200, 10, 20);
  camera.distortion = distortion;
  return camera;
}

void expectPixel(const std::optional<Eigen::Vector2d>& uv, double u, double v) {
  ASSERT_TRUE(uv.has_value());
  EXPECT_NEAR(uv->x(), u, 1e-12 * std::abs(u));
  EXPECT_NEAR(uv->y(), v, 1e-12 * std::abs(v));
}

TEST(Project, RadtanByHand) {
  // x = 0.5, y = -1, r^2 = 1.25: g = 1 + 0.1 * 1.25 + 0.02 * 1.5625 = 1.15625;
  // x' = 0.5 g + 2 * 0.01 * (-0.5) + 0.03 * (1.25 + 0.5) = 0.620625
  // y' = -g + 0.01 * (1.25 + 2) + 2 * 0.03 * (-0.5) = -1.15375.
  const Intrinsics camera = simpleCamera(DistortionModel::kRadtan, {0.1, 0.02, 0.01, 0.03});
  expectPixel(project(camera, {1, -2, 2}), 100 * 0.620625 + 10, 200 * -1.15375 + 20);
}

TEST(Project, EquidistantByHand) {
  // On the 45 degree cone theta = pi/4 and the direction (3, 4) / 5.
  const double theta = std::numbers::pi / 4;
  const double theta_d = theta * (1 + 0.1 * std::pow(theta, 2) + 0.02 * std::pow(theta, 4) +
                                  0.003 * std::pow(theta, 6) + 0.0004 * std::pow(theta, 8));
  const Intrinsics camera = simpleCamera(DistortionModel::kEquidistant, {0.1, 0.02, 0.003, 0.0004});
  expectPixel(project(camera, {3, 4, 5}), 100 * 0.6 * theta_d + 10, 200 * 0.8 * theta_d + 20);
}

TEST(Project, WithoutDistortionAPinholeIsAPinhole) {
  const Intrinsics camera = simpleCamera(DistortionModel::kRadtan, Eigen::Vector4d::Zero());
  expectPixel(project(camera, {1, 2, 4}), 100 * 0.25 + 10, 200 * 0.5 + 20);
}

// A small angle off the axis, over that angle: the scale of the image, whatever the model's fu is.
TEST(Project, PixelsPerRadianAreTheSlopeOnTheAxis) {
  const double angle = 1e-4;
  for (const Intrinsics& camera : test::everyModel()) {
    const auto aside = project(camera, {std::sin(angle), 0, std::cos(angle)});
    const auto other = project(camera, {-std::sin(angle), 0, std::cos(angle)});
    ASSERT_TRUE(aside && other);
    const double slope = (aside->x() - other->x()) / (2 * angle);
    EXPECT_NEAR(pixelsPerRadian(camera), slope, 1e-6 * slope);
  }
  Intrinsics sphere;  // fu / (1 + xi)
  sphere.projection_model = ProjectionModel::kDs;
  sphere.distortion_model = DistortionModel::kNone;
  sphere.projection.resize(6);
  sphere.projection << -0.2, 0.6, 400, 400, 320, 240;
  sphere.distortion.resize(0);
  EXPECT_DOUBLE_EQ(pixelsPerRadian(sphere), 400 / 0.8);
}

TEST(Project, TheAxisMeetsThePrincipalPoint) {
  for (const Intrinsics& camera : test::everyModel()) {
    const Eigen::Vector4d lens = camera.projection.tail<4>();
    expectPixel(project(camera, {0, 0, 2}), lens[2], lens[3]);
    const Projection projection = projectWithJacobians(camera, {0, 0, 2}).value();
    // On the axis the picture is a pinhole's, of focal lengths in the same ratio.
    EXPECT_NEAR(projection.J_point(0, 0) / lens[0], projection.J_point(1, 1) / lens[1], 1e-12);
    EXPECT_TRUE(projection.J_point.col(2).isZero(0));
    EXPECT_TRUE(projection.J_intrinsics.allFinite());
    EXPECT_EQ(projection.J_intrinsics.cols(), camera.stacked().size());
  }
}

TEST(Project, EmptyBehindTheCameraAndForNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Intrinsics& camera : test::allCameras()) {
    EXPECT_FALSE(project(camera, {0.1, 0.1, -1}).has_value());
    EXPECT_FALSE(project(camera, {0.1, 0.1, 0}).has_value());
    EXPECT_FALSE(project(camera, {nan, 0.1, 1}).has_value());
    EXPECT_FALSE(projectWithJacobians(camera, {0.1, 0.1, -1}).has_value());
  }
  for (const Intrinsics& camera : test::everyModel()) {
    EXPECT_FALSE(project(camera, {0.1, 0.1, -10}).has_value());
    EXPECT_FALSE(project(camera, {nan, 0.1, 1}).has_value());
    EXPECT_FALSE(project(camera, {0, 0, 0}).has_value());
  }
}

// The largest angle to the axis that projects, on a circle about it [rad].
double widestAngle(const Intrinsics& camera) {
  double low = 0;
  double high = std::numbers::pi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const Eigen::Vector3d p(0.6 * std::sin(middle), -0.8 * std::sin(middle), std::cos(middle));
    (project(camera, p) ? low : high) = middle;
  }
  return low;
}

TEST(Project, WideModelsEndWhereTheirImageStopsGrowing) {
  using P = ProjectionModel;
  const auto wide = [](P projection, std::initializer_list<double> values) {
    return test::cameraOf(projection, DistortionModel::kNone, values, {});
  };
  // Omni: cos = -xi, and -1/xi above 1. EUCM, beta 1: cos = -w. DS, xi 0: the same.
  EXPECT_NEAR(widestAngle(wide(P::kOmni, {0.6, 100, 100, 0, 0})), std::acos(-0.6), 1e-9);
  EXPECT_NEAR(widestAngle(wide(P::kOmni, {1.25, 100, 100, 0, 0})), std::acos(-0.8), 1e-9);
  EXPECT_NEAR(widestAngle(wide(P::kEucm, {0.25, 1, 100, 100, 0, 0})), std::acos(-1.0 / 3), 1e-9);
  EXPECT_NEAR(widestAngle(wide(P::kEucm, {0.75, 1, 100, 100, 0, 0})), std::acos(-1.0 / 3), 1e-9);
  EXPECT_NEAR(widestAngle(wide(P::kDs, {0, 0.75, 100, 100, 0, 0})), std::acos(-1.0 / 3), 1e-9);
  EXPECT_NEAR(widestAngle(wide(P::kDs, {-0.2, 0, 100, 100, 0, 0})), std::acos(0.2), 1e-9);
  EXPECT_NEAR(widestAngle(wide(P::kDs, {0.2, 0, 100, 100, 0, 0})), std::acos(-0.2), 1e-9);
  // Within those limits the radius grows, up to the limit.
  for (const Intrinsics& camera : test::everyModel()) {
    double last = -1;
    const double end = widestAngle(camera);
    ASSERT_GT(end, 0.9);
    for (double angle = 0; angle < 0.999 * end; angle += 0.002) {
      const auto uv = project(camera, {std::sin(angle), 0, std::cos(angle)});
      ASSERT_TRUE(uv.has_value()) << angle;
      const double radius = uv->x() - camera.projection[camera.projection.size() - 2];
      EXPECT_GT(radius, last) << camera.projection.transpose() << " at " << angle;
      last = radius;
    }
  }
}

TEST(Project, WideModelsContainThePinhole) {
  const Eigen::Vector3d p(0.3, -0.2, 0.9);
  const auto pinhole = project(test::cameraOf(ProjectionModel::kPinhole, DistortionModel::kNone,
                                              {100, 200, 10, 20}, {}),
                               p)
                           .value();
  const auto same = [&](const Intrinsics& camera) {
    return (project(camera, p).value() - pinhole).norm() < 1e-12;
  };
  const auto none = DistortionModel::kNone;
  EXPECT_TRUE(same(test::cameraOf(ProjectionModel::kOmni, none, {0, 100, 200, 10, 20}, {})));
  EXPECT_TRUE(same(test::cameraOf(ProjectionModel::kEucm, none, {0, 3, 100, 200, 10, 20}, {})));
  EXPECT_TRUE(same(test::cameraOf(ProjectionModel::kDs, none, {0, 0, 100, 200, 10, 20}, {})));
  EXPECT_TRUE(same(
      test::cameraOf(ProjectionModel::kPinhole, DistortionModel::kFov, {100, 200, 10, 20}, {0})));
  // EUCM with beta = 1 and DS with xi = 0 are the unified model: xi = alpha / (1 - alpha), the
  // focal lengths over 1 - alpha.
  const auto unified = test::cameraOf(ProjectionModel::kOmni, none, {1.5, 250, 500, 10, 20}, {});
  const Eigen::Vector2d uv = project(unified, p).value();
  for (const auto& camera :
       {test::cameraOf(ProjectionModel::kEucm, none, {0.6, 1, 100, 200, 10, 20}, {}),
        test::cameraOf(ProjectionModel::kDs, none, {0, 0.6, 100, 200, 10, 20}, {})}) {
    EXPECT_LT((project(camera, p).value() - uv).norm(), 1e-12);
  }
}

TEST(Project, RadtanEndsWhereTheRadiusStopsGrowing) {
  // k1 = -1/3 alone: d(r - r^3 / 3)/dr = 1 - r^2 is zero at r = 1.
  const Intrinsics camera = simpleCamera(DistortionModel::kRadtan, {-1.0 / 3, 0, 0, 0});
  EXPECT_TRUE(project(camera, {0.999999, 0, 1}).has_value());
  EXPECT_FALSE(project(camera, {1.000001, 0, 1}).has_value());
  EXPECT_FALSE(project(camera, {3, 0, 1}).has_value());
  // With k2 the radius may grow again further out: that is still beyond the fold.
  const Intrinsics folded = simpleCamera(DistortionModel::kRadtan, {-1, 0.25, 0, 0});
  EXPECT_TRUE(project(folded, {0.5, 0, 1}).has_value());
  EXPECT_FALSE(project(folded, {5, 0, 1}).has_value());
  // Pincushion grows for ever.
  const Intrinsics pincushion = simpleCamera(DistortionModel::kRadtan, {0.1, 0.01, 0, 0});
  EXPECT_TRUE(project(pincushion, {50, 0, 1}).has_value());
}

TEST(Project, EquidistantEndsWhereTheAngleStopsGrowing) {
  // k1 = -1/3 alone: 1 - theta^2 is zero at theta = 1 rad.
  const Intrinsics camera = simpleCamera(DistortionModel::kEquidistant, {-1.0 / 3, 0, 0, 0});
  EXPECT_TRUE(project(camera, {std::tan(0.999999), 0, 1}).has_value());
  EXPECT_FALSE(project(camera, {std::tan(1.000001), 0, 1}).has_value());
  // Without a fold it reaches to the side, though never behind.
  EXPECT_TRUE(project(test::equidistantCamera(), {100, 0, 1}).has_value());
}

bool isBeyondNinetyDegrees(const Intrinsics& camera, double u, double v) {
  return camera.projection_model == ProjectionModel::kPinhole &&
         camera.distortion_model == DistortionModel::kEquidistant &&
         (Eigen::Vector2d(u, v) - camera.projection.tail<2>()).norm() > 295;
}

TEST(Equidistant, TheBoundThatSparesTheSearchNeverReachesBeyondTheFold) {
  std::mt19937_64 engine(5);
  const auto uniform = [&] { return 2 * (static_cast<double>(engine() >> 11) * 0x1p-53) - 1; };
  int spared = 0;
  int folded = 0;
  for (int i = 0; i < 20000; ++i) {
    const double k[4] = {0.5 * uniform(), 0.3 * uniform(), 0.2 * uniform(), 0.1 * uniform()};
    const double r = 2 + 2 * uniform();
    const bool below = r * r < Equidistant::squaredRadiusLimit(k);
    EXPECT_EQ(isBelowLimit<Equidistant>(k, r * r), below);
    spared += Equidistant::surelyGrows(k, r * r) ? 1 : 0;
    folded += below ? 0 : 1;
  }
  EXPECT_GT(spared, 5000);
  EXPECT_GT(folded, 5000);
}

TEST(Project, ManyPointsAreProjectedAsEachAlone) {
  std::vector<Eigen::Vector3d> points = {{0, 0, -1}, {0, 0, 0}};  // behind every camera, and at it
  for (int i = 0; i < 60; ++i) points.emplace_back(0.05 * i - 1.5, std::sin(i), 1.2);
  for (const Intrinsics& camera : test::everyModel()) {
    const auto uv = project(camera, points);
    ASSERT_EQ(uv.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(uv[i], project(camera, points[i]));
  }
}

TEST(Unproject, InvertsProjectOverTheImageForEveryModel) {
  for (const Intrinsics& camera : test::everyModel()) {
    const double focal = camera.projection[camera.projection.size() - 4];
    for (int u = 0; u < camera.resolution.width; u += 37) {
      for (int v = 0; v < camera.resolution.height; v += 29) {
        // TUM-VI's corners lie beyond 90 degrees, 296 px from the centre.
        if (isBeyondNinetyDegrees(camera, u, v)) continue;
        const auto ray = unproject(camera, Eigen::Vector2d(u, v));
        ASSERT_TRUE(ray.has_value()) << u << ", " << v << " " << camera.projection.transpose();
        EXPECT_NEAR(ray->norm(), 1, 1e-15);
        const auto uv = project(camera, 3.7 * *ray);
        ASSERT_TRUE(uv.has_value());
        EXPECT_LT((*uv - Eigen::Vector2d(u, v)).norm(), 1e-12 * focal);
      }
    }
  }
}

TEST(Unproject, RecoversTheRayUpToTheEdgeOfTheDomain) {
  const Intrinsics radtan = simpleCamera(DistortionModel::kRadtan, {-1.0 / 3, 0, 0, 0});
  const Intrinsics equidistant = simpleCamera(DistortionModel::kEquidistant, {-1.0 / 3, 0, 0, 0});
  for (const Intrinsics& camera : {radtan, equidistant}) {
    for (double x : {0.0, 1e-9, 1e-5, 0.3, 0.9, 0.99}) {
      const Eigen::Vector3d ray = Eigen::Vector3d(0.6 * x, -0.8 * x, 1).normalized();
      const auto back = unproject(camera, project(camera, ray).value());
      ASSERT_TRUE(back.has_value()) << x;
      EXPECT_LT((*back - ray).norm(), 1e-12) << x;  // 1 / slope is 50 at 0.99
    }
    // The largest distorted radius is 2/3: no ray has this pixel.
    EXPECT_FALSE(unproject(camera, Eigen::Vector2d(100 * 0.7 + 10, 20)).has_value());
    EXPECT_FALSE(unproject(camera, Eigen::Vector2d(1e9, 0)).has_value());
    EXPECT_FALSE(
        unproject(camera, Eigen::Vector2d(std::numeric_limits<double>::infinity(), 0)).has_value());
  }
}

TEST(Unproject, EmptyBeyondNinetyDegrees) {
  EXPECT_FALSE(unproject(test::equidistantCamera(), {0, 0}).has_value());
}

TEST(Models, RefusalNamesWhatIsSupported) {
  Intrinsics camera = test::doubleSphereCamera();
  camera.distortion_model = DistortionModel::kRadtan;
  try {
    (void)project(camera, {0, 0, 1});
    FAIL() << "a double sphere with radtan was projected";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("ds-radtan"), HasSubstr("pinhole-radtan"),
                                    HasSubstr("omni-radtan"), HasSubstr("recalibrate")));
  }
  camera.distortion_model = DistortionModel::kFov;
  EXPECT_THROW((void)projectWithJacobians(camera, {0, 0, 1}), InputError);
  EXPECT_THROW((void)unproject(camera, {0, 0}), InputError);
}

TEST(Models, AllButTheOddPairsOfOmniAreCalibrated) {
  int calibrated = 0;
  for (const Intrinsics& camera : test::everyModel()) {
    calibrated += canBeCalibrated(camera.projection_model, camera.distortion_model) ? 1 : 0;
  }
  EXPECT_EQ(calibrated, 9);
  EXPECT_TRUE(canBeCalibrated(ProjectionModel::kPinhole, DistortionModel::kRadtan));
  EXPECT_TRUE(canBeCalibrated(ProjectionModel::kPinhole, DistortionModel::kEquidistant));
  EXPECT_FALSE(canBeCalibrated(ProjectionModel::kOmni, DistortionModel::kFov));
  EXPECT_FALSE(canBeCalibrated(ProjectionModel::kDs, DistortionModel::kRadtan));
}

TEST(Models, RefuseAWrongNumberOfParameters) {
  Intrinsics camera = test::radtanCamera();
  camera.distortion = Eigen::Vector2d(0.1, 0.2);
  try {
    (void)project(camera, {0, 0, 1});
    FAIL() << "two coefficients were accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("4 distortion"), HasSubstr("2")));
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/projection_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "evaluate/compare/compare_calibrations.h"

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Intrinsics radtan() {
  Intrinsics k;
  k.resolution = {752, 480};
  k.projection = Eigen::Vector4d(458.7, 457.3, 367.2, 248.4);
  k.distortion = Eigen::Vector4d(-0.283, 0.074, 2e-4, 2e-5);
  return k;
}

Intrinsics equidistant() {
  Intrinsics k = radtan();
  k.distortion_model = DistortionModel::kEquidistant;
  k.distortion = Eigen::Vector4d(-0.01, 0.02, -0.01, 0.003);
  return k;
}

double largest(const ProjectionDifference& difference) {
  double most = 0;
  for (const Eigen::Vector2d& v : difference.vectors) most = std::max(most, v.norm());
  return most;
}

TEST(ProjectionDifference, ZeroForIdenticalModels) {
  for (const Intrinsics& k : {radtan(), equidistant()}) {
    for (const double range : {1.0, kInfinity}) {
      for (const DifferenceFit fit : {DifferenceFit::kSquares, DifferenceFit::kFourthPower}) {
        DifferenceOptions options;
        options.range_m = range;
        options.fit = fit;
        const auto d = projectionDifference(k, k, options);
        ASSERT_TRUE(d);
        EXPECT_LT(largest(*d), 1e-8);
        EXPECT_LT(rotationAngle(d->T_BA.R), 1e-11);
        EXPECT_LT(d->T_BA.t.norm(), 1e-11);
      }
    }
  }
}

// A camera that is turned by half a turn about its axis sees (-x, -y) where it saw (x, y): negative
// focal lengths say so exactly, radial distortion included.
TEST(ProjectionDifference, AKnownRotationIsImpliedAndLeavesNothing) {
  Intrinsics A = radtan();
  A.distortion.tail<2>().setZero();
  Intrinsics B = A;
  B.projection.head<2>() *= -1;
  const Eigen::Matrix3d half_turn = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  for (const double range : {1.0, kInfinity}) {
    DifferenceOptions options;
    options.range_m = range;
    const auto d = projectionDifference(A, B, options);
    ASSERT_TRUE(d);
    EXPECT_TRUE(d->T_BA.R.isApprox(half_turn, 1e-11)) << d->T_BA.R;
    EXPECT_LT(d->T_BA.t.norm(), 1e-11);
    EXPECT_LT(largest(*d), 1e-8);
  }
}

// In a narrow image a shift of the principal point is a rotation but for terms of second order.
TEST(ProjectionDifference, AShiftOfThePrincipalPointIsARotation) {
  Intrinsics A;
  A.resolution = {201, 201};
  A.projection = Eigen::Vector4d(20000, 20000, 100, 100);
  A.distortion = Eigen::Vector4d::Zero();
  Intrinsics B = A;
  B.projection[2] += 7;  // sees the same direction 7 px further right
  DifferenceOptions options;
  options.focus_radius_px = 1000;
  const auto d = projectionDifference(A, B, options);
  ASSERT_TRUE(d);
  // B's frame is turned so that directions lie 7 px further left in it: -7 / f about y.
  EXPECT_NEAR(logSO3(d->T_BA.R).y(), -7.0 / 20000, 1e-8);
  EXPECT_NEAR(logSO3(d->T_BA.R).x(), 0, 1e-8);
  EXPECT_LT(largest(*d), 3e-4);  // 7 px x (100 / 20000)^2 remain
}

// u - pu = f x: a larger focal length moves a pixel outwards by its distance to the centre times
// df / f, which no rotation takes away and, at a finite range, a step along the axis does to first
// order only where all points have one depth; here they lie on a sphere.
TEST(ProjectionDifference, HandValueOfAFocalLength) {
  Intrinsics A;
  A.resolution = {401, 301};
  A.projection = Eigen::Vector4d(2000, 2000, 200, 150);
  A.distortion = Eigen::Vector4d::Zero();
  Intrinsics B = A;
  B.projection.head<2>() *= 1.01;
  const auto d = projectionDifference(A, B);
  ASSERT_TRUE(d);
  EXPECT_LT(rotationAngle(d->T_BA.R), 1e-12);  // by symmetry
  EXPECT_NEAR(d->vectors.front().x(), -2.0, 1e-9);
  EXPECT_NEAR(d->vectors.front().y(), -1.5, 1e-9);
  EXPECT_NEAR(d->vectors.back().x(), 2.0, 1e-9);
  DifferenceOptions near;
  near.range_m = 4;
  near.focus_radius_px = 1000;
  const auto step = projectionDifference(A, B, near);
  ASSERT_TRUE(step);
  // x f (1 + 1 %) / (z + tz) = x f / z at z = 4 m.
  EXPECT_NEAR(step->T_BA.t.z(), 0.04, 4e-4);
  EXPECT_LT(largest(*step), 0.02);
}

// The vectors are taken at the same pixel of A and of B, which see directions a difference apart:
// their sum is of second order, so that half the change leaves a quarter of it.
TEST(ProjectionDifference, ImpliedRotationsAreInverseAndVectorsChangeSign) {
  const Intrinsics A = radtan();
  const auto asymmetry = [&A](double share) {
    Intrinsics B = A;
    B.projection += share * Eigen::Vector4d(0.4, 0.5, -1.1, 0.7);
    B.distortion += share * Eigen::Vector4d(1e-4, -2e-4, 3e-5, -2e-5);
    const auto forth = projectionDifference(A, B);
    const auto back = projectionDifference(B, A);
    EXPECT_TRUE((forth->T_BA.R * back->T_BA.R).isIdentity(1e-14));
    EXPECT_GT(largest(*forth), 0.3 * share);
    double most = 0;
    for (std::size_t i = 0; i < forth->vectors.size(); ++i) {
      most = std::max(most, (forth->vectors[i] + back->vectors[i]).norm());
    }
    return most;
  };
  const double whole = asymmetry(1);
  EXPECT_LT(whole, 0.05);
  EXPECT_NEAR(whole / asymmetry(0.5), 4, 0.2);
}

TEST(ProjectionDifference, ModelsOfDifferentKindsCompare) {
  const auto d = projectionDifference(radtan(), equidistant());
  ASSERT_TRUE(d);
  EXPECT_TRUE(std::isfinite(largest(*d)));
  EXPECT_GT(largest(*d), 0.01);
}

// The fourth power minimises another sum: each fit is the better one by its own measure.
TEST(ProjectionDifference, EachFitMinimisesItsOwnSum) {
  const Intrinsics A = radtan();
  Intrinsics B = A;
  B.projection += Eigen::Vector4d(2, -1, 3, 1);
  B.distortion += Eigen::Vector4d(5e-3, -4e-3, 2e-4, 3e-4);
  const auto sums = [&](DifferenceFit fit, double range) {
    DifferenceOptions options;
    options.fit = fit;
    options.range_m = range;
    options.focus_radius_px = 1000;
    const auto d = projectionDifference(A, B, options);
    const double scale = std::isfinite(range) ? range : 1;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int i = 0; i < options.grid.size(); ++i) {
      const Eigen::Vector2d q = options.grid.pixel(A.resolution, i);
      const Eigen::Vector3d ray = (d->T_BA * (scale * *unproject(A, q))).normalized();
      const double s = (ray - *unproject(B, q)).squaredNorm();
      sum += Eigen::Vector2d(s, s * s);
    }
    return sum;
  };
  for (const double range : {1.0, kInfinity}) {
    const Eigen::Vector2d squares = sums(DifferenceFit::kSquares, range);
    const Eigen::Vector2d fourth = sums(DifferenceFit::kFourthPower, range);
    EXPECT_LT(squares[0], 0.999 * fourth[0]);
    EXPECT_LT(fourth[1], 0.999 * squares[1]);
  }
}

TEST(ProjectionDifference, WeightsAndFocusChooseWhatIsFitted) {
  const Intrinsics A = radtan();
  DifferenceOptions options;
  const auto focused = projectionDifference(A, A, options);
  options.weights.assign(static_cast<std::size_t>(options.grid.size()), 2.0);
  options.weights[0] = std::nan("");
  options.weights[1] = 0;
  const auto weighted = projectionDifference(A, A, options);
  ASSERT_TRUE(focused && weighted);
  EXPECT_EQ(weighted->fitted, options.grid.size() - 2);
  EXPECT_LT(focused->fitted, options.grid.size() / 4);
  options.focus_radius_px = 1;
  EXPECT_FALSE(projectionDifference(A, A, options));
}

// mrcal's focus is a sixth of the image's smaller side, about its middle, here (375.5, 239.5).
TEST(ProjectionDifference, TheFocusIsASixthOfTheSmallerSide) {
  DifferenceOptions options;
  options.grid = {752, 480};  // a point for each pixel
  const double area = M_PI * 80 * 80;
  EXPECT_NEAR(pointsInFocus({752, 480}, options), area, 0.01 * area);
  EXPECT_NEAR(pointsInFocus({480, 752}, options), area, 0.2 * area);
}

// With weights each fit minimises sum w s, or sum w^2 s^2: better than where all weigh alike.
TEST(ProjectionDifference, EachFitMinimisesItsWeightedSum) {
  const Intrinsics A = radtan();
  Intrinsics B = A;
  B.projection += Eigen::Vector4d(2, -1, 3, 1);
  B.distortion += Eigen::Vector4d(5e-3, -4e-3, 2e-4, 3e-4);
  const DifferenceOptions grid;
  const auto weightOf = [&](int i) {
    return grid.grid.pixel(A.resolution, i).x() > 500 ? 50.0 : 1.0;
  };
  const auto sumOf = [&](DifferenceFit fit, double range, bool weighted) {
    DifferenceOptions options;
    options.fit = fit;
    options.range_m = range;
    for (int i = 0; i < grid.grid.size(); ++i) {
      options.weights.push_back(weighted ? weightOf(i) : 1);
    }
    const auto d = projectionDifference(A, B, options);
    double sum = 0;
    for (int i = 0; i < grid.grid.size(); ++i) {
      const Eigen::Vector2d q = grid.grid.pixel(A.resolution, i);
      const double scale = std::isfinite(range) ? range : 1;
      const Eigen::Vector3d ray = (d->T_BA * (scale * *unproject(A, q))).normalized();
      const double ws = weightOf(i) * (ray - *unproject(B, q)).squaredNorm();
      sum += fit == DifferenceFit::kSquares ? ws : ws * ws;
    }
    return sum;
  };
  for (const DifferenceFit fit : {DifferenceFit::kSquares, DifferenceFit::kFourthPower}) {
    for (const double range : {1.0, 4.0, kInfinity}) {
      EXPECT_LT(sumOf(fit, range, true), 0.9 * sumOf(fit, range, false)) << range;
    }
  }
}

TEST(ProjectionDifference, ImagesOfDifferentSizesAreRefused) {
  Intrinsics B = radtan();
  B.resolution = {640, 480};
  EXPECT_THROW(projectionDifference(radtan(), B), InputError);
}

TEST(UncertaintyMap, WeightsAreThoseOfMrcal) {
  EXPECT_EQ(differenceWeights({0.5, 2}, {2, 0.1}), (std::vector<double>{1, 25}));
}

}  // namespace
}  // namespace plumbline

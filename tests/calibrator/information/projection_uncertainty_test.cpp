// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/projection_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "tests/calibrator/information/random_information.h"

namespace plumbline {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

Intrinsics camera(double focal, int width, int height) {
  Intrinsics k;
  k.resolution = {width, height};
  k.projection = Eigen::Vector4d(focal, focal, 0.5 * (width - 1), 0.5 * (height - 1));
  k.distortion = Eigen::Vector4d::Zero();
  return k;
}

ProjectionCovariance only(int row, double std) {
  ProjectionCovariance covariance = ProjectionCovariance::Zero(14, 14);
  covariance(row, row) = std * std;
  return covariance;
}

TEST(ProjectionUncertainty, HandValuesOfSingleParameters) {
  const Intrinsics k = camera(400, 801, 601);
  const Eigen::Vector2d centre(400, 300), right(800, 300);
  const auto std_u = [&k](const ProjectionCovariance& c, const Eigen::Vector2d& uv, double range) {
    return std::sqrt((*pixelCovariance(k, c, uv, range))(0, 0));
  };
  // The principal point moves every pixel alike, at any range.
  EXPECT_NEAR(std_u(only(8, 0.5), centre, 1), 0.5, 1e-12);
  EXPECT_NEAR(std_u(only(8, 0.5), right, kUnbounded), 0.5, 1e-12);
  // The focal length moves u by df x / z: by 400 / 400 df at the right border.
  EXPECT_NEAR(std_u(only(6, 0.5), centre, 1), 0, 1e-12);
  EXPECT_NEAR(std_u(only(6, 0.5), right, 3), 0.5, 1e-12);
  // A sideways shift of 1 mm at 2 m: f / z x 1 mm; nothing at infinity. On the border z is smaller.
  EXPECT_NEAR(std_u(only(0, 1e-3), centre, 2), 400 / 2.0 * 1e-3, 1e-12);
  EXPECT_NEAR(std_u(only(0, 1e-3), right, 2), 400 / std::sqrt(2.0) * 1e-3, 1e-12);
  EXPECT_EQ(std_u(only(0, 1e-3), centre, kUnbounded), 0);
  // A turn about y by 1 mrad: f (1 + x^2/z^2) 1 mrad, whatever the range.
  EXPECT_NEAR(std_u(only(4, 1e-3), centre, 2), 0.4, 1e-12);
  EXPECT_NEAR(std_u(only(4, 1e-3), right, 2), 0.8, 1e-12);
  EXPECT_NEAR(std_u(only(4, 1e-3), right, kUnbounded), 0.8, 1e-12);
}

TEST(ProjectionUncertainty, WorstDirectionIsTheLargerEigenvalue) {
  Eigen::Matrix2d C;
  C << 4, 1.5, 1.5, 2;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(C);
  EXPECT_NEAR(worstDirectionStd(C), std::sqrt(eigen.eigenvalues()[1]), 1e-14);
  EXPECT_EQ(worstDirectionStd(Eigen::Vector2d(1, 9).asDiagonal()), 3);
}

TEST(ProjectionUncertainty, NothingWhereThePixelHasNoRay) {
  Intrinsics k = camera(400, 801, 601);
  k.distortion << -0.5, 0, 0, 0;  // folds back at r = 0.82, where m = 0.54: beyond u = 618
  EXPECT_FALSE(pixelCovariance(k, only(8, 1), {790, 590}, 1).has_value());
  EXPECT_TRUE(pixelCovariance(k, only(8, 1), {500, 300}, 1).has_value());
}

TEST(ImpliedShift, BothMethodsAgreeWhereAllFramesAreAlike) {
  const Matrix6d H = test::randomInformation(6, 40, 1);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Random(6, 5);
  Eigen::MatrixXd P(18, 5);
  P << one, one, one;
  const std::vector<Matrix6d> all{H, H, H};
  const auto mean = impliedShift(all, P, FrameAlignment::kMeanFrames);
  const auto cross = impliedShift(all, P, FrameAlignment::kCrossReprojection);
  ASSERT_TRUE(mean && cross);
  EXPECT_TRUE(mean->A.isApprox(cross->A, 1e-9));
  EXPECT_TRUE(mean->noise.isApprox(cross->noise, 1e-9));
  EXPECT_TRUE((H * mean->A).isApprox(-one, 1e-9));
  EXPECT_TRUE((3 * H * mean->noise).isApprox(Matrix6d::Identity(), 1e-9));
}

TEST(ImpliedShift, AWeakFrameCountsInTheMeanOnly) {
  std::vector<Matrix6d> H{Matrix6d::Identity(), 1e-6 * Matrix6d::Identity()};
  const Eigen::MatrixXd P = Eigen::MatrixXd::Zero(12, 1);
  EXPECT_NEAR(impliedShift(H, P, FrameAlignment::kMeanFrames)->noise(0, 0), (1 + 1e6) / 4, 1e-6);
  EXPECT_NEAR(impliedShift(H, P, FrameAlignment::kCrossReprojection)->noise(0, 0), 1 / (1 + 1e-6),
              1e-12);
  H[1].setZero();  // no pose at all: left out
  EXPECT_NEAR(impliedShift(H, P, FrameAlignment::kMeanFrames)->noise(0, 0), 1, 1e-12);
  H[0].setZero();
  EXPECT_FALSE(impliedShift(H, P, FrameAlignment::kMeanFrames).has_value());
  EXPECT_FALSE(impliedShift(H, P, FrameAlignment::kCrossReprojection).has_value());
}

// In a narrow image a shift of the principal point is a rotation: next to nothing remains of it.
TEST(ImageFit, TakesOutWhatARotationExplains) {
  const Intrinsics narrow = camera(20000, 201, 201);
  Eigen::MatrixXd Sigma = Eigen::MatrixXd::Zero(8, 8);
  Sigma(2, 2) = 25;  // pu: 5 px
  const ProjectionCovariance fitted = imageFitCovariance(narrow, Sigma);
  for (const double u : {0.0, 100.0, 200.0}) {
    // The rest is quadratic: 5 px x (100 / 20000)^2 at the border.
    EXPECT_LT(std::sqrt((*pixelCovariance(narrow, fitted, {u, 0}, kUnbounded)).trace()), 2e-4);
  }
  EXPECT_NEAR(std::sqrt(fitted(4, 4)), 5.0 / 20000, 1e-8);  // [rad] about y
  EXPECT_EQ(fitted(0, 0), 0);                               // no translation at infinity
}

// In one pass what the covariance of every pixel gives.
TEST(ImageFit, MeanSquareIsTheMeanOverTheGrid) {
  const Intrinsics seen = camera(500, 752, 480);
  Eigen::MatrixXd A(8, 8);
  for (int i = 0; i < 64; ++i) A(i / 8, i % 8) = std::sin(1.7 * i);
  Eigen::VectorXd scale(8);
  scale << 1, 1, 1, 1, 1e-3, 1e-3, 1e-3, 1e-3;
  const Eigen::MatrixXd Sigma = scale.asDiagonal() * A * A.transpose() * scale.asDiagonal();
  for (const double range : {kUnbounded, 1.0}) {
    const ImageFitOptions grid{range, 9, 7};
    const ProjectionCovariance fitted = imageFitCovariance(seen, Sigma, grid);
    double sum = 0;
    for (int k = 0; k < 63; ++k) {
      const Eigen::Vector2d uv(k % 9 * 751 / 8.0, k / 9 * 479 / 6.0);
      sum += pixelCovariance(seen, fitted, uv, range)->trace();
    }
    EXPECT_NEAR(*imageFitMeanSquare(seen, Sigma, grid), sum / 63, 1e-9 * sum);
  }
}

// At a finite range a change of the focal length is mostly a step along the axis.
TEST(ImageFit, TranslationIsFittedAtAFiniteRange) {
  const Intrinsics narrow = camera(20000, 201, 201);
  Eigen::MatrixXd Sigma = Eigen::MatrixXd::Zero(8, 8);
  Sigma.topLeftCorner<2, 2>().setConstant(100);  // fu and fv by 10 px together
  const auto corner_std = [&](double range) {
    const ProjectionCovariance fitted = imageFitCovariance(narrow, Sigma, {range, 31, 21});
    return std::sqrt((*pixelCovariance(narrow, fitted, {0, 0}, range)).trace());
  };
  const double moved = 10 * std::sqrt(2.0) * 100 / 20000;  // 10 px x r / f
  EXPECT_LT(corner_std(2), 1e-3 * moved);
  EXPECT_NEAR(corner_std(kUnbounded), moved, 1e-3 * moved);
}

}  // namespace
}  // namespace plumbline

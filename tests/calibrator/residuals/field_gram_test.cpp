// SPDX-License-Identifier: BSD-3-Clause
// The columns of a misfit field in a view's Gram matrix, against sums over corners with dense rows.
#include "calibrator/residuals/field_gram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/available_sets.h"
#include "tests/calibrator/residuals/example_view.h"

namespace plumbline {
namespace {

const FieldBox kBox{{376, 240}, {376, 240}, {367, 248}};
const Eigen::MatrixXd kNoCombinations;

/// Rows (twist 6, intrinsics 8, fields 50, error) of every corner, squared up.
Eigen::MatrixXd denseSums(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                          double cauchy_px) {
  constexpr int kColumns = 14 + kFieldColumns + 1;
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(kColumns, kColumns);
  for (int i = 0; i < view.count; ++i) {
    const Eigen::Vector3d p_C = T_CF * Eigen::Vector3d(view.x[i], view.y[i], view.z[i]);
    const Projection projection = projectWithJacobians(camera, p_C).value();
    const Eigen::Vector2d uv(view.u[i], view.v[i]);
    const Eigen::Vector2d e = projection.uv - uv;
    const auto f = fieldFunctions(kBox, uv);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, kColumns);
    J.leftCols(14) << projection.J_point, -projection.J_point * skew(p_C), projection.J_intrinsics;
    J.block<1, kFieldFunctions>(0, 14) = f.transpose();
    J.block<1, kFieldFunctions>(1, 14 + kFieldFunctions) = f.transpose();
    J.rightCols<1>() = e;
    const double slope = cauchy_px > 0 ? 1 / (1 + e.squaredNorm() / (cauchy_px * cauchy_px)) : 1;
    sums += view.w[i] * view.w[i] * slope * J.transpose() * J;
  }
  return sums;
}

/// A lens of the kernel and one of the plain way, of one formula: without distortion.
TEST(FieldGram, ThePlainWayIsTheKernels) {
  Intrinsics vectorised = test::radtanCamera();
  vectorised.distortion.setZero();
  Intrinsics plain = vectorised;
  plain.distortion_model = DistortionModel::kNone;
  plain.distortion.resize(0);
  const AprilGrid target;
  const Transform T_CF = test::examplePose();
  const PackedCorners packed(target, {test::noisyView(target, plain, T_CF, 144, 0.5, 4)});
  for (const double cauchy_px : {0.0, 1.0}) {
    const FieldGram a =
        fieldGram(vectorised, T_CF, packed.view(0), kBox, FieldSquares::kKeep, {cauchy_px, 0});
    const FieldGram b =
        fieldGram(plain, T_CF, packed.view(0), kBox, FieldSquares::kKeep, {cauchy_px, 0});
    const double scale = 1e-10 * a.H.norm();
    EXPECT_LT((a.H - b.H).norm(), scale);
    EXPECT_LT((a.H_pose_f - b.H_pose_f).norm(), scale);
    EXPECT_LT((a.H_k_f.topRows<4>() - b.H_k_f).norm(), scale);
    EXPECT_LT((a.H_k.topLeftCorner<4, 4>() - b.H_k).norm(), scale);
    EXPECT_LT((a.H_f - b.H_f).norm(), 1e-9);
    EXPECT_LT((a.b_f - b.b_f).norm(), 1e-9);
    EXPECT_LT((a.b_k.head<4>() - b.b_k).norm(), scale);
    EXPECT_NEAR(a.squared_error, b.squared_error, 1e-9);
  }
}

/// A corner that cannot be projected is charged by its weight in both ways, and has no gradient.
TEST(FieldGram, ChargesACornerBehindTheCameraByItsWeight) {
  Intrinsics vectorised = test::radtanCamera();
  vectorised.distortion.setZero();
  Intrinsics plain = vectorised;
  plain.distortion_model = DistortionModel::kNone;
  plain.distortion.resize(0);
  const AprilGrid target;
  const Transform T_CF = test::examplePose();
  const PackedCorners packed(target, {test::noisyView(target, plain, T_CF, 144, 0.5, 4)});
  PackedView view = packed.view(0);
  std::vector<double> z(view.z, view.z + view.padded);
  std::vector<double> w(view.w, view.w + view.padded);
  const FieldGram whole = fieldGram(plain, T_CF, view, kBox, FieldSquares::kDrop);
  const double lost =
      (projectWithJacobians(plain, T_CF * Eigen::Vector3d(view.x[5], view.y[5], z[5])).value().uv -
       Eigen::Vector2d(view.u[5], view.v[5]))
          .squaredNorm();
  const Eigen::Vector3d back = T_CF.inverse().R.col(2);
  std::vector<double> x(view.x, view.x + view.padded);
  std::vector<double> y(view.y, view.y + view.padded);
  x[5] -= 100 * back.x();
  y[5] -= 100 * back.y();
  z[5] -= 100 * back.z();
  w[5] = 0.3;
  view.x = x.data();
  view.y = y.data();
  view.z = z.data();
  view.w = w.data();
  for (const Intrinsics& camera : {vectorised, plain}) {
    const FieldGram g = fieldGram(camera, T_CF, view, kBox, FieldSquares::kDrop);
    EXPECT_NEAR(g.squared_error, whole.squared_error - lost + 0.09 * kInvalidSquaredError, 1e-4);
    EXPECT_LT(g.b.norm(), 2 * whole.b.norm());
  }
}

/// The plain way, too, has the corners beyond the fold of the distortion, as viewGram() has.
TEST(FieldGram, HasTheCornersBeyondTheFold) {
  Intrinsics camera = test::everyModel()[6];  // omni-radtan
  const AprilGrid target;
  const Transform T_CF = test::examplePose();
  const PackedCorners packed(target, {test::noisyView(target, camera, T_CF, 144, 0.5, 4)});
  const PackedView view = packed.view(0);
  camera.distortion[0] = -12;
  int beyond = 0;
  for (int i = 0; i < view.count; ++i) {
    beyond += project(camera, T_CF * Eigen::Vector3d(view.x[i], view.y[i], view.z[i])) ? 0 : 1;
  }
  ASSERT_GT(beyond, 10);
  const ViewGram whole = viewGram(camera, T_CF, view, {0, 0});
  const FieldGram g = fieldGram(camera, T_CF, view, kBox, FieldSquares::kDrop);
  EXPECT_NEAR(g.squared_error, whole.squared_error, 1e-9 * whole.squared_error);
  EXPECT_LT((g.H - whole.H).norm(), 1e-9 * whole.H.norm());
  EXPECT_LT((g.H_k - whole.H_k).norm(), 1e-9 * whole.H_k.norm());
}

class FieldGramOf : public ::testing::TestWithParam<double> {};

TEST_P(FieldGramOf, IsTheSumOverCorners) {
  for (const Intrinsics& camera : {test::radtanCamera(), test::equidistantCamera()}) {
    const AprilGrid target;
    const Transform T_CF = test::examplePose();
    const PackedCorners packed(target, {test::noisyView(target, camera, T_CF, 109, 0.7, 3)});
    const PackedView view = packed.view(0);
    const Eigen::MatrixXd dense = denseSums(camera, T_CF, view, GetParam());
    const double scale = 1e-10 * dense.cwiseAbs().maxCoeff();
    const auto H_u = dense.block<kFieldFunctions, kFieldFunctions>(14, 14);
    const auto H_v =
        dense.block<kFieldFunctions, kFieldFunctions>(14 + kFieldFunctions, 14 + kFieldFunctions);
    for (const InstructionSet set : test::availableSets()) {
      const FieldGram g = fieldGram(camera, T_CF, view, kBox, FieldSquares::kKeep, {GetParam(), 0},
                                    kNoCombinations, set);
      EXPECT_LT((g.H - dense.topLeftCorner<6, 6>()).norm(), scale);
      EXPECT_LT((g.H_k - dense.block<8, 8>(6, 6)).norm(), scale);
      EXPECT_LT((g.H_pose_k - dense.block<6, 8>(0, 6)).norm(), scale);
      EXPECT_LT((g.H_pose_f - dense.block<6, kFieldColumns>(0, 14)).norm(), scale);
      EXPECT_LT((g.H_k_f - dense.block<8, kFieldColumns>(6, 14)).norm(), scale);
      EXPECT_LT((g.b_f - dense.block<kFieldColumns, 1>(14, 14 + kFieldColumns)).norm(), 1e-8);
      EXPECT_LT((g.b - dense.block<6, 1>(0, 14 + kFieldColumns)).norm(), scale);
      EXPECT_LT((g.H_f - H_u).norm(), 1e-9);
      EXPECT_LT((g.H_f - H_v).norm(), 1e-9);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Losses, FieldGramOf, ::testing::Values(0.0, 1.0));

TEST(FieldGram, ThePoseAndIntrinsicsAreThoseOfTheView) {
  const Intrinsics camera = test::radtanCamera();
  const AprilGrid target;
  const Transform T_CF = test::examplePose();
  const PackedCorners packed(target, {test::noisyView(target, camera, T_CF, 144, 0.3, 5)});
  for (const double cauchy_px : {0.0, 1.5}) {
    const FieldGram g =
        fieldGram(camera, T_CF, packed.view(0), kBox, FieldSquares::kDrop, {cauchy_px, 0});
    const ViewGram view = viewGram(camera, T_CF, packed.view(0), {cauchy_px, 0});
    EXPECT_LT((g.H_k - view.H_k).norm(), 1e-10 * view.H_k.norm());
    EXPECT_LT((g.H_pose_k - view.H_pose_k).norm(), 1e-10 * view.H_k.norm());
    EXPECT_NEAR(g.squared_error, view.squared_error, 1e-9);
    EXPECT_EQ(g.H_f.norm(), 0);
  }
}

TEST(FieldGram, CombinationsAreProductsOfTheColumns) {
  const AprilGrid target;
  const Transform T_CF = test::examplePose();
  Intrinsics plain = test::radtanCamera();
  plain.distortion_model = DistortionModel::kNone;
  plain.distortion.resize(0);
  // Seven: what is left over by groups of four and of two. Rows of a taller matrix, as of a rig.
  const Eigen::MatrixXd all = Eigen::MatrixXd::Random(2 * kFieldColumns, 7);
  const auto R = all.bottomRows(kFieldColumns);
  for (const Intrinsics& camera : {test::radtanCamera(), test::equidistantCamera(), plain}) {
    const PackedCorners packed(target, {test::noisyView(target, camera, T_CF, 109, 0.7, 3)});
    const auto gram = [&](FieldSquares squares, const Eigen::MatrixXd& combinations) {
      return fieldGram(camera, T_CF, packed.view(0), kBox, squares, {1, 0}, combinations);
    };
    const FieldGram each = gram(FieldSquares::kKeep, kNoCombinations);
    const FieldGram g =
        fieldGram(camera, T_CF, packed.view(0), kBox, FieldSquares::kKeep, {1, 0}, R);
    EXPECT_LT((g.H_pose_f - each.H_pose_f * R).norm(), 1e-12 * each.H_pose_f.norm());
    EXPECT_LT((g.H_k_f - each.H_k_f * R).norm(), 1e-12 * each.H_k_f.norm());
    EXPECT_EQ(gram(FieldSquares::kKeep, R).b_f, each.b_f);
    EXPECT_EQ(gram(FieldSquares::kDrop, R).b_f.norm(), 0);
  }
}

/// Whether each row of A is within 1e-6 of the length of B's.
::testing::AssertionResult rowsAgree(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  for (Eigen::Index i = 0; i < B.rows(); ++i) {
    const double off = (A.row(i) - B.row(i)).norm() / B.row(i).norm();
    if (!(off < 1e-6)) return ::testing::AssertionFailure() << "row " << i << ": " << off;
  }
  return ::testing::AssertionSuccess();
}

TEST(FieldGram, WithoutSquaresProductsHaveSinglePrecision) {
  AprilGrid target;
  target.rows = target.cols = 8;
  target.tag_size = 0.06;
  const Transform T_CF = test::examplePose();
  const Eigen::MatrixXd R = Eigen::MatrixXd::Random(kFieldColumns, 7);
  for (const Intrinsics& camera : {test::radtanCamera(), test::equidistantCamera()}) {
    // Less than a register, one chunk, the last chunk with padding, more than are collected.
    for (const int corners : {3, 48, 61, 144, 250}) {
      const PackedCorners packed(target, {test::noisyView(target, camera, T_CF, corners, 0.7, 3)});
      ASSERT_EQ(packed.view(0).count, corners);
      for (const InstructionSet set : test::availableSets()) {
        const auto gram = [&](FieldSquares squares, const Eigen::MatrixXd& combinations) {
          return fieldGram(camera, T_CF, packed.view(0), kBox, squares, {1, 0}, combinations, set);
        };
        const FieldGram exact = gram(FieldSquares::kKeep, kNoCombinations);
        const FieldGram single = gram(FieldSquares::kDrop, kNoCombinations);
        EXPECT_TRUE(rowsAgree(single.H_pose_f, exact.H_pose_f)) << corners;
        EXPECT_TRUE(rowsAgree(single.H_k_f, exact.H_k_f)) << corners;
        // What is without fields stays exact.
        EXPECT_EQ(single.H, exact.H);
        EXPECT_EQ(single.H_k, exact.H_k);
        EXPECT_EQ(single.b, exact.b);
        const FieldGram combined = gram(FieldSquares::kDrop, R);
        EXPECT_TRUE(rowsAgree(combined.H_pose_f, exact.H_pose_f * R)) << corners;
        EXPECT_TRUE(rowsAgree(combined.H_k_f, exact.H_k_f * R)) << corners;
      }
    }
  }
}

// All but the components along the radius, which only FieldBase makes so.
TEST(FieldFunctions, PolynomialsAreOrthonormalOverTheBox) {
  constexpr int kSide = 120;
  Eigen::Matrix<double, kFieldPolynomials, kFieldPolynomials> mean;
  mean.setZero();
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const Eigen::Vector2d uv(752 * (i + 0.5) / kSide, 480 * (j + 0.5) / kSide);
      const auto f = fieldFunctions(kBox, uv).head<kFieldPolynomials>().eval();
      mean += f * f.transpose() / (kSide * kSide);
    }
  }
  // The midpoint rule is off by the square of its step.
  EXPECT_LT((mean - mean.Identity()).cwiseAbs().maxCoeff(), 2e-2);
}

TEST(FieldFunctions, DisplaceAlongTheRadius) {
  // (40, -30) of the axis, in units of the half diagonal 50: d = (0.8, -0.6), r = 1.
  const FieldBox box{{300, 200}, {40, 30}, {290, 220}};
  const auto edge = fieldFunctions(box, {330, 190});
  const Eigen::Vector4d expected(0.8, -0.6, 0.8, -0.6);
  EXPECT_LT((edge.tail<4>() - expected).norm(), 1e-12);
  // Half way out: 2^-7 and 2^-9 of it.
  const auto inside = fieldFunctions(box, {310, 205});
  EXPECT_NEAR(inside[kFieldPolynomials], 0.8 / 128, 1e-14);
  EXPECT_NEAR(inside[kFieldPolynomials + 3], -0.6 / 512, 1e-14);
}

/// Displacements of the base at a pixel of camera 1 of two.
Eigen::MatrixXd displacements(const Eigen::MatrixXd& columns, const FieldBox& box,
                              const Eigen::Vector2d& uv) {
  const auto f = fieldFunctions(box, uv);
  Eigen::MatrixXd rows(2, columns.cols());
  rows.row(0) = f.transpose() * columns.middleRows<kFieldFunctions>(kFieldColumns);
  rows.row(1) =
      f.transpose() * columns.middleRows<kFieldFunctions>(kFieldColumns + kFieldFunctions);
  return rows;
}

TEST(FieldBase, IsOrthonormalAndHoldsRadialDisplacements) {
  const std::array<FieldBox, 2> boxes{FieldBox{{300, 200}, {300, 200}, {310, 190}}, kBox};
  const FieldBase base = fieldBase(boxes);
  ASSERT_EQ(base.polynomials.cols(), 4 * kFieldPolynomials);
  ASSERT_EQ(base.radials.cols(), 2 * kFieldRadials);
  // Columns of the other camera say nothing of this one.
  EXPECT_EQ(base.radials.bottomLeftCorner(kFieldColumns, kFieldRadials).norm(), 0);
  Eigen::MatrixXd all(2 * kFieldColumns, 2 * kFieldPolynomials + kFieldRadials);
  all << base.polynomials.rightCols(2 * kFieldPolynomials), base.radials.rightCols(kFieldRadials);
  constexpr int kSide = 30;  // as the base takes its means
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(all.cols(), all.cols());
  Eigen::VectorXd with_r9 = Eigen::VectorXd::Zero(all.cols());
  const auto r9 = [](const Eigen::Vector2d& uv) {
    const Eigen::Vector2d d = (uv - kBox.axis) / kBox.half.norm();
    return Eigen::Vector2d(d * std::pow(d.norm(), 8));
  };
  std::vector<Eigen::Vector2d> pixels;
  for (int k = 0; k < kSide * kSide; ++k) {
    pixels.emplace_back(752 * (k / kSide + 0.5) / kSide, 480 * (k % kSide + 0.5) / kSide);
    const Eigen::MatrixXd at = displacements(all, kBox, pixels.back());
    mean += at.transpose() * at / (kSide * kSide);
    with_r9 += at.transpose() * r9(pixels.back()) / (kSide * kSide);
  }
  const Eigen::MatrixXd all_radial = mean.rightCols(kFieldRadials);
  const auto I = Eigen::MatrixXd::Identity(all.cols(), all.cols());
  EXPECT_LT((all_radial - I.rightCols(kFieldRadials)).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::VectorXd c = mean.ldlt().solve(with_r9);
  double left = 0;
  for (const Eigen::Vector2d& uv : pixels) {
    left = std::max(left, (displacements(all, kBox, uv) * c - r9(uv)).norm());
  }
  EXPECT_LT(left, 1e-8);
  EXPECT_GT(c.tail<kFieldRadials>().norm(), 1e-2);  // not of the polynomials alone
}

TEST(FieldFunctions, KeepTheirEdgeValuesBeyondTheBox) {
  const FieldBox small{{300, 200}, {100, 80}};
  EXPECT_EQ(fieldFunctions(small, {700, 200}), fieldFunctions(small, {400, 200}));
  EXPECT_EQ(fieldFunctions(small, {-50, 500}), fieldFunctions(small, {200, 280}));
  // P_1 = x, times sqrt(3): the second function by y, the seventh by x.
  EXPECT_NEAR(fieldFunctions(small, {350, 200})[6], 0.5 * std::sqrt(3), 1e-12);
  EXPECT_NEAR(fieldFunctions(small, {300, 240})[1], 0.5 * std::sqrt(3), 1e-12);
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/transform.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const Transform kT_AB(expSO3({0.4, -1.2, 0.9}), {0.5, -0.3, 1.4});
const Transform kT_BC(expSO3({-2.0, 0.3, 0.1}), {-1.0, 0.2, 0.7});

TEST(Transform, MapsByHand) {
  // B is turned by 90 degrees about z and stands at (1, 2, 3) of A.
  const Transform T_AB(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())),
                       {1, 2, 3});
  EXPECT_TRUE((T_AB * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-15));
}

TEST(Transform, AdjacentLettersCancel) {
  const Eigen::Vector3d p_C(0.1, 0.2, 0.3);
  const Transform T_AC = kT_AB * kT_BC;
  EXPECT_TRUE((T_AC * p_C).isApprox(kT_AB * (kT_BC * p_C), 1e-15));
  EXPECT_TRUE(T_AC.matrix().isApprox(kT_AB.matrix() * kT_BC.matrix(), 1e-15));
  EXPECT_TRUE((kT_AB.inverse() * kT_AB).matrix().isIdentity(1e-15));
}

TEST(Transform, ReadsItsOwnMatrixAndRepairsARoundedOne) {
  EXPECT_TRUE(Transform::fromMatrix(kT_AB.matrix()).matrix().isApprox(kT_AB.matrix(), 1e-14));
  Eigen::Matrix4d rounded = kT_AB.matrix();
  rounded = (rounded * 1000).array().round().matrix() / 1000;  // as many files hold it
  const Transform repaired = Transform::fromMatrix(rounded);
  EXPECT_TRUE((repaired.R * repaired.R.transpose()).isIdentity(1e-14));
  EXPECT_LT(rotationAngle(repaired.R * kT_AB.R.transpose()), 1e-3);
}

TEST(Transform, NormalisesAQuaternion) {
  const Eigen::Quaterniond q = kT_AB.quaternion();
  const Transform T(Eigen::Quaterniond(3 * q.w(), 3 * q.x(), 3 * q.y(), 3 * q.z()), kT_AB.t);
  EXPECT_TRUE(T.R.isApprox(kT_AB.R, 1e-15));
}

TEST(Tangent, BoxminusInvertsBoxplus) {
  Vector6d d;
  d << 0.3, -0.2, 1.5, 0.7, -1.9, 0.4;
  EXPECT_TRUE(boxminus(boxplus(kT_AB, d), kT_AB).isApprox(d, 1e-14));
  const Transform back = boxplus(kT_BC, boxminus(kT_AB, kT_BC));
  EXPECT_TRUE(back.matrix().isApprox(kT_AB.matrix(), 1e-14));
}

TEST(Tangent, TranslationIsAdditiveAndRotationOnTheLeft) {
  Vector6d d;
  d << 1, 2, 3, 0.1, 0.2, 0.3;
  const Transform moved = boxplus(kT_AB, d);
  EXPECT_TRUE(moved.t.isApprox(kT_AB.t + d.head<3>(), 1e-15));
  EXPECT_TRUE(moved.R.isApprox(expSO3(d.tail<3>()) * kT_AB.R, 1e-14));
}

TEST(Tangent, MovesAPointAsItsDocumentationSays) {
  // dp_A = dt - [R p_B]x da, by central differences (error of order step^2).
  const Eigen::Vector3d p_B(0.4, -0.6, 0.8);
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(kT_AB.R * p_B);
  const double step = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const Vector6d d = step * Vector6d::Unit(i);
    const Eigen::Vector3d slope = (boxplus(kT_AB, d) * p_B - boxplus(kT_AB, -d) * p_B) / (2 * step);
    EXPECT_LT((slope - J.col(i)).norm(), 1e-9) << i;
  }
}

TEST(Tangent, LongChainsStayRotations) {
  Transform T = kT_AB;
  Vector6d d;
  d << 0, 0, 0, 0.01, -0.02, 0.03;
  for (int i = 0; i < 10000; ++i) T = boxplus(T, d);
  EXPECT_TRUE((T.R * T.R.transpose()).isIdentity(1e-13));
}

}  // namespace
}  // namespace plumbline

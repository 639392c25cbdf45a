// SPDX-License-Identifier: BSD-3-Clause
#include <functional>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

const Transform kT_FC0(expSO3({0.4, -2.2, 0.9}), {0.5, -0.3, 1.4});
const Transform kT_C0Ci(expSO3({0.1, 0.05, -0.2}), {0.11, 0.02, -0.03});
const Transform kT_SC0(expSO3({1.2, -1.1, 1.3}), {-0.02, 0.06, 0.01});
const Transform kT_FS(expSO3({-0.8, 0.7, 2.0}), {0.4, 0.2, 1.1});

// The twist (rho, phi) between two poses of the target: p' = p + rho + phi x p.
Vector6d twistBetween(const Transform& to, const Transform& from) {
  const Transform step = to * from.inverse();
  Vector6d twist;
  twist << step.t, logSO3(step.R);
  return twist;
}

// d twist / d tangent by central differences: the error is of order step^2 = 1e-10.
Matrix6d differences(const std::function<Transform(const Vector6d&)>& T_CiF) {
  const double step = 1e-5;
  Matrix6d A;
  for (int i = 0; i < 6; ++i) {
    const Vector6d d = step * Vector6d::Unit(i);
    const Transform here = T_CiF(Vector6d::Zero());
    A.col(i) = (twistBetween(T_CiF(d), here) - twistBetween(T_CiF(-d), here)) / (2 * step);
  }
  return A;
}

void expectNear(const Matrix6d& A, const Matrix6d& expected) {
  EXPECT_LT((A - expected).cwiseAbs().maxCoeff(), 1e-9) << A << "\n\n" << expected;
}

TEST(Tangent, OfAPoseByHand) {
  // Turning by da about z a target whose origin is at (1, 0, 0) leaves its origin where it is:
  // p' = p + rho + phi x p with phi = (0, 0, da) needs rho = (0, -da, 0).
  const Transform T(Eigen::Matrix3d::Identity(), {1, 0, 0});
  Vector6d expected;
  expected << 0, -1, 0, 0, 0, 1;
  EXPECT_TRUE(twistFromTangent(T).col(5).isApprox(expected, 1e-15));
}

TEST(Tangent, OfAPoseEqualsDifferences) {
  expectNear(twistFromTangent(kT_FC0),
             differences([](const Vector6d& d) { return boxplus(kT_FC0, d); }));
}

TEST(Tangent, CameraImuChainEqualsDifferences) {
  const CameraImuChain chain = cameraImuChain(kT_FS, kT_SC0, kT_C0Ci);
  EXPECT_TRUE(chain.T_CiF.matrix().isApprox((kT_FS * kT_SC0 * kT_C0Ci).inverse().matrix(), 1e-14));
  expectNear(chain.A_FS, differences([](const Vector6d& d) {
               return (boxplus(kT_FS, d) * kT_SC0 * kT_C0Ci).inverse();
             }));
  expectNear(chain.A_SC0, differences([](const Vector6d& d) {
               return (kT_FS * boxplus(kT_SC0, d) * kT_C0Ci).inverse();
             }));
  expectNear(chain.A_C0Ci, differences([](const Vector6d& d) {
               return (kT_FS * kT_SC0 * boxplus(kT_C0Ci, d)).inverse();
             }));
}

}  // namespace
}  // namespace plumbline

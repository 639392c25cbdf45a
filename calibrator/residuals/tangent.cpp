// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/transform.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

// For T_CF = T_CA * T_BA^-1 * T_BF, the twist of T_CF in the tangent of T_BA: the inverse turns the
// twist of T_BA, which acts in B, round, and T_CB = T_CA * T_BA^-1 carries it to C.
Matrix6d throughInverse(const Transform& T_CA, const Transform& T_BA) {
  return -adjoint(T_CA * T_BA.inverse()) * twistFromTangent(T_BA);
}

}  // namespace

Matrix6d adjoint(const Transform& T_AB) {
  Matrix6d Ad;
  Ad << T_AB.R, skew(T_AB.t) * T_AB.R, Eigen::Matrix3d::Zero(), T_AB.R;
  return Ad;
}

Matrix6d twistFromTangent(const Transform& T) {
  // da turns about the frame's own origin at t, phi about that of the frame it is in.
  Matrix6d A = Matrix6d::Identity();
  A.topRightCorner<3, 3>() = skew(T.t);
  return A;
}

Transform twisted(const Transform& T, const Vector6d& x) {
  const Eigen::Matrix3d turn = expSO3(x.tail<3>());
  return {Eigen::Quaterniond(turn * T.R), turn * T.t + x.head<3>()};
}

CameraImuChain cameraImuChain(const Transform& T_FS, const Transform& T_SC0,
                              const Transform& T_C0Ci) {
  const Transform T_CiC0 = T_C0Ci.inverse();
  const Transform T_CiS = T_CiC0 * T_SC0.inverse();
  // (A, B) = (S, F), (C0, S), (Ci, C0).
  CameraImuChain chain;
  chain.T_CiF = T_CiS * T_FS.inverse();
  chain.A_FS = throughInverse(T_CiS, T_FS);
  chain.A_SC0 = throughInverse(T_CiC0, T_SC0);
  chain.A_C0Ci = throughInverse(Transform(), T_C0Ci);
  return chain;
}

}  // namespace plumbline

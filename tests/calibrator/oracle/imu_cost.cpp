// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/imu_cost.h"

#include <algorithm>

namespace plumbline::oracle {
namespace {

template <int kRows, int kCols>
using RowMajor =
    Eigen::Matrix<double, kRows, kCols, kCols == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

template <int kRows, int kCols>
Eigen::Map<RowMajor<kRows, kCols>> into(double* to) {
  return Eigen::Map<RowMajor<kRows, kCols>>(to);
}

ImuState stateFrom(const double* pose, const double* velocity, const double* biases) {
  PoseBlock block;
  std::copy_n(pose, 7, block.begin());
  ImuState state;
  state.T_FS = transformFrom(block);
  state.v_F = Eigen::Map<const Eigen::Vector3d>(velocity);
  if (biases != nullptr) {
    state.gyro_bias = Eigen::Map<const Eigen::Vector3d>(biases);
    state.accel_bias = Eigen::Map<const Eigen::Vector3d>(biases + 3);
  }
  return state;
}

template <int kCols, class Derived>
void write(double* to, const Eigen::MatrixBase<Derived>& J) {
  if (to != nullptr) into<9, kCols>(to) = J;
}

// Ceres multiplies by the manifold's Plus Jacobian P, whose columns are orthonormal, so J P^T is
// what it turns back into J; its rotation is da / 2.
void writePose(double* to, const ceres::Manifold& manifold, const double* pose,
               Eigen::Matrix<double, 9, 6> J) {
  if (to == nullptr) return;
  RowMajor<7, 6> P;
  manifold.PlusJacobian(pose, P.data());
  J.rightCols<3>() *= 2;
  write<7>(to, J * P.transpose());
}

}  // namespace

bool MotionCost::Evaluate(double const* const* parameters, double* residuals,
                          double** jacobians) const {
  const ImuState i = stateFrom(parameters[0], parameters[1], parameters[2]);
  const ImuState j = stateFrom(parameters[3], parameters[4], nullptr);
  const Gravity gravity{Eigen::Map<const Eigen::Vector3d>(parameters[5]), interval_.gravity_m_s2};
  const auto motion =
      preintegrate(interval_.samples, {interval_.from, interval_.to, parameters[6][0]},
                   {i.gyro_bias, i.accel_bias});
  if (!motion) return false;
  const ImuResidual r = imuResidual(*motion, i, j, gravity);
  const Matrix9d& W = interval_.weight.sqrt_information;
  into<9, 1>(residuals) = W * r.r;
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, 9, 15> J_i = W * r.J_i;
  const Eigen::Matrix<double, 9, 9> J_j = W * r.J_j;
  writePose(jacobians[0], *manifold_, parameters[0], J_i.leftCols<6>());
  write<3>(jacobians[1], J_i.middleCols<3>(6));
  write<6>(jacobians[2], J_i.rightCols<6>());
  writePose(jacobians[3], *manifold_, parameters[3], J_j.leftCols<6>());
  write<3>(jacobians[4], J_j.rightCols<3>());
  write<3>(jacobians[5], W * r.J_gravity * tangentBasis(gravity.direction).transpose());
  write<1>(jacobians[6], W * r.J_offset);
  return true;
}

bool BiasWalkCost::Evaluate(double const* const* parameters, double* residuals,
                            double** jacobians) const {
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(weight_.gyro_walk),
      Eigen::Vector3d::Constant(weight_.accel_walk);
  const Vector6d from(parameters[0]);
  const Vector6d to(parameters[1]);
  into<6, 1>(residuals) = scale.cwiseProduct(to - from);
  if (jacobians == nullptr) return true;
  const Matrix6d J = scale.asDiagonal();
  if (jacobians[0] != nullptr) into<6, 6>(jacobians[0]) = -J;
  if (jacobians[1] != nullptr) into<6, 6>(jacobians[1]) = J;
  return true;
}

}  // namespace plumbline::oracle

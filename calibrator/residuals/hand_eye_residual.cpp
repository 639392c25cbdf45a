// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/hand_eye_residual.h"

#include "calibrator/base/lie.h"

namespace plumbline {

HandEyeResidual handEyeResidual(const HandEyePair& pair, const HandEyeState& state) {
  const Eigen::Matrix3d R_VS = state.T_VW.R * pair.T_WS.R;
  const Transform T_WM = pair.T_WS * state.T_SM;
  const Transform P = state.T_VW * T_WM;
  const Eigen::Matrix3d R_VM = expSO3(state.offset_s * pair.omega_V) * pair.T_VM.R;
  const Eigen::Vector3d angle = logSO3(P.R * R_VM.transpose());

  HandEyeResidual out;
  out.r << P.t - pair.T_VM.t - state.offset_s * pair.v_V, angle;
  const Eigen::Matrix3d Jl = inverseLeftJacobianSO3(angle);
  out.J_SM.topLeftCorner<3, 3>() = R_VS;
  out.J_SM.bottomRightCorner<3, 3>() = Jl * R_VS;
  out.J_VW.topLeftCorner<3, 3>().setIdentity();
  out.J_VW.topRightCorner<3, 3>() = -skew(state.T_VW.R * T_WM.t);
  out.J_VW.bottomRightCorner<3, 3>() = Jl;
  out.J_offset << -pair.v_V, -inverseRightJacobianSO3(angle) * pair.omega_V;
  return out;
}

}  // namespace plumbline

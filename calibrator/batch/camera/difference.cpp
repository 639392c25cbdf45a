// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/difference.h"

namespace plumbline {

Eigen::VectorXd cameraDifference(const std::vector<CameraCalibration>& to,
                                 const std::vector<CameraCalibration>& from) {
  std::vector<double> d;
  for (std::size_t c = 0; c < to.size(); ++c) {
    const Eigen::VectorXd k = to[c].intrinsics.stacked() - from[c].intrinsics.stacked();
    d.insert(d.end(), k.begin(), k.end());
  }
  for (std::size_t c = 1; c < to.size(); ++c) {
    const Vector6d x = boxminus(to[c].T_C0Ci, from[c].T_C0Ci);
    d.insert(d.end(), x.begin(), x.end());
  }
  return Eigen::Map<const Eigen::VectorXd>(d.data(), static_cast<Eigen::Index>(d.size()));
}

}  // namespace plumbline

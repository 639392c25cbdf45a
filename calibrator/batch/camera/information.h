// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/measurement_model.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/information/projection_uncertainty.h"

namespace plumbline {

/// The loss of the measurement model weights the corners.
struct CameraInformationOptions : MeasurementModel {
  FrameAlignment alignment = FrameAlignment::kCrossReprojection;
  int threads = 1;  ///< results do not depend on it
};

/// What a session tells of cameras, linearised at their given values.
struct CameraInformation {
  ParameterCovariance covariance;                ///< as of calibrateCameras(): poses marginalised
  double entropy_nats = 0;                       ///< of `covariance`
  std::vector<ProjectionCovariance> projection;  ///< one per camera
};

/// Information of the used corners of `at` (from calibrateCameras() or scoreCameras() on the same
/// session) at its cameras and poses; nothing is estimated. For two calibrations of one rig the
/// entropies compare, since list, noise and corners are the same.
/// With A_i the adjoint of T_CiC0, the twist of the points in camera i's frame is
///   A_i tau + diag(-R_CiC0, -R_CiC0) e_i,   e_i the tangent of T_C0Ci,
/// tau as in information/projection_uncertainty.h. Fails with kNotObservable.
Result<CameraInformation> cameraInformation(const Session& session, const CameraStageResult& at,
                                            const CameraInformationOptions& options = {});

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "calibrator/base/calibration.h"
#include "calibrator/camera/double_sphere.h"
#include "calibrator/camera/equidistant.h"
#include "calibrator/camera/eucm.h"
#include "calibrator/camera/fov.h"
#include "calibrator/camera/omni.h"
#include "calibrator/camera/pinhole.h"
#include "calibrator/camera/radtan.h"

namespace plumbline {

/// The models that cameras can have: a new one is a type in a file of its own and a member here.
/// All of them project, and are scored and compared.
using AnyCameraModel =
    std::variant<PinholeRadtan, PinholeEquidistant, PinholeFov, PinholeNone, OmniRadtan,
                 OmniEquidistant, OmniFov, OmniNone, DoubleSphere, Eucm>;

/// Those that can also be calibrated: the vectorised Gram kernel is compiled for them.
template <class Model>
inline constexpr bool kIsCalibrated = canBeCalibrated(Model::kProjection, Model::kDistortion);

/// The model of a camera's intrinsics, to be visited. Throws InputError, naming what is supported,
/// for a model without implementation or a wrong number of parameters.
AnyCameraModel cameraModelOf(const Intrinsics& camera);

}  // namespace plumbline

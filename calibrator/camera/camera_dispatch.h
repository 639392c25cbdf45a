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
#include "calibrator/camera/rational.h"

namespace plumbline {

/// The models that cameras can have: a new one is a type in a file of its own and a member here.
/// All of them project, and are scored and compared.
using AnyCameraModel =
    std::variant<PinholeRadtan, PinholeEquidistant, PinholeRational, PinholeFov, PinholeNone,
                 OmniRadtan, OmniEquidistant, OmniFov, OmniNone, DoubleSphere, Eucm>;

/// Those that the vectorised Gram kernel is compiled for; the others go the plain way.
template <class Model>
inline constexpr bool kIsVectorised = false;
template <>
inline constexpr bool kIsVectorised<PinholeRadtan> = true;
template <>
inline constexpr bool kIsVectorised<PinholeEquidistant> = true;

/// The model of a camera's intrinsics, to be visited. Throws InputError, naming what is supported,
/// for a model without implementation or a wrong number of parameters.
AnyCameraModel cameraModelOf(const Intrinsics& camera);

}  // namespace plumbline

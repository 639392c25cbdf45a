// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "calibrator/base/calibration.h"
#include "calibrator/camera/equidistant.h"
#include "calibrator/camera/radtan.h"

namespace plumbline {

/// The models that can be calibrated: a new one is a type in a file of its own and a member here.
using AnyCameraModel = std::variant<PinholeRadtan, PinholeEquidistant>;

/// The model of a camera's intrinsics, to be visited. Throws InputError, naming what is supported,
/// for a model without implementation or a wrong number of parameters.
AnyCameraModel cameraModelOf(const Intrinsics& camera);

}  // namespace plumbline

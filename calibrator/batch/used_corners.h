// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// All corners of a session, one block per camera.
std::vector<PackedCorners> packCorners(const Session& session);

/// The same without those that an earlier result of the session rejected (their weight is 0).
std::vector<PackedCorners> usedCorners(const Session& session, const CameraStageResult& earlier);

}  // namespace plumbline

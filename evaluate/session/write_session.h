// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/session.h"

namespace plumbline {

/// Writes a session with its corners as a EuRoC folder that `plumbline calibrate` reads. The folder
/// appears complete or not at all; throws InputError where it exists and is not empty.
void writeCornerSession(const Session& session, const std::string& folder);

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/session/session_reader.h"

namespace plumbline {

/// Keeps the frames that the options ask for (from_s, to_s, stride) and the IMU samples around
/// them. Throws InputError for options out of range or where nothing would be left.
void selectFrames(Recording& recording, const SessionReadOptions& options);

}  // namespace plumbline

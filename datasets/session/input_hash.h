// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "datasets/session/session_reader.h"

namespace plumbline {

/// "xxh64:<16 digits>" over the files that readRecording() reads: name (below the session) and
/// bytes of every CSV and YAML file; of images the name and the size, because reading them all
/// would cost more than the calibration. Does not depend on where the session lies, nor on the
/// order in which files are listed. `options` say which target and IMU files are read; `others` are
/// files beside the session (a calibration that is given), in their order and without their names.
std::string inputHash(const std::string& session, const SessionReadOptions& options = {},
                      const std::vector<std::string>& others = {});

}  // namespace plumbline

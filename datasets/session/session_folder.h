// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/session/session_reader.h"

namespace plumbline {

/// Where the parts of a session lie.
struct SessionFolder {
  std::string name;                  ///< last part of the path, without mav0
  std::string root;                  ///< the folder that holds camN and imu0
  std::vector<std::string> cameras;  ///< folders cam0, cam1, ... in numeric order
  std::optional<std::string> imu;    ///< folder imu0
  std::vector<std::string> beside;   ///< where target.yaml and imu.yaml may lie, nearest first
};

/// Finds the parts of the session in `path`. Throws InputError where `path` is no folder or holds
/// no camera.
SessionFolder findSession(const std::string& path);

/// The first of `folders` that holds `name`, as a path; empty where none does.
std::optional<std::string> findBeside(const std::vector<std::string>& folders,
                                      const std::string& name);

/// "xxh64:<16 digits>" over the files that readRecording() reads: name (below the session) and
/// bytes of every CSV and YAML file; of images the name and the size, because reading them all
/// would cost more than the calibration. Does not depend on where the session lies, nor on the
/// order in which files are listed. `options` say which target and IMU files are read; `others` are
/// files beside the session (a calibration that is given), in their order and without their names.
std::string inputHash(const std::string& session, const SessionReadOptions& options = {},
                      const std::vector<std::string>& others = {});

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace plumbline {

/// Where the parts of a session lie.
struct SessionFolder {
  std::string name;                  ///< last part of the path, without mav0
  std::string root;                  ///< the folder that holds camN and imu0
  std::vector<std::string> cameras;  ///< folders cam0, cam1, ... in numeric order
  std::optional<std::string> imu;    ///< folder imu0
  std::vector<std::string> beside;   ///< where target.yaml and imu.yaml may lie, nearest first
};

/// Where target.yaml, imu.yaml and suggestions.csv of the session in `path` may lie, nearest first:
/// there, in its mav0, and beside it where it is itself mav0.
std::vector<std::string> besideSession(const std::string& path);

/// Finds the parts of the session in `path`. Throws InputError where `path` is no folder or holds
/// no camera.
SessionFolder findSession(const std::string& path);

/// The first of `folders` that holds `name`, as a path; empty where none does.
std::optional<std::string> findBeside(const std::vector<std::string>& folders,
                                      const std::string& name);

}  // namespace plumbline

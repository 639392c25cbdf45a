// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/guide_decision.h"

namespace plumbline {

/// Reads suggestions.csv of a guided recording: what its operator was asked for, and when. A row is
///   t_ns, stage, id, T_FC0, camera
/// with stage "camera" or "camera-imu", id an integer, and T_FC0 either as seven numbers (tx ty tz
/// [m], Hamilton quaternion qx qy qz qw) or as a 4x4 matrix row by row (16 numbers, or the first
/// 12). The camera's number, from 0, for whose image a view was made may be left out: -1. Ascending
/// in time. Throws InputError, naming file and line, for anything else: stamps out
/// of order, an id given twice, a quaternion whose norm is off 1 by more than 1e-3, a rotation that
/// is none.
std::vector<Suggestion> readSuggestions(const std::string& path);

/// suggestions.csv of a recording, where its target.yaml may lie; empty where there is none.
std::optional<std::string> findSuggestions(const std::string& session);

}  // namespace plumbline

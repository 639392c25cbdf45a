// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibrator/base/time.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline::capture_internal {

// What exports of motion capture have in common: a frame a row, columns by body.

/// In place of the index of a column that a table lacks.
inline constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

/// Columns of a body's pose; without the rotation's w it is a vector.
struct Body {
  std::string name;
  std::array<std::size_t, 3> position = {kNoColumn, kNoColumn, kNoColumn};
  std::array<std::size_t, 4> rotation = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};  // x, y, z, w

  /// A column of the position or the rotation; of another axis it is left out.
  void take(bool of_rotation, std::string_view axis, std::size_t column) {
    const std::size_t i = std::string_view("XYZW").find(axis);
    if (axis.size() != 1 || i > 3) return;
    if (of_rotation) rotation[i] = column;
    if (!of_rotation && i < 3) position[i] = column;
  }
};

/// The cell, empty where the row is shorter.
std::string_view cellAt(const Cells& cells, std::size_t i);
/// Whether the row has these cells and all are empty: what was not seen.
bool areEmpty(const Cells& cells, std::span<const std::size_t> columns);
/// Throws InputError where the file stops in this row before its last column: the number there may
/// have lost digits.
void refuseCutRow(const TextTable& table, const Cells& cells, std::size_t columns);
/// The body that `wanted` names, or the only one. Throws InputError with the names.
const Body& chooseBody(const TrajectorySource& source, const std::vector<Body>& bodies,
                       const std::string& wanted);
/// Frames per second; `name` is what the export calls them.
double frameRate(const TrajectorySource& source, int line, const char* name, std::string_view text);
TimeNs stampOf(double frame, double rate);
/// `noun`: what the export calls a body.
void remarkOnSkipped(TrajectoryBuilder& builder, std::size_t skipped, std::size_t frames,
                     const char* noun);

}  // namespace plumbline::capture_internal

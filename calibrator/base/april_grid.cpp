// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/april_grid.h"

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {

std::vector<Eigen::Vector3d> cornerPoints(const AprilGrid& board) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(board.cornerCount()));
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d p = board.corner(id);
    points.emplace_back(p.x(), p.y(), 0);
  }
  // Most boards: no basis is made for them.
  if (board.shape.isFlat()) return points;
  const TargetBasis basis(board);
  for (std::size_t id = 0; id < points.size(); ++id) {
    points[id] += basis.columns(static_cast<int>(id)) * board.shape.terms;
  }
  if (board.shape.higher) {
    const HigherBasis higher(board);
    for (std::size_t id = 0; id < points.size(); ++id) {
      points[id] += higher.displacement(static_cast<int>(id), *board.shape.higher);
    }
  }
  if (board.shape.corners) {
    if (board.shape.corners->size() != 3 * board.cornerCount()) {  // of a record that was edited
      throw InputError(fmt::format("the target's shape has {} remainders of corners, expected {}",
                                   board.shape.corners->size(), 3 * board.cornerCount()));
    }
    for (std::size_t id = 0; id < points.size(); ++id) {
      points[id] += board.shape.corners->segment<3>(3 * static_cast<Eigen::Index>(id));
    }
  }
  return points;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/QR>
#include <vector>

#include "calibrator/simulate/render.h"

namespace plumbline {

// The corners' displacements are a quadratic's values, so that least squares finds it exactly. A
// grid too small to tell some of its terms (one tag) has none of them: the shortest solution.
BoardSurface::BoardSurface(const AprilGrid& board)
    : centre_(static_cast<float>(0.5 * board.width()), static_cast<float>(0.5 * board.height())),
      unit_(centre_.norm()) {
  AprilGrid printed = board;
  // Only what is printed: tag_edge is how a detector errs.
  printed.shape.terms[kTargetTerms - 1] = 0;
  printed.shape.higher.reset();
  printed.shape.corners.reset();  // of a detector, not printed
  const std::vector<Eigen::Vector3d> points = cornerPoints(printed);
  const Eigen::Vector2d centre(0.5 * board.width(), 0.5 * board.height());
  Eigen::MatrixXd monomials(board.cornerCount(), 6), displacements(board.cornerCount(), 3);
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d p = board.corner(id), at = (p - centre) / centre.norm();
    monomials.row(id) << 1, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y();
    displacements.row(id) = points[id].transpose();
    displacements.row(id).head<2>() -= p.transpose();
  }
  const Eigen::MatrixXd quadratic =
      monomials.completeOrthogonalDecomposition().solve(displacements);
  polynomial_ = quadratic.transpose().cast<float>();
  if (!board.shape.higher) return;
  // Of degree 4 and less, so that this fit is exact as well.
  const HigherBasis basis(board);
  Eigen::MatrixXd quartics(board.cornerCount(), 15);
  for (int id = 0; id < board.cornerCount(); ++id) {
    const Eigen::Vector2d at = (board.corner(id) - centre) / centre.norm();
    quartics.row(id) = quartic(at.cast<float>()).cast<double>().transpose();
    displacements.row(id) = basis.displacement(id, *board.shape.higher).transpose();
  }
  const Eigen::MatrixXd fitted = quartics.completeOrthogonalDecomposition().solve(displacements);
  higher_ = fitted.transpose().cast<float>();
}

}  // namespace plumbline

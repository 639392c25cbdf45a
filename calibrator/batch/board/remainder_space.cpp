// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/board/higher_terms.h"

namespace plumbline {

RemainderSpace::RemainderSpace(const AprilGrid& board) {
  constexpr int kSimilarity = 4;  // in the plane: translation, scale, rotation
  constexpr int kFirst = kSimilarity + kTargetTerms;
  const int n = board.cornerCount();
  const TargetBasis terms(board);
  const HigherBasis higher(board);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(2 * n, kFirst + 2 * kHigherFunctions);
  Eigen::MatrixXd Z(n, 6 + kHigherFunctions);
  for (int id = 0; id < n; ++id) {
    // Of order one, like the functions beside them: pivots compare columns.
    const Eigen::Vector2d p = board.corner(id) / board.width();
    const Eigen::Matrix<double, 3, kTargetTerms> B = terms.columns(id);
    const Eigen::RowVectorXd phi = higher.functions(id).transpose();
    P.block<2, kSimilarity>(2 * id, 0) << 1, 0, p.x(), -p.y(), 0, 1, p.y(), p.x();
    P.block<2, kTargetTerms>(2 * id, kSimilarity) = B.topRows<2>();
    P.block<1, kHigherFunctions>(2 * id, kFirst) = phi;
    P.block<1, kHigherFunctions>(2 * id + 1, kFirst + kHigherFunctions) = phi;
    // In height translation along z and turns about x and y are the similarity's part.
    Z.row(id) << 1, p.x(), p.y(), B.block<1, 3>(2, 8), phi;
  }
  // With pivots: on a small grid columns coincide or are zero, and what the others span counts.
  plane_.compute(P);
  height_.compute(Z);
}

Eigen::MatrixXd RemainderSpace::reduced(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
  // The first rows of Q^T x are what similarity and terms explain; the last ones are orthogonal to
  // all of them.
  const Eigen::MatrixXd P = plane_.householderQ().adjoint() * rows.topRows(plane_.rows());
  const Eigen::MatrixXd Z = height_.householderQ().adjoint() * rows.bottomRows(height_.rows());
  Eigen::MatrixXd out(size(), rows.cols());
  out << P.bottomRows(plane()), Z.bottomRows(height());
  return out;
}

Eigen::VectorXd RemainderSpace::corners(const Eigen::VectorXd& coordinates) const {
  Eigen::VectorXd P = Eigen::VectorXd::Zero(plane_.rows());
  Eigen::VectorXd Z = Eigen::VectorXd::Zero(height_.rows());
  P.tail(plane()) = coordinates.head(plane());
  Z.tail(height()) = coordinates.tail(height());
  const Eigen::VectorXd in_plane = plane_.householderQ() * P;
  const Eigen::VectorXd heights = height_.householderQ() * Z;
  Eigen::Matrix3Xd out(3, Z.size());
  out << Eigen::Map<const Eigen::Matrix2Xd>(in_plane.data(), 2, Z.size()), heights.transpose();
  return out.reshaped();
}

Eigen::VectorXd RemainderSpace::coordinates(const Eigen::VectorXd& corners) const {
  const Eigen::Map<const Eigen::Matrix3Xd> d(corners.data(), 3, height_.rows());
  Eigen::VectorXd rows(corners.size());
  rows << d.topRows<2>().reshaped(), d.row(2).transpose();
  return reduced(rows).col(0);
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/target_shape.h"

#include <cassert>
#include <cmath>

#include "calibrator/base/april_grid.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

using Column = Eigen::ArrayXd;  // a value per corner

/// The pair over its joint RMS length; zero where it has none. Coordinates are of size 1, so that
/// below 1e-9 stands rounding: X^2 less its mean, over the corners of one tag.
void toUnitRms(Column& x, Column& y) {
  const double rms = std::sqrt((x.square() + y.square()).mean());
  const double factor = rms > 1e-9 ? 1 / rms : 0;
  x *= factor;
  y *= factor;
}

Column centredUnitRms(Column q) {
  q -= q.mean();
  Column none = Column::Zero(q.size());
  toUnitRms(q, none);
  return q;
}

/// Least squares of displacements by the twelve terms, a similarity and, where asked for, the
/// higher terms; the shape of the solution, and the largest displacement that it leaves.
struct FittedShape {
  TargetShape shape;
  double left = 0;  ///< [m]
};
FittedShape fitShape(const AprilGrid& grid, const std::vector<Eigen::Vector3d>& displacement,
                     bool with_higher) {
  const int n = grid.cornerCount();
  assert(static_cast<int>(displacement.size()) == n);
  const TargetBasis basis(grid);
  const HigherBasis higher(grid);
  constexpr int kFirst = kTargetTerms + 7;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * n, kFirst + (with_higher ? kHigherTerms : 0));
  Eigen::VectorXd d(3 * n);
  for (int id = 0; id < n; ++id) {
    const Eigen::Vector2d p = grid.corner(id);
    Eigen::Matrix<double, 3, 7> similarity;      // translation, rotation, scale
    similarity << 1, 0, 0, 0, 0, -p.y(), p.x(),  //
        0, 1, 0, 0, 0, p.x(), p.y(),             //
        0, 0, 1, p.y(), -p.x(), 0, 0;
    A.block<3, kFirst>(3 * id, 0) << basis.columns(id), similarity;
    for (int axis = 0; axis < 3 && with_higher; ++axis) {
      A.block<1, kHigherFunctions>(3 * id + axis, kFirst + kHigherFunctions * axis) =
          higher.functions(id).transpose();
    }
    d.segment<3>(3 * id) = displacement[static_cast<std::size_t>(id)];
  }
  // The smallest of all solutions, for on a small grid columns coincide: on one tag tag_edge is the
  // scale.
  const Eigen::VectorXd x = leastSquares(A, d);
  FittedShape out{{x.head<kTargetTerms>(), std::nullopt, std::nullopt},
                  (d - A * x).cwiseAbs().maxCoeff()};
  if (with_higher) out.shape.higher = x.tail<kHigherTerms>();
  return out;
}

}  // namespace

// (X, Y) is the scale and (-Y, X) the rotation. The weights make stretch and shear orthogonal to
// them over the corners, also on a board that is not square; the quadratic terms are so by the
// grid's symmetry about its centre, once their mean, a translation, is gone.
TargetBasis::TargetBasis(const AprilGrid& grid) {
  const int n = grid.cornerCount();
  const Eigen::Vector2d centre(0.5 * grid.width(), 0.5 * grid.height());
  Column X(n), Y(n);
  for (int id = 0; id < n; ++id) {
    const Eigen::Vector2d p = (grid.corner(id) - centre) / centre.norm();
    X[id] = p.x();
    Y[id] = p.y();
  }
  const double xx = X.square().mean();
  const double yy = Y.square().mean();
  Column stretch_x = yy * X, stretch_y = -xx * Y;
  Column shear_x = xx * Y, shear_y = yy * X;
  toUnitRms(stretch_x, stretch_y);
  toUnitRms(shear_x, shear_y);
  const Column q1 = centredUnitRms(X.square());
  const Column q2 = centredUnitRms(X * Y);
  const Column q3 = centredUnitRms(Y.square());
  for (int id = 0; id < n; ++id) {
    const int k = id % 4;
    // Half of the term at either end of an edge, which grows by the whole.
    const double edge_x = k == 1 || k == 2 ? 0.5 : -0.5;
    const double edge_y = k == 2 || k == 3 ? 0.5 : -0.5;
    functions_.push_back({stretch_x[id], stretch_y[id], shear_x[id], shear_y[id], q1[id], q2[id],
                          q3[id], edge_x, edge_y});
  }
}

Eigen::Matrix<double, 3, kTargetTerms> TargetBasis::columns(const Functions& f) {
  Eigen::Matrix<double, 3, kTargetTerms> B = Eigen::Matrix<double, 3, kTargetTerms>::Zero();
  B.col(0).head<2>() << f[kStretchX], f[kStretchY];
  B.col(1).head<2>() << f[kShearX], f[kShearY];
  for (int axis = 0; axis < 3; ++axis) {
    for (int q = 0; q < 3; ++q) {
      B(axis, 2 + 3 * axis + q) = f[static_cast<std::size_t>(kQ1 + q)];
    }
  }
  B.col(11).head<2>() << f[kEdgeX], f[kEdgeY];
  return B;
}

// Exact zeros: what a small grid cannot tell has been set to them, not left to rounding.
std::array<bool, kTargetTerms> TargetBasis::observable() const {
  Eigen::Array<double, 1, kTargetTerms> largest = Eigen::Array<double, 1, kTargetTerms>::Zero();
  for (int id = 0; id < cornerCount(); ++id) {
    largest = largest.max(columns(id).cwiseAbs().colwise().maxCoeff().array());
  }
  std::array<bool, kTargetTerms> out{};
  for (int j = 0; j < kTargetTerms; ++j) out[static_cast<std::size_t>(j)] = largest[j] > 0;
  return out;
}

double TargetShape::rms() const {
  // Displacements of unit RMS that are orthogonal over the corners: their squares add up.
  const double square = terms.head<kTargetTerms - 1>().squaredNorm();
  return std::sqrt(square + (higher ? higher->squaredNorm() : 0));
}

HigherBasis::HigherBasis(const AprilGrid& grid) {
  constexpr int kHighest = 4;
  constexpr int kLower = 6;  // functions of degrees 0 to 2
  // Of a function, that is its own. A grid with m places along an axis has x^m as a combination of
  // lower powers; what is left of it there is rounding.
  constexpr double kLeastShare = 1e-4;
  const int n = grid.cornerCount();
  const Eigen::Vector2d centre(0.5 * grid.width(), 0.5 * grid.height());
  Eigen::MatrixXd Q(n, kLower + kHigherFunctions);
  for (int id = 0; id < n; ++id) {
    const Eigen::Vector2d p = (grid.corner(id) - centre) / centre.norm();
    int column = 0;
    for (int degree = 0; degree <= kHighest; ++degree) {
      for (int j = 0; j <= degree; ++j) {
        Q(id, column++) = std::pow(p.x(), degree - j) * std::pow(p.y(), j);
      }
    }
  }
  // Gram-Schmidt in the order of degrees, so that a function keeps what those before it have not;
  // twice, which is enough (Parlett, "The Symmetric Eigenvalue Problem", 1980). Columns have the
  // length sqrt(n), that of unit RMS, hence / n.
  for (int j = 0; j < Q.cols(); ++j) {
    const double before = Q.col(j).norm();
    for (int round = 0; round < 2; ++round) {  // the second for what rounding left
      const Eigen::VectorXd shares = Q.leftCols(j).transpose() * Q.col(j) / n;
      Q.col(j) -= Q.leftCols(j) * shares;
    }
    const double after = Q.col(j).norm();
    if (after > kLeastShare * before) {
      Q.col(j) *= std::sqrt(n) / after;
    } else {
      Q.col(j).setZero();
    }
  }
  for (int id = 0; id < n; ++id) functions_.emplace_back(Q.row(id).tail<kHigherFunctions>());
}

Eigen::Vector3d HigherBasis::displacement(int corner_id, const HigherTerms& terms) const {
  const Eigen::Map<const Eigen::Matrix<double, kHigherFunctions, 3>> axes(terms.data());
  return axes.transpose() * functions(corner_id);
}

TargetShape fitTargetShape(const AprilGrid& grid,
                           const std::vector<Eigen::Vector3d>& displacement) {
  // What the twelve terms leave by less than rounding needs no others.
  constexpr double kRounding = 1e-12;  // [m]
  const FittedShape twelve = fitShape(grid, displacement, false);
  return twelve.left < kRounding ? twelve.shape : fitShape(grid, displacement, true).shape;
}

}  // namespace plumbline

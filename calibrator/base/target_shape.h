// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace plumbline {

struct AprilGrid;

/// Length of a tag's edges in the image [px] at which tag_edge is stated, and its factor elsewhere;
/// edges below a tenth of that, which false corners make, count as a tenth.
inline constexpr double kTagEdgePx = 40;
inline double tagEdgeScale(double edge_px) {
  return kTagEdgePx / std::max(edge_px, 0.1 * kTagEdgePx);
}

/// Parameters by which a board departs from the flat and even grid of target.yaml.
inline constexpr int kTargetTerms = 12;
using TargetTerms = Eigen::Matrix<double, kTargetTerms, 1>;
using TargetCovariance = Eigen::Matrix<double, kTargetTerms, kTargetTerms>;

/// Their names, in order: the board's plane (stretch, shear, and quadratic displacements along x
/// and y), its height (quadratic), and the size of the tags at unchanged pitch.
inline constexpr std::array<const char*, kTargetTerms> kTargetTermNames = {
    "stretch", "shear", "x_xx", "x_xy", "x_yy", "y_xx",
    "y_xy",    "y_yy",  "z_xx", "z_xy", "z_yy", "tag_edge"};

/// Terms of degrees 3 and 4 beside them: 9 functions of HigherBasis along x, then y, then z.
inline constexpr int kHigherFunctions = 9;
inline constexpr int kCubicFunctions = 4;  ///< the first of them; the others are of degree 4
inline constexpr int kHigherTerms = 3 * kHigherFunctions;
using HigherTerms = Eigen::Matrix<double, kHigherTerms, 1>;

/// The board's own shape: a displacement of every corner of the grid in F,
///   p = p_grid + sum_j B_j(p_grid) terms_j + sum_k Q_k(p_grid) higher_k + corners_p,
/// B_j of TargetBasis, Q_k of HigherBasis. All zero: flat and even, as target.yaml says. It holds
/// no similarity (translation, rotation, scale stay those of the grid). The last term is one of
/// recording and detector rather than of the board: how much wider the tags look [m], where their
/// edges span kTagEdgePx pixels. A detector errs by pixels, so that it is more on tags that look
/// smaller, by tagEdgeScale(). Nor are the remainders of single corners the board's: two recordings
/// of one board have different ones (docs/target_shape.md).
struct TargetShape {
  TargetTerms terms = TargetTerms::Zero();     ///< [m]
  std::optional<TargetCovariance> covariance;  ///< of terms [m^2]; none: taken as exact
  std::optional<HigherTerms> higher = {};      ///< [m]; none: all zero
  /// Standard deviations of `higher` [m], taken as independent; none: taken as exact.
  std::optional<HigherTerms> higher_std = {};
  /// What is left at the single corners [m]: x, y, z of corner 0, then of corner 1; none: zero.
  std::optional<Eigen::VectorXd> corners = {};

  bool isFlat() const { return terms.isZero(0) && !higher && !corners; }
  /// RMS displacement of the corners by the board's own terms (not tag_edge, not `corners`) [m].
  double rms() const;
  bool operator==(const TargetShape&) const = default;
};

/// How far each term moves each corner of a grid. With X, Y from the grid's centre over half its
/// diagonal, every displacement but the last has unit RMS over the corners, so that a term is the
/// RMS displacement [m] that it makes:
///   stretch (a X, -b Y) and shear (c Y, d X), without scale and rotation;
///   q_1 ~ X^2 - mean, q_2 ~ X Y - mean, q_3 ~ Y^2 - mean, along x, along y, and along z;
///   tag_edge: (+-1/2, +-1/2), the tag's edges by the term itself (where tagEdgeScale() is 1).
/// What a small grid cannot tell (no extent, as q_1 on a single tag) is zero.
class TargetBasis {
 public:
  /// The scalar functions of a corner that the terms are made of.
  enum Function { kStretchX, kStretchY, kShearX, kShearY, kQ1, kQ2, kQ3, kEdgeX, kEdgeY };
  static constexpr int kFunctions = kEdgeY + 1;
  using Functions = std::array<double, kFunctions>;

  explicit TargetBasis(const AprilGrid& grid);

  int cornerCount() const { return static_cast<int>(functions_.size()); }
  const Functions& functions(int corner_id) const {
    return functions_[static_cast<std::size_t>(corner_id)];
  }
  /// Columns B_j: the displacement of a corner [m] per term [m].
  Eigen::Matrix<double, 3, kTargetTerms> columns(int corner_id) const {
    return columns(functions(corner_id));
  }
  static Eigen::Matrix<double, 3, kTargetTerms> columns(const Functions& functions);
  /// Terms that move a corner at all.
  std::array<bool, kTargetTerms> observable() const;

 private:
  std::vector<Functions> functions_;
};

/// Polynomials of degrees 3 and 4 in X, Y over the corners of a grid:
///   X^3, X^2 Y, X Y^2, Y^3,  X^4, X^3 Y, X^2 Y^2, X Y^3, Y^4,
/// each less what those before it, and all of degrees 0 to 2, have of it, and of unit RMS, so that
/// a term along one axis is the RMS displacement [m] that it makes. Orthogonal over the corners to
/// every similarity and to the terms of TargetBasis but tag_edge, which is of degree 0 within a
/// tag. What a small grid cannot tell is zero.
class HigherBasis {
 public:
  using Functions = Eigen::Matrix<double, kHigherFunctions, 1>;

  explicit HigherBasis(const AprilGrid& grid);

  const Functions& functions(int corner_id) const {
    return functions_[static_cast<std::size_t>(corner_id)];
  }
  /// Displacement of a corner [m].
  Eigen::Vector3d displacement(int corner_id, const HigherTerms& terms) const;

 private:
  std::vector<Functions> functions_;
};

/// The terms that come closest to the given displacements of all corners [m], by least squares, a
/// small similarity besides (translation, rotation, scale) being free; with the higher terms where
/// the twelve leave more than rounding.
TargetShape fitTargetShape(const AprilGrid& grid, const std::vector<Eigen::Vector3d>& displacement);

}  // namespace plumbline

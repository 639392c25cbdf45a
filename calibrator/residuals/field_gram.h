// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {

/// A smooth displacement of a camera's image, which stands for what its model cannot describe: for
/// u and for v the functions sqrt((2i+1)(2j+1)) P_i(x) P_j(y), i + j <= 5, P_i Legendre's
/// polynomials, x and y in [-1, 1] over a box of the image, of mean square 1 px^2 there; and the
/// components dx r^6, dy r^6, dx r^8, dy r^8 of displacements along the radius from the principal
/// point, d that place over the box's half diagonal and r its length. Lens models take themselves
/// nearly all radial displacements of lower powers: these are what they miss of a wide lens.
inline constexpr int kFieldDegree = 5;
inline constexpr int kFieldPolynomials = (kFieldDegree + 1) * (kFieldDegree + 2) / 2;
inline constexpr int kFieldRadials = 2;                                        ///< r^7 and r^9
inline constexpr int kFieldFunctions = kFieldPolynomials + 2 * kFieldRadials;  ///< of a row
inline constexpr int kFieldColumns = 2 * kFieldFunctions;  ///< those of u, then those of v

/// Where the functions are spread; beyond it they keep their values at its edge, for polynomials
/// that nothing holds there would grow without bound.
struct FieldBox {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [px]
  Eigen::Vector2d half = Eigen::Vector2d::Ones();    ///< half its width and height, > 0 [px]
  Eigen::Vector2d axis = Eigen::Vector2d::Zero();    ///< the principal point [px]
};

/// The functions' values at a pixel: i ascending, for each i j ascending; then the components.
Eigen::Matrix<double, kFieldFunctions, 1> fieldFunctions(const FieldBox& box,
                                                         const Eigen::Vector2d& uv);

/// In which combinations of kFieldColumns columns a camera, camera after camera, the misfit is
/// looked for: each polynomial by itself, and per camera and power a displacement along the radius,
/// less the polynomials and powers before. Orthonormal over the boxes.
struct FieldBase {
  Eigen::MatrixXd polynomials, radials;
};
FieldBase fieldBase(std::span<const FieldBox> boxes);

/// ViewGram, with further columns F: for each corner [f^T 0; 0 f^T] of the functions f at the
/// measured pixel, or that times R, whose columns combine them:
///   H_pose_f = sum w J_pose^T F,  H_k_f = sum w J_k^T F.
/// Of the functions themselves, whatever R: b_f = sum w [f^T 0; 0 f^T]^T e, and H_f = sum w f f^T
/// of one row (it is the same for u and v, and nothing couples them).
struct FieldGram : ViewGram {
  Eigen::Matrix<double, 6, Eigen::Dynamic> H_pose_f;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic> H_k_f;
  Eigen::Matrix<double, kFieldFunctions, kFieldFunctions> H_f;
  Eigen::Matrix<double, kFieldColumns, 1> b_f;
};

/// What is done with the squares of the functions, and with what they take of the residuals: a view
/// that nobody has taken needs neither. Where they are dropped, H_pose_f and H_k_f are sums of
/// single precision, each row within 1e-6 of its length. What they change of a predicted error is
/// below 2e-4 of it from the fourth view on, where little is known more (5e-3 for the second and
/// third: view_terms_test.cpp).
enum class FieldSquares { kKeep, kDrop };

/// Corners weigh w^2 of the view (any weight here, 0 or more: its root is the column's factor),
/// times 1 / (1 + |e|^2 / c^2) where there is a loss; triggs_clamp does not matter, and `cost` is
/// squared_error, the loss left out. Without FieldSquares::kKeep H_f and b_f are zero.
/// `combinations`: R, kFieldColumns x K; empty: the functions by themselves. Vectorised as
/// viewGram() is, for the same models.
FieldGram fieldGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                    const FieldBox& box, FieldSquares squares, const GramOptions& options = {},
                    const Eigen::Ref<const Eigen::MatrixXd>& combinations = Eigen::MatrixXd(),
                    InstructionSet set = bestInstructionSet());

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrator/base/image.h"
#include "calibrator/target/corner_window.h"
#include "calibrator/target/division_distortion.h"

namespace plumbline {

/// The corner [px] as the crossing p of two blurred straight edges, fitted to the grey levels of
/// the window by weighted least squares (Gauss-Newton, from window.start) over p, the edges'
/// directions, the blur b, the mean level m, half the difference h of light and dark, the slope c
/// of the light, and g, by which light or dark grows along the edges:
///   I(q) = (m + h E(n1) E(n2) + g (E'(n1) + E'(n2))) (1 + c . (q - p)),
///   E(n) = erf(n . (q - p) / (sqrt(2) b)),
/// with n1, n2 the edges' normals and q the pixel straightened by `distortion`: a lens bends edges,
/// by hundredths of a pixel within a window. Unbiased where the surroundings are alike after half a
/// turn (blur, motion, printing that makes black grow) and for light that changes linearly.
/// Of CornerWindow the axes count as CornerRefiner takes them, each at most 9 px long; `start` lies
/// within some tenths of a pixel of the corner, as CornerRefiner leaves it. Nothing where the
/// levels do not determine p, the fit does not converge within 12 steps or moves by more than
/// window.max_shift_px, its residual says that something else lies in the window (a cover, glare),
/// the window has fewer than 20 pixels, `start` lies outside the image, or axes are not finite.
std::optional<Eigen::Vector2d> fitCorner(const GrayImageView& image, const CornerWindow& window,
                                         const DivisionDistortion& distortion);

}  // namespace plumbline

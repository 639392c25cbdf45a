// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/field_gram.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <variant>

#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/residuals/field_kernel.h"

namespace plumbline {
namespace {

// Only these functions carry the instruction set.
#if defined(__x86_64__)
template <class Model, bool kRobust>
PLUMBLINE_AVX2 void computeAvx2(const gram::Input& in, const fields::FieldInput& f,
                                FieldGram& out) {
  fields::compute<4, Model, kRobust>(in, f, out);
}
#endif

template <class Model, bool kRobust>
void computeWith(InstructionSet set, const gram::Input& in, const fields::FieldInput& f,
                 FieldGram& out) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx2) return computeAvx2<Model, kRobust>(in, f, out);
#endif
  fields::compute<2, Model, kRobust>(in, f, out);
}

/// Corner by corner, for models that the kernel is not compiled for.
class PlainSum {
 public:
  PlainSum(const Intrinsics& camera, FieldGram& out) : out_(out) {
    const auto K = camera.projection.size() + camera.distortion.size();
    out.H_pose_k.setZero(6, K);
    out.H_k.setZero(K, K);
    out.b_k.setZero(K);
    out.H_pose_f.setZero(6, kFieldColumns);
    out.H_k_f.setZero(K, kFieldColumns);
    out.H_f.setZero();
    out.b_f.setZero();
  }

  /// A corner at p in the camera's frame, with its weight, the loss included.
  void add(const Projection& at, const Eigen::Vector3d& p, const Eigen::Vector2d& e, double weight,
           const Eigen::Matrix<double, kFieldFunctions, 1>& f) {
    Eigen::Matrix<double, 2, 6> J;
    // Of the twist p' = p + rho + phi x p.
    J << at.J_point, -at.J_point * skew(p);
    const Eigen::MatrixXd J_k = at.J_intrinsics;
    out_.H += weight * J.transpose() * J;
    out_.b += weight * J.transpose() * e;
    out_.H_pose_k += weight * J.transpose() * J_k;
    out_.H_k += weight * J_k.transpose() * J_k;
    out_.b_k += weight * J_k.transpose() * e;
    for (int row = 0; row < 2; ++row) {
      const int first = row * kFieldFunctions;
      out_.H_pose_f.middleCols<kFieldFunctions>(first) +=
          weight * J.row(row).transpose() * f.transpose();
      out_.H_k_f.middleCols<kFieldFunctions>(first) +=
          weight * J_k.row(row).transpose() * f.transpose();
      out_.b_f.segment<kFieldFunctions>(first) += weight * e[row] * f;
    }
  }

 private:
  FieldGram& out_;
};

FieldGram plainFieldGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                         const fields::FieldInput& input, const GramOptions& options,
                         const Eigen::Ref<const Eigen::MatrixXd>& R) {
  FieldGram out;
  PlainSum sum(camera, out);
  for (int i = 0; i < view.count; ++i) {
    // A view's weight multiplies residuals: squares get its square. (Roots of the cells' weights
    // come in so.)
    const double w2 = view.w[i] * view.w[i];
    if (!(w2 > 0)) continue;
    const Eigen::Vector3d p = T_CF * Eigen::Vector3d(view.x[i], view.y[i], view.z[i]);
    const Eigen::Vector2d uv(view.u[i], view.v[i]);
    const auto at = projectBeyondFold(camera, p);
    const double squared = at ? (at->uv - uv).squaredNorm() : kInvalidSquaredError;
    out.squared_error += w2 * std::min(squared, kInvalidSquaredError);
    if (!(squared < kInvalidSquaredError)) continue;
    // Re-weighted least squares: rho' of rho(s) = c^2 log(1 + s / c^2), a scalar for both rows.
    const double c2 = options.cauchy_px * options.cauchy_px;
    const double weight = c2 > 0 ? w2 / (1 + squared / c2) : w2;
    const auto f = fieldFunctions(input.box, uv);
    sum.add(*at, p, at->uv - uv, weight, f);
    if (input.squares) out.H_f += weight * f * f.transpose();
  }
  out.cost = out.squared_error;
  if (!input.squares) out.b_f.setZero();
  if (R.size() > 0) {
    // Combined once for the view, not corner by corner: J^T F R, with F R never formed.
    out.H_pose_f = (out.H_pose_f * R).eval();
    out.H_k_f = (out.H_k_f * R).eval();
  }
  return out;
}

/// Mean products of a row's functions over the box, by midpoints: they only orthonormalise.
Eigen::MatrixXd meanProducts(const FieldBox& box) {
  constexpr int kSide = 30;
  Eigen::MatrixXd values(kFieldFunctions, kSide * kSide);
  for (int k = 0; k < kSide * kSide; ++k) {
    const Eigen::Array2d cell(k / kSide, k % kSide);
    const Eigen::Array2d place = (2 * cell + 1) / kSide - 1;
    values.col(k) = fieldFunctions(box, box.centre + (box.half.array() * place).matrix());
  }
  return values * values.transpose() / (kSide * kSide);
}

/// A camera's columns of FieldBase: its polynomials, then its displacements along the radius.
Eigen::MatrixXd baseOf(const FieldBox& box) {
  constexpr int kPolynomials = 2 * kFieldPolynomials;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(kFieldColumns, kFieldColumns);
  Eigen::MatrixXd base = Eigen::MatrixXd::Zero(kFieldColumns, kPolynomials + kFieldRadials);
  for (int row = 0; row < 2; ++row) {
    const int first = row * kFieldFunctions;
    mean.block(first, first, kFieldFunctions, kFieldFunctions) = meanProducts(box);
    base.block(first, row * kFieldPolynomials, kFieldPolynomials, kFieldPolynomials).setIdentity();
  }
  for (int k = 0; k < kFieldRadials; ++k) {
    Eigen::VectorXd along = Eigen::VectorXd::Zero(kFieldColumns);
    along[kFieldPolynomials + 2 * k] = 1;
    along[kFieldFunctions + kFieldPolynomials + 2 * k + 1] = 1;
    const Eigen::MatrixXd before = base.leftCols(kPolynomials + k);
    const Eigen::MatrixXd weighted = before.transpose() * mean;
    along -= before * SymmetricFactor(weighted * before).solve(weighted * along);
    base.col(kPolynomials + k) = along / std::sqrt(along.dot(mean * along));
  }
  return base;
}

}  // namespace

FieldBase fieldBase(std::span<const FieldBox> boxes) {
  constexpr int kPolynomials = 2 * kFieldPolynomials;
  const auto cameras = static_cast<Eigen::Index>(boxes.size());
  FieldBase out{Eigen::MatrixXd::Zero(cameras * kFieldColumns, cameras * kPolynomials),
                Eigen::MatrixXd::Zero(cameras * kFieldColumns, cameras * kFieldRadials)};
  for (Eigen::Index c = 0; c < cameras; ++c) {
    const Eigen::MatrixXd base = baseOf(boxes[c]);
    out.polynomials.block(c * kFieldColumns, c * kPolynomials, kFieldColumns, kPolynomials) =
        base.leftCols(kPolynomials);
    out.radials.block(c * kFieldColumns, c * kFieldRadials, kFieldColumns, kFieldRadials) =
        base.rightCols(kFieldRadials);
  }
  return out;
}

Eigen::Matrix<double, kFieldFunctions, 1> fieldFunctions(const FieldBox& box,
                                                         const Eigen::Vector2d& uv) {
  Eigen::Matrix<double, kFieldFunctions, 1> f;
  const auto x = fields::clampedPlace<2>(Lanes<2>{uv[0], uv[0]}, box.centre[0], box.half[0]);
  const auto y = fields::clampedPlace<2>(Lanes<2>{uv[1], uv[1]}, box.centre[1], box.half[1]);
  fields::eachFunction<2, double>(box, x, y,
                                  [&](int number, const Lanes<2>& value) { f[number] = value[0]; });
  return f;
}

FieldGram fieldGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                    const FieldBox& box, FieldSquares squares, const GramOptions& options,
                    const Eigen::Ref<const Eigen::MatrixXd>& combinations, InstructionSet set) {
  assert(isAvailable(set));
  const bool combined = combinations.size() > 0;
  assert(box.half.minCoeff() > 0);
  assert(!combined || combinations.rows() == kFieldColumns);
  FieldGram out;
  const gram::Input in = gram::viewInput(camera, T_CF, view, options);
  fields::FieldInput f{box, squares == FieldSquares::kKeep, {}};
  if (combined) {
    f.combinations = {combinations.data(), combinations.outerStride(), combinations.cols()};
  }
  std::visit(
      [&]<class Model>(Model) {
        if constexpr (kIsVectorised<Model>) {
          options.cauchy_px > 0 ? computeWith<Model, true>(set, in, f, out)
                                : computeWith<Model, false>(set, in, f, out);
        } else {
          out = plainFieldGram(camera, T_CF, view, f, options, combinations);
        }
      },
      cameraModelOf(camera));
  return out;
}

}  // namespace plumbline

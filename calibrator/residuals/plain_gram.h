// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to view_gram.cpp: a view's Gram terms for any camera model: corners are projected in
// plain arithmetic, one by one, their products summed as in the vectorised kernel, which is
// compiled for the models that are calibrated most. Slower than it by 2 or so; the same definitions
// (view_gram.h), and equal to it up to rounding.

#include <algorithm>
#include <cmath>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/gram_columns.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline::plain {

/// What is summed over: a camera, its pose, corners and their weighting.
struct View {
  InstructionSet set;
  const Intrinsics& camera;
  const Transform& T_CF;
  const PackedView& corners;
  const GramOptions& options;
  const TargetColumns* target = nullptr;  ///< of the corners, where the board is estimated
};

// Of the kernel (gram_kernel.h): poses that a step throws so far off are charged, not projected.
inline constexpr double kFarthest = 1e9;  // [m]

/// The loss at one corner: its cost rho(|e|^2), slope rho', and the 2x2 weight of its squares
/// M = rho' (I - beta n n^T) (see GramOptions).
struct Weighted {
  double cost = 0;
  double slope = 1;
  Eigen::Matrix2d M = Eigen::Matrix2d::Identity();

  Weighted(const Eigen::Vector2d& e, const GramOptions& options) {
    const double e2 = e.squaredNorm();
    cost = e2;
    if (options.cauchy_px == 0) return;
    const double c2 = options.cauchy_px * options.cauchy_px;
    cost = c2 * std::log1p(e2 / c2);
    slope = 1 / (1 + e2 / c2);
    // beta over |e|^2, so that no direction is needed where e vanishes.
    const double beta = std::min(2 * slope / c2, options.triggs_clamp / (e2 + 1e-30));
    M = slope * (M - beta * e * e.transpose());
  }
};

/// One corner's error and derivatives; what cannot be projected has none. Columns: rho, phi,
/// intrinsics in the order of stacked(), and the board's terms, which the caller fills in.
template <class Model, bool kIntrinsics, bool kTarget>
struct CornerTerms {
  static constexpr int kLens = 6 + (kIntrinsics ? 4 + Model::kShape : 0);
  static constexpr int kColumns = kLens + (kTarget ? kTargetTerms : 0);
  bool valid = false;
  Eigen::Vector2d e = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, kColumns> J;
  Eigen::Matrix<double, 2, 3> J_point;

  CornerTerms(const CameraValues& lens, const Eigen::Vector3d& p, const Eigen::Vector2d& uv) {
    if (!Model::isProjectable(lens.k.data(), p.x(), p.y(), p.z())) return;
    // Coordinates that are no numbers fail this too, and are charged.
    if (!(p.squaredNorm() < kFarthest * kFarthest)) return;
    const auto m = Model::image(lens.k.data(), p.x(), p.y(), p.z());
    e << lens.fu * m.x + lens.pu - uv.x(), lens.fv * m.y + lens.pv - uv.y();
    valid = e.squaredNorm() < kInvalidSquaredError;
    for (int i = 0; i < 3; ++i) {
      J_point.col(i) << lens.fu * m.J_point[0][i], lens.fv * m.J_point[1][i];
    }
    J.template leftCols<3>() = J_point;
    J.template middleCols<3>(3) = -J_point * skew(p);
    if constexpr (kIntrinsics) {
      // Of (fu, fv, pu, pv), with the row u before the row v.
      J.template middleCols<4>(6 + Model::kLeading) << m.x, 0, 1, 0, 0, m.y, 0, 1;
      for (int i = 0; i < Model::kShape; ++i) {
        J.col(6 + shapeColumn<Model>(i)) << lens.fu * m.J_k[0][i], lens.fv * m.J_k[1][i];
      }
    }
  }
};

template <int N>
struct Sums {
  Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> b = Eigen::Matrix<double, N, 1>::Zero();
  double squared_error = 0;
  double cost = 0;
};

/// Corners in columns, as the kernel sums them: J to the left; M J, and rho' e behind it, to the
/// right.
template <int N>
struct Chunk {
  alignas(64) double left[N * gram::kStride];
  alignas(64) double right[(N + 1) * gram::kStride];
  int count = 0;

  bool full() const { return count == gram::kChunk; }

  void add(const Eigen::Matrix<double, 2, N>& J, const Weighted& w, const Eigen::Vector2d& e) {
    for (int i = 0; i < N; ++i) {
      put(left, i, J.col(i));
      put(right, i, w.M * J.col(i));
    }
    put(right, N, w.slope * e);
    ++count;
  }

  /// Up to whole lanes of the widest kernel (4), with corners that add nothing.
  void fillUp() {
    while (count % 4 != 0) {
      for (int i = 0; i < N; ++i) {
        put(left, i, Eigen::Vector2d::Zero());
        put(right, i, Eigen::Vector2d::Zero());
      }
      put(right, N, Eigen::Vector2d::Zero());
      ++count;
    }
  }

 private:
  void put(double* columns, int i, const Eigen::Vector2d& rows) const {
    columns[i * gram::kStride + count] = rows[0];
    columns[i * gram::kStride + gram::kChunk + count] = rows[1];
  }
};

/// Rows u, then rows v, into one sum: their coupling is in M J already.
template <int W, int N>
void addChunk(const Chunk<N>& c, Sums<N>& sums) {
  Lanes<W> products[N][N + 1] = {};
  for (int half : {0, gram::kChunk}) {
    gram::Products<W>::template upper<N>(c.left + half, c.right + half, c.count, &products[0][0]);
  }
  double totals[N][N + 1];
  gram::Products<W>::total(&products[0][0], N * (N + 1), &totals[0][0]);
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      sums.H(i, j) += totals[i][j];
      sums.H(j, i) = sums.H(i, j);
    }
    sums.b(i) += totals[i][N];
  }
}

template <int N>
void flush(InstructionSet set, Chunk<N>& c, Sums<N>& sums) {
  c.fillUp();
  set == InstructionSet::kAvx2 ? addChunk<4, N>(c, sums) : addChunk<2, N>(c, sums);
  c.count = 0;
}

/// The columns B_j of the j-th corner.
inline Eigen::Matrix<double, 3, kTargetTerms> targetColumns(const TargetColumns& target, int j) {
  TargetBasis::Functions f{};
  for (std::size_t i = 0; i < f.size(); ++i) f[i] = target.function[i][j];
  return TargetBasis::columns(f);
}

/// H = sum J' M J and b = sum rho' J' e over the corners with weight; those that cannot be
/// projected are charged and have no derivative.
template <class Model, bool kIntrinsics, bool kTarget = false>
auto sumView(const View& view) {
  using C = CornerTerms<Model, kIntrinsics, kTarget>;
  Sums<C::kColumns> sums;
  Chunk<C::kColumns> chunk;
  const CameraValues lens(view.camera);
  const PackedView& v = view.corners;
  for (int j = 0; j < v.count; ++j) {
    if (!(v.w[j] > 0)) continue;
    const Eigen::Vector3d p = view.T_CF * Eigen::Vector3d(v.x[j], v.y[j], v.z[j]);
    C corner(lens, p, {v.u[j], v.v[j]});
    if (!corner.valid) {
      sums.squared_error += kInvalidSquaredError;
      sums.cost += kInvalidSquaredError;
      continue;
    }
    if constexpr (kTarget) {
      corner.J.template rightCols<kTargetTerms>().noalias() =
          (corner.J_point * view.T_CF.R).lazyProduct(targetColumns(*view.target, j));
    }
    const Weighted w(corner.e, view.options);
    chunk.add(corner.J, w, corner.e);
    if (chunk.full()) flush(view.set, chunk, sums);
    sums.squared_error += corner.e.squaredNorm();
    sums.cost += w.cost;
  }
  flush(view.set, chunk, sums);
  return sums;
}

template <int N>
void writePose(const Sums<N>& sums, PoseGram& out) {
  out.H = sums.H.template topLeftCorner<6, 6>();
  out.b = sums.b.template head<6>();
  out.squared_error = sums.squared_error;
  out.cost = sums.cost;
}

/// As the kernel's versions in view_gram.cpp.
template <class Model>
struct Version {
  static constexpr int K = 4 + Model::kShape;

  static void pose(const View& in, PoseGram& out) { writePose(sumView<Model, false>(in), out); }
  static void view(const View& in, ViewGram& out) { writeView(sumView<Model, true>(in), out); }
  static void target(const View& in, TargetViewGram& out) {
    const auto sums = sumView<Model, true, true>(in);
    writeView(sums, out);
    out.H_pose_s = sums.H.template topRightCorner<6, kTargetTerms>();
    out.H_k_s = sums.H.template block<K, kTargetTerms>(6, 6 + K);
    out.H_s = sums.H.template bottomRightCorner<kTargetTerms, kTargetTerms>();
    out.b_s = sums.b.template tail<kTargetTerms>();
  }
  static double cost(const View& in) { return sumView<Model, false>(in).cost; }

 private:
  template <int N>
  static void writeView(const Sums<N>& sums, ViewGram& out) {
    writePose(sums, out);
    out.H_pose_k = sums.H.template block<6, K>(0, 6);
    out.H_k = sums.H.template block<K, K>(6, 6);
    out.b_k = sums.b.template segment<K>(6);
  }
};

}  // namespace plumbline::plain

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to view_gram.cpp and field_gram.cpp: one view's Gram matrix with W lanes. What projects
// is always_inline, so that the function into which it is inlined decides on the instruction set,
// and no symbol compiled for a richer set can stand in for one that is not. Products of columns,
// and what is done once a view, are functions for all models (Products, Totals).

#include <cmath>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera_model.h"
#include "calibrator/residuals/gram_columns.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline::gram {

/// What the kernel reads, as plain numbers.
struct Input {
  Transform T_CF;
  double fu, fv, pu, pv;
  const double* k;  ///< shape coefficients of the model
  PackedView view;
  const TargetColumns* target = nullptr;  ///< of the view's corners, where the board is estimated
  double inverse_c2 = 0;                  ///< 1/c^2 of the loss [1/px^2]
  double triggs_clamp = 0;
};

/// Of a view under a camera and a loss, without board and clamp.
[[gnu::always_inline]] inline Input viewInput(const Intrinsics& camera, const Transform& T_CF,
                                              const PackedView& view, const GramOptions& options) {
  Input in;
  in.T_CF = T_CF;
  // Models of the kernel are pinholes: no coefficient stands before fu.
  in.fu = camera.projection[0];
  in.fv = camera.projection[1];
  in.pu = camera.projection[2];
  in.pv = camera.projection[3];
  in.k = camera.distortion.data();
  in.view = view;
  if (options.cauchy_px > 0) in.inverse_c2 = 1 / (options.cauchy_px * options.cauchy_px);
  return in;
}

/// Columns of the Gram matrix. S shared ones (pose, shape) come first; then the error e; then, of
/// each row's own, the image-plane coordinate m (derivative in focal length) and 1 (in principal
/// point). The right factor has two more for the u-v coupling that a robust weight brings.
enum Own { kError = 0, kPlane = 1, kOne = 2, kCrossPlane = 3, kCrossOne = 4, kOwn = 5 };

/// Sums of the rows' own columns, where intrinsics are asked for.
template <int W, int S, bool kIntrinsics>
struct OwnSums {
  Lanes<W> own[2][2][S + 3] = {};  ///< per row: (m, 1) x (shared, e, m, 1)
  Lanes<W> cross[2][2] = {};       ///< (m_u, 1) x (m_v, 1)
};
template <int W, int S>
struct OwnSums<W, S, false> {};

/// What the kernel sums, before the lanes are added up.
template <int W, int S, bool kIntrinsics = true>
struct Sums : OwnSums<W, S, kIntrinsics> {
  Lanes<W> shared[S][S + 1] = {};  ///< shared x (shared, e), both rows
  Lanes<W> squared = {};
  double cost = 0;
};

/// The sums, with the lanes added up; without intrinsics `own` and `cross` are not written.
template <int S>
struct Totals {
  double shared[S][S + 1];
  double own[2][2][S + 3];
  double cross[2][2];
  double squared;
  double cost;
};

template <int W, int S, bool kIntrinsics>
[[gnu::always_inline]] inline Totals<S> totalsOf(const Sums<W, S, kIntrinsics>& sums) {
  Totals<S> out;
  Products<W>::total(&sums.shared[0][0], S * (S + 1), &out.shared[0][0]);
  if constexpr (kIntrinsics) {
    Products<W>::total(&sums.own[0][0][0], 2 * 2 * (S + 3), &out.own[0][0][0]);
    Products<W>::total(&sums.cross[0][0], 2 * 2, &out.cross[0][0]);
  }
  out.squared = sumOf<W>(sums.squared);
  out.cost = sums.cost;
  return out;
}

/// The corners of one SIMD group, projected.
template <int W, class Model>
struct Group {
  Lanes<W> X, Y, Z, w, e_u, e_v, squared;
  PlanePoint<Lanes<W>, Model::kShape> m;
};

/// Projects W corners from position j; lanes that cannot be projected get weight 0, and `invalid`
/// their squared weight, which is charged with kInvalidSquaredError.
template <int W, class Model>
[[gnu::always_inline]] inline Group<W, Model> projectGroup(const Input& in, int j,
                                                           Lanes<W>& invalid) {
  using V = Lanes<W>;
  constexpr double kNearest = 1e-9;  // [m]
  constexpr double kFarthest = 1e9;  // [m]
  const auto& R = in.T_CF.R;
  const auto& t = in.T_CF.t;
  const V x = load<W>(in.view.x + j);
  const V y = load<W>(in.view.y + j);
  const V z = load<W>(in.view.z + j);
  const V X = R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + t[0];
  const V Y = R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + t[1];
  const V Z = R(2, 0) * x + R(2, 1) * y + R(2, 2) * z + t[2];
  const auto ahead = (Z > kNearest) & (X * X + Y * Y + Z * Z < kFarthest * kFarthest);
  const V zero = {};
  Group<W, Model> g;
  g.X = ahead ? X : zero;
  g.Y = ahead ? Y : zero;
  g.Z = ahead ? Z : zero + 1.0;
  g.m = Model::image(in.k, g.X, g.Y, g.Z);
  const V e_u = in.fu * g.m.x + (in.pu - load<W>(in.view.u + j));
  const V e_v = in.fv * g.m.y + (in.pv - load<W>(in.view.v + j));
  const V squared = e_u * e_u + e_v * e_v;
  const auto valid = ahead & (squared < kInvalidSquaredError);
  const V w = load<W>(in.view.w + j);
  g.w = valid ? w : zero;
  g.e_u = valid ? e_u : zero;
  g.e_v = valid ? e_v : zero;
  g.squared = valid ? w * squared : zero;
  invalid += valid ? zero : w * w;
  return g;
}

/// How many columns are shared by both rows: the pose's, the lens' shape, the board's terms.
template <class Model, bool kIntrinsics, bool kTarget>
inline constexpr int kShared = 6 + (kIntrinsics ? Model::kShape : 0) + (kTarget ? kTargetTerms : 0);

/// d(row)/d(terms of the board): the derivatives d by the corner's place in F, times B_j.
template <int W>
[[gnu::always_inline]] inline void targetRow(const Input& in, int j, const Lanes<W> (&d)[3],
                                             Lanes<W>* J) {
  using B = TargetBasis;
  Lanes<W> f[B::kFunctions];
#pragma GCC unroll 9
  for (int i = 0; i < B::kFunctions; ++i) f[i] = load<W>(in.target->function[i] + j);
  J[0] = d[0] * f[B::kStretchX] + d[1] * f[B::kStretchY];
  J[1] = d[0] * f[B::kShearX] + d[1] * f[B::kShearY];
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
#pragma GCC unroll 3
    for (int q = 0; q < 3; ++q) J[2 + 3 * axis + q] = d[axis] * f[B::kQ1 + q];
  }
  J[11] = d[0] * f[B::kEdgeX] + d[1] * f[B::kEdgeY];
}

/// d(row)/d(pose, shape, terms): columns rho (3), phi (3) = p x d/dp, shape of the lens, terms of
/// the board; of the corners from position j.
template <int W, int S, bool kTarget, class Model>
[[gnu::always_inline]] inline void sharedRow(const Input& in, const Group<W, Model>& g, int j,
                                             int row, const Lanes<W>& focal, Lanes<W> (&J)[S]) {
  constexpr int kEnd = kTarget ? S - kTargetTerms : S;
  const Lanes<W> a = focal * g.m.J_point[row][0];
  const Lanes<W> b = focal * g.m.J_point[row][1];
  const Lanes<W> c = focal * g.m.J_point[row][2];
  J[0] = a;
  J[1] = b;
  J[2] = c;
  J[3] = g.Y * c - g.Z * b;
  J[4] = g.Z * a - g.X * c;
  J[5] = g.X * b - g.Y * a;
#pragma GCC unroll 12
  for (int i = 6; i < kEnd; ++i) J[i] = focal * g.m.J_k[row][i - 6];
  if constexpr (kTarget) {
    const auto& R = in.T_CF.R;
    Lanes<W> d[3];
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) d[axis] = a * R(0, axis) + b * R(1, axis) + c * R(2, axis);
    targetRow<W>(in, j, d, J + kEnd);
  }
}

/// Squared error: the columns of one group. Weights are 0 or 1, so one factor holds them.
template <int W, int S, bool kIntrinsics, bool kTarget, class Model>
[[gnu::always_inline]] inline void fillPlain(const Input& in, const Group<W, Model>& g, int j,
                                             double* left) {
  Lanes<W> J[S];
  sharedRow<W, S, kTarget>(in, g, j, 0, g.w * in.fu, J);
#pragma GCC unroll 32
  for (int i = 0; i < S; ++i) store<W>(left + i * kStride, J[i]);
  sharedRow<W, S, kTarget>(in, g, j, 1, g.w * in.fv, J);
#pragma GCC unroll 32
  for (int i = 0; i < S; ++i) store<W>(left + i * kStride + kChunk, J[i]);
  double* own = left + S * kStride;
  store<W>(own, g.w * g.e_u);
  store<W>(own + kChunk, g.w * g.e_v);
  if constexpr (kIntrinsics) {
    store<W>(own + kPlane * kStride, g.w * g.m.x);
    store<W>(own + kPlane * kStride + kChunk, g.w * g.m.y);
    store<W>(own + kOne * kStride, g.w);
    store<W>(own + kOne * kStride + kChunk, g.w);
  }
}

/// The 2x2 weight of a corner under the Cauchy loss: M = rho' (I - beta n n^T) (see GramOptions).
template <int W>
struct RobustWeight {
  Lanes<W> slope, uu, uv, vv;

  [[gnu::always_inline]] inline RobustWeight(const Input& in, const Lanes<W>& w,
                                             const Lanes<W>& e_u, const Lanes<W>& e_v) {
    const Lanes<W> e2 = e_u * e_u + e_v * e_v + 1e-30;
    const Lanes<W> falling = 1.0 / (1.0 + e2 * in.inverse_c2);
    const Lanes<W> full = 2.0 * in.inverse_c2 * falling;
    const Lanes<W> clamped = in.triggs_clamp / e2;
    const Lanes<W> beta = full < clamped ? full : clamped;  // over |e|^2
    slope = w * falling;
    uu = slope * (1.0 - beta * e_u * e_u);
    uv = -slope * beta * e_u * e_v;
    vv = slope * (1.0 - beta * e_v * e_v);
  }
};

/// Robust: left factor J, right factor M J (and rho' e).
template <int W, int S, bool kIntrinsics, bool kTarget, class Model>
[[gnu::always_inline]] inline void fillRobust(const Input& in, const Group<W, Model>& g, int j,
                                              double* left, double* right) {
  const Lanes<W> zero = {};
  const RobustWeight<W> M(in, g.w, g.e_u, g.e_v);
  Lanes<W> J_u[S];
  Lanes<W> J_v[S];
  sharedRow<W, S, kTarget>(in, g, j, 0, zero + in.fu, J_u);
  sharedRow<W, S, kTarget>(in, g, j, 1, zero + in.fv, J_v);
#pragma GCC unroll 32
  for (int i = 0; i < S; ++i) {
    store<W>(left + i * kStride, J_u[i]);
    store<W>(left + i * kStride + kChunk, J_v[i]);
    store<W>(right + i * kStride, M.uu * J_u[i] + M.uv * J_v[i]);
    store<W>(right + i * kStride + kChunk, M.uv * J_u[i] + M.vv * J_v[i]);
  }
  double* own = right + S * kStride;
  store<W>(own, M.slope * g.e_u);
  store<W>(own + kChunk, M.slope * g.e_v);
  if constexpr (kIntrinsics) {
    double* own_left = left + S * kStride;
    store<W>(own_left + kPlane * kStride, g.m.x);
    store<W>(own_left + kPlane * kStride + kChunk, g.m.y);
    store<W>(own_left + kOne * kStride, zero + 1.0);
    store<W>(own_left + kOne * kStride + kChunk, zero + 1.0);
    store<W>(own + kPlane * kStride, M.uu * g.m.x);
    store<W>(own + kPlane * kStride + kChunk, M.vv * g.m.y);
    store<W>(own + kOne * kStride, M.uu);
    store<W>(own + kOne * kStride + kChunk, M.vv);
    store<W>(own + kCrossPlane * kStride, M.uv * g.m.y);
    store<W>(own + kCrossOne * kStride, M.uv);
  }
}

/// Sums log(1 + s) over many corners with few logarithms: factors are multiplied up first.
template <int W>
struct LogSum {
  Lanes<W> product = Lanes<W>{} + 1.0;
  int factors = 0;
  double sum = 0;

  /// Each factor lies in [1, 1e17]: eight of them stay finite.
  [[gnu::always_inline]] inline void add(const Lanes<W>& factor) {
    product *= factor;
    if (++factors == 8) flush();
  }
  [[gnu::always_inline]] inline void flush() {
    double all = 1;
    for (int i = 0; i < W; ++i) all *= product[i];
    if (all < 1e300) {
      sum += std::log(all);
    } else {
      for (int i = 0; i < W; ++i) sum += std::log(product[i]);
    }
    product = Lanes<W>{} + 1.0;
    factors = 0;
  }
};

/// Gram sums of a whole view.
template <int W, class Model, bool kIntrinsics, bool kRobust, bool kTarget = false>
[[gnu::always_inline]] inline auto sumView(const Input& in) {
  constexpr int S = kShared<Model, kIntrinsics, kTarget>;
  constexpr int kColumnsLeft = S + (kIntrinsics ? 3 : 1);
  alignas(64) double left[kColumnsLeft * kStride];
  alignas(64) double right_robust[kRobust ? (S + kOwn) * kStride : 1];
  double* right = kRobust ? right_robust : left;
  Sums<W, S, kIntrinsics> sums;
  Lanes<W> invalid = {};
  LogSum<W> logs;
  for (int first = 0; first < in.view.padded; first += kChunk) {
    const int rest = in.view.padded - first;
    const int n = rest < kChunk ? rest : kChunk;
    for (int j = 0; j < n; j += W) {
      const auto g = projectGroup<W, Model>(in, first + j, invalid);
      sums.squared += g.squared;
      if constexpr (kRobust) {
        fillRobust<W, S, kIntrinsics, kTarget>(in, g, first + j, left + j, right + j);
        logs.add(1.0 + g.squared * in.inverse_c2);
      } else {
        fillPlain<W, S, kIntrinsics, kTarget>(in, g, first + j, left + j);
      }
    }
    for (int row = 0; row < 2; ++row) {
      const int half = row * kChunk;
      Products<W>::template upper<S>(left + half, right + half, n, &sums.shared[0][0]);
      if constexpr (kIntrinsics) {
        Products<W>::template strip<2, S + 3>(left + (S + kPlane) * kStride + half, right + half, n,
                                              &sums.own[row][0][0], S + 3);
      }
    }
    if constexpr (kIntrinsics && kRobust) {
      addTile<W, 2, 2>(left + (S + kPlane) * kStride, right + (S + kCrossPlane) * kStride, n,
                       &sums.cross[0][0], 2);
    }
  }
  logs.flush();
  const double charged = kInvalidSquaredError * sumOf<W>(invalid);
  sums.cost = charged + (kRobust ? logs.sum / in.inverse_c2 : sumOf<W>(sums.squared));
  sums.squared[0] += charged;
  return sums;
}

/// Cost of a whole view, without derivatives.
template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline double costOfView(const Input& in) {
  Lanes<W> invalid = {};
  Lanes<W> squared = {};
  LogSum<W> logs;
  for (int j = 0; j < in.view.padded; j += W) {
    const auto g = projectGroup<W, Model>(in, j, invalid);
    squared += g.squared;
    if constexpr (kRobust) logs.add(1.0 + g.squared * in.inverse_c2);
  }
  logs.flush();
  return kInvalidSquaredError * sumOf<W>(invalid) +
         (kRobust ? logs.sum / in.inverse_c2 : sumOf<W>(squared));
}

/// Pose terms of the sums.
template <int S>
void writePose(const Totals<S>& sums, PoseGram& out) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) out.H(i, j) = out.H(j, i) = sums.shared[i][j];
    out.b[i] = sums.shared[i][S];
  }
  out.squared_error = sums.squared;
  out.cost = sums.cost;
}

/// Intrinsics' terms of the sums; order fu fv pu pv, shape.
template <int kShape, int S>
void writeIntrinsics(const Totals<S>& sums, ViewGram& out) {
  out.H_pose_k.resize(6, 4 + kShape);
  out.H_k.resize(4 + kShape, 4 + kShape);
  out.b_k.resize(4 + kShape);
  for (int own = 0; own < 2; ++own) {    // m, then 1
    for (int row = 0; row < 2; ++row) {  // u, then v
      const auto& sum = sums.own[row][own];
      const int k = 2 * own + row;
      for (int i = 0; i < 6; ++i) out.H_pose_k(i, k) = sum[i];
      for (int i = 0; i < kShape; ++i) out.H_k(k, 4 + i) = out.H_k(4 + i, k) = sum[6 + i];
      out.b_k[k] = sum[S + kError];
      out.H_k(k, row) = out.H_k(row, k) = sum[S + kPlane];
      out.H_k(k, 2 + row) = out.H_k(2 + row, k) = sum[S + kOne];
    }
  }
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      out.H_k(2 * a, 2 * b + 1) = out.H_k(2 * b + 1, 2 * a) = sums.cross[a][b];
    }
  }
  for (int i = 0; i < kShape; ++i) {
    for (int j = 0; j < 6; ++j) out.H_pose_k(j, 4 + i) = sums.shared[j][6 + i];
    for (int j = i; j < kShape; ++j) {
      out.H_k(4 + i, 4 + j) = out.H_k(4 + j, 4 + i) = sums.shared[6 + i][6 + j];
    }
    out.b_k[4 + i] = sums.shared[6 + i][S];
  }
}

/// The board's terms of the sums, which are the last of the shared columns.
template <int kShape, int S>
void writeTarget(const Totals<S>& sums, TargetViewGram& out) {
  constexpr int kFirst = 6 + kShape;
  out.H_k_s.resize(4 + kShape, kTargetTerms);
  for (int i = 0; i < kTargetTerms; ++i) {
    const int column = kFirst + i;
    for (int j = 0; j < 6; ++j) out.H_pose_s(j, i) = sums.shared[j][column];
    for (int k = 0; k < 4; ++k) out.H_k_s(k, i) = sums.own[k % 2][k / 2][column];
    for (int k = 0; k < kShape; ++k) out.H_k_s(4 + k, i) = sums.shared[6 + k][column];
    for (int j = i; j < kTargetTerms; ++j) {
      out.H_s(i, j) = out.H_s(j, i) = sums.shared[column][kFirst + j];
    }
    out.b_s[i] = sums.shared[column][S];
  }
}

}  // namespace plumbline::gram

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/field_gram.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <variant>

#include "calibrator/base/lie.h"
#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/gram_kernel.h"
#include "calibrator/residuals/instruction_set.h"

namespace plumbline {
namespace {

/// What the kernel reads besides gram::Input.
struct FieldInput {
  FieldBox box;
  bool squares = false;
};

/// (pixel - centre) / half, held to [-1, 1].
template <int W>
[[gnu::always_inline]] inline Lanes<W> clampedPlace(const Lanes<W>& pixel, double centre,
                                                    double half) {
  const Lanes<W> one = Lanes<W>{} + 1.0;
  const Lanes<W> x = (pixel - centre) / half;
  const Lanes<W> low = x < -one ? -one : x;
  return low > one ? one : low;
}

/// sqrt(2i+1) P_i(x) by the recurrence (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}.
template <int W>
[[gnu::always_inline]] inline void legendre(const Lanes<W>& x, Lanes<W> (&P)[kFieldDegree + 1]) {
  constexpr double kNorm[] = {1,   1.7320508075688772, 2.2360679774997897, 2.6457513110645906,
                              3.0, 3.3166247903553998};
  static_assert(std::size(kNorm) == kFieldDegree + 1);
  P[0] = Lanes<W>{} + 1.0;
  P[1] = x;
#pragma GCC unroll 8
  for (int k = 1; k < kFieldDegree; ++k) {
    P[k + 1] = ((2.0 * k + 1) / (k + 1)) * x * P[k] - (static_cast<double>(k) / (k + 1)) * P[k - 1];
  }
#pragma GCC unroll 8
  for (int k = 1; k <= kFieldDegree; ++k) P[k] *= kNorm[k];
}

/// Calls put(place, value) for each function.
template <int W, class Put>
[[gnu::always_inline]] inline void eachFunction(const FieldBox& box, const Lanes<W>& u,
                                                const Lanes<W>& v, const Put& put) {
  Lanes<W> X[kFieldDegree + 1];
  Lanes<W> Y[kFieldDegree + 1];
  legendre<W>(clampedPlace<W>(u, box.centre[0], box.half[0]), X);
  legendre<W>(clampedPlace<W>(v, box.centre[1], box.half[1]), Y);
  int place = 0;
#pragma GCC unroll 8
  for (int i = 0; i <= kFieldDegree; ++i) {
#pragma GCC unroll 8
    for (int j = 0; i + j <= kFieldDegree; ++j) put(place++, X[i] * Y[j]);
  }
}

template <int W, int S>
struct FieldSums {
  gram::Sums<W, S> view;
  /// Per row: (shared, e, m, 1) x functions.
  Lanes<W> fields[2][S + 3][kFieldFunctions] = {};
  Lanes<W> squares[kFieldFunctions][kFieldFunctions];  // only where they are kept
};

/// Rows kRow .. kEnd - 1 of the left factor against all functions.
template <int W, int kEnd, int kRow = 0>
[[gnu::always_inline]] inline void addAgainst(const double* left, const double* functions, int n,
                                              Lanes<W>* sums) {
  constexpr int kRows = kEnd - kRow < 4 ? kEnd - kRow : 4;
  gram::addStrip<W, kRows, kFieldFunctions>(left + kRow * gram::kStride, functions, n,
                                            sums + kRow * kFieldFunctions, kFieldFunctions);
  if constexpr (kRow + kRows < kEnd) {
    addAgainst<W, kEnd, kRow + kRows>(left, functions, n, sums);
  }
}

/// The corners of one group: the columns of the view, and the functions, all times the root of
/// the corner's weight: one set of columns is then both factors of every product. That is possible
/// because the weight is a scalar (re-weighted least squares), not the 2x2 one of viewGram().
template <int W, int S, class Model, bool kRobust>
[[gnu::always_inline]] inline void fillGroup(const gram::Input& in, const FieldBox& box, int first,
                                             int j, double* left, double* functions,
                                             Lanes<W>& invalid, Lanes<W>& squared) {
  auto g = gram::projectGroup<W, Model>(in, first + j, invalid);
  // g.squared holds one weight; the cost counts w^2, and no loss.
  squared += g.w * g.squared;
  if constexpr (kRobust) {
    const Lanes<W> slope = 1.0 / (1.0 + (g.e_u * g.e_u + g.e_v * g.e_v) * in.inverse_c2);
    for (int lane = 0; lane < W; ++lane) g.w[lane] *= std::sqrt(slope[lane]);
  }
  gram::fillPlain<W, S, true, false>(in, g, first + j, left + j);
  eachFunction<W>(box, gram::load<W>(in.view.u + first + j), gram::load<W>(in.view.v + first + j),
                  [&](int place, const Lanes<W>& f) {
                    gram::store<W>(functions + place * gram::kStride + j, g.w * f);
                  });
}

/// Sums over a view as gram::sumView() has them, and against the functions beside. Rows u and v are
/// summed apart, for each has columns of its own in F.
template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void sumFields(
    const gram::Input& in, const FieldInput& f,
    FieldSums<W, gram::kShared<Model, true, false>>& sums) {
  using gram::kChunk;
  using gram::kStride;
  constexpr int S = gram::kShared<Model, true, false>;
  alignas(64) double left[(S + 3) * kStride];
  alignas(64) double functions[kFieldFunctions * kStride];
  if (f.squares) {
    for (auto& row : sums.squares) std::fill(std::begin(row), std::end(row), Lanes<W>{});
  }
  Lanes<W> invalid = {};
  for (int first = 0; first < in.view.padded; first += kChunk) {
    const int n = std::min(in.view.padded - first, kChunk);
    for (int j = 0; j < n; j += W) {
      fillGroup<W, S, Model, kRobust>(in, f.box, first, j, left, functions, invalid,
                                      sums.view.squared);
    }
    for (int row = 0; row < 2; ++row) {
      const double* half = left + row * kChunk;
      gram::addUpper<W, S>(half, half, n, &sums.view.shared[0][0]);
      gram::addStrip<W, 2, S + 3>(half + (S + gram::kPlane) * kStride, half, n,
                                  &sums.view.own[row][0][0], S + 3);
      addAgainst<W, S + 3>(half, functions, n, &sums.fields[row][0][0]);
    }
    if (f.squares) addAgainst<W, kFieldFunctions>(functions, functions, n, &sums.squares[0][0]);
  }
  // Unlike viewGram(), cost is squared_error whatever the loss.
  const double charged = kInvalidSquaredError * gram::sumOf<W>(invalid);
  sums.view.squared[0] += charged;
  sums.view.cost = gram::sumOf<W>(sums.view.squared);
}

/// Rows of k in the order fu fv pu pv, shape. The columns of u do not meet fv and pv, nor those of
/// v fu and pu: zero.
template <int W, int kShape, int S>
[[gnu::always_inline]] inline void writeFields(const FieldSums<W, S>& sums, FieldGram& out) {
  out.H_k_f.setZero(4 + kShape, kFieldColumns);
  for (int row = 0; row < 2; ++row) {
    for (int f = 0; f < kFieldFunctions; ++f) {
      const int column = row * kFieldFunctions + f;
      for (int i = 0; i < 6; ++i) {
        out.H_pose_f(i, column) = gram::sumOf<W>(sums.fields[row][i][f]);
      }
      for (int i = 0; i < kShape; ++i) {
        out.H_k_f(4 + i, column) = gram::sumOf<W>(sums.fields[row][6 + i][f]);
      }
      out.b_f[column] = gram::sumOf<W>(sums.fields[row][S + gram::kError][f]);
      out.H_k_f(row, column) = gram::sumOf<W>(sums.fields[row][S + gram::kPlane][f]);
      out.H_k_f(2 + row, column) = gram::sumOf<W>(sums.fields[row][S + gram::kOne][f]);
    }
  }
}

template <int W, int S>
[[gnu::always_inline]] inline void writeSquares(const FieldSums<W, S>& sums, FieldGram& out) {
  for (int i = 0; i < kFieldFunctions; ++i) {
    for (int j = 0; j < kFieldFunctions; ++j) {
      out.H_f(i, j) = gram::sumOf<W>(sums.squares[i][j]);
    }
  }
}

template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void compute(const gram::Input& in, const FieldInput& f,
                                           FieldGram& out) {
  // Tens of kilobytes: filled in place, not copied.
  FieldSums<W, gram::kShared<Model, true, false>> sums;
  sumFields<W, Model, kRobust>(in, f, sums);
  // Sums of the u-v coupling stay zero: a scalar weight brings none.
  gram::writePose<W>(sums.view, out);
  gram::writeIntrinsics<W, Model::kShape>(sums.view, out);
  writeFields<W, Model::kShape>(sums, out);
  if (f.squares) {
    writeSquares<W>(sums, out);
  } else {
    out.H_f.setZero();
  }
}

// Only these functions carry the instruction set.
template <class Model, bool kRobust>
void computeBaseline(const gram::Input& in, const FieldInput& f, FieldGram& out) {
  compute<2, Model, kRobust>(in, f, out);
}

#if defined(__x86_64__)
template <class Model, bool kRobust>
[[gnu::target("avx2,fma")]] void computeAvx2(const gram::Input& in, const FieldInput& f,
                                             FieldGram& out) {
  compute<4, Model, kRobust>(in, f, out);
}
#endif

template <class Model, bool kRobust>
void computeWith(InstructionSet set, const gram::Input& in, const FieldInput& f, FieldGram& out) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx2) return computeAvx2<Model, kRobust>(in, f, out);
#endif
  computeBaseline<Model, kRobust>(in, f, out);
}

/// Corner by corner, for models that the kernel is not compiled for.
class PlainSum {
 public:
  PlainSum(const Intrinsics& camera, FieldGram& out) : out_(out) {
    const auto K = camera.projection.size() + camera.distortion.size();
    out.H_pose_k.setZero(6, K);
    out.H_k.setZero(K, K);
    out.b_k.setZero(K);
    out.H_pose_f.setZero();
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
                         const FieldInput& input, const GramOptions& options) {
  FieldGram out;
  PlainSum sum(camera, out);
  for (int i = 0; i < view.count; ++i) {
    const double w2 = view.w[i] * view.w[i];
    if (!(w2 > 0)) continue;
    const Eigen::Vector3d p = T_CF * Eigen::Vector3d(view.x[i], view.y[i], view.z[i]);
    const Eigen::Vector2d uv(view.u[i], view.v[i]);
    const auto at = projectWithJacobians(camera, p);
    const double squared = at ? (at->uv - uv).squaredNorm() : kInvalidSquaredError;
    out.squared_error += w2 * std::min(squared, kInvalidSquaredError);
    if (!(squared < kInvalidSquaredError)) continue;
    const double c2 = options.cauchy_px * options.cauchy_px;
    const double weight = c2 > 0 ? w2 / (1 + squared / c2) : w2;
    const auto f = fieldFunctions(input.box, uv);
    sum.add(*at, p, at->uv - uv, weight, f);
    if (input.squares) out.H_f += weight * f * f.transpose();
  }
  out.cost = out.squared_error;
  return out;
}

}  // namespace

Eigen::Matrix<double, kFieldFunctions, 1> fieldFunctions(const FieldBox& box,
                                                         const Eigen::Vector2d& uv) {
  Eigen::Matrix<double, kFieldFunctions, 1> f;
  eachFunction<2>(box, Lanes<2>{uv[0], uv[0]}, Lanes<2>{uv[1], uv[1]},
                  [&](int place, const Lanes<2>& value) { f[place] = value[0]; });
  return f;
}

FieldGram fieldGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                    const FieldBox& box, FieldSquares squares, const GramOptions& options) {
  assert(box.half.minCoeff() > 0);
  FieldGram out;
  const gram::Input in = gram::viewInput(camera, T_CF, view, options);
  const FieldInput f{box, squares == FieldSquares::kKeep};
  std::visit(
      [&]<class Model>(Model) {
        if constexpr (kIsVectorised<Model>) {
          const InstructionSet set = bestInstructionSet();
          options.cauchy_px > 0 ? computeWith<Model, true>(set, in, f, out)
                                : computeWith<Model, false>(set, in, f, out);
        } else {
          out = plainFieldGram(camera, T_CF, view, f, options);
        }
      },
      cameraModelOf(camera));
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/predicted_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrator/dense/decompositions.h"
#include "calibrator/information/excess_kernel.h"
#include "calibrator/linear/dense.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is known before the first view, in corners of later use: so little that a handful of corners
// outweighs it, so much that two views leave a number.
constexpr double kKnownBefore = 1e-6;
// Of the mean square of the field's columns in a view.
constexpr double kFieldRidge = 1e-3;
constexpr double kSharedRidge = 1e-12;  // of the mean variance of sum s_v
constexpr double kFreeRidge = 1e-9;     // of a mean corner's information
constexpr double kLeastRidge = 2e-13;   // of all of it: above the pivots of scaledCholesky()
constexpr double kLeastNoiseShare = 0.2;
// |M|^2 over sum |D_v|^2 below which few views cannot part their own misfit from a common one: V
// views that see alike have V.
constexpr double kTellsApart = 1.5;

MatrixXd symmetric(const MatrixXd& A) { return 0.5 * (A + A.transpose()); }

/// L of A = L L^T, from the scaled factorisation: units may differ between parameters.
std::optional<MatrixXd> lowerFactor(const MatrixXd& A) {
  const auto f = scaledCholesky(A);
  if (!f) return std::nullopt;
  return MatrixXd(f->D.asDiagonal() * MatrixXd(f->llt.matrixL()));
}

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] double valueAvx2(const excess::Input& in) {
  return excess::value<4>(in);
}
#endif

/// Sums over views of what the components are made of.
struct FieldMoments {
  MatrixXd H, C, D, DD;
  VectorXd s;
  double s_squared = 0;  // over the views, of each by itself, as DD is
  double fitted = 0;     // what a field of each view's own takes of its squared error
  double fields = 0;     // how many functions did
  double squared_px = 0, corners = 0, views = 0;

  explicit FieldMoments(const ViewTerms& like)
      : H(MatrixXd::Zero(like.I.rows(), like.I.cols())),
        C(MatrixXd::Zero(like.C.rows(), like.C.cols())),
        D(MatrixXd::Zero(like.D.rows(), like.D.cols())),
        DD(D),
        s(VectorXd::Zero(like.s.size())) {}

  void add(const ViewTerms& view) {
    const auto K = static_cast<double>(view.s.size());
    H += view.I;
    C += view.C;
    D += view.D;
    s += view.s;
    s_squared += view.s.squaredNorm();
    DD.noalias() += view.D * view.D;
    MatrixXd ridged = view.D;
    ridged.diagonal().array() += kFieldRidge * view.D.trace() / std::max(K, 1.0) + 1e-9;
    // s^T D^-1 s is what a field of the view's own takes of its squared error; the ridge bounds
    // what functions take that the view hardly sees.
    fitted += view.s.dot(ridged.llt().solve(view.s));
    fields += std::min(K, view.corners);
    squared_px += view.squared_px;
    corners += view.corners;
    ++views;
  }

  double sigma2() const {
    // Rows less what was fitted to them: poses, parameters, and fields, which are no more than the
    // view has corners.
    const double free = 2 * corners - 6 * views - static_cast<double>(H.rows()) - fields;
    const double left = std::max(kLeastNoiseShare * squared_px, squared_px - fitted);
    // Few corners a view would leave next to nothing to divide by.
    return left / std::max(free, 0.5 * corners);
  }
};

}  // namespace

LaterUse& LaterUse::operator+=(const LaterUse& other) {
  if (other.corners == 0) return *this;
  if (corners == 0) return *this = other;
  const double all = corners + other.corners;
  const double own = corners / all;
  const double others = other.corners / all;
  H = own * H + others * other.H;
  C = own * C + others * other.C;
  D = own * D + others * other.D;
  corners = all;
  return *this;
}

LaterUse laterUse(std::span<const ViewTerms> views) {
  LaterUse use;
  for (const ViewTerms& view : views) {
    if (view.corners == 0) continue;
    use += {view.I / view.corners, view.C / view.corners, view.D / view.corners, view.corners};
  }
  return use;
}

std::optional<MatrixXd> strongestFields(const LaterUse& use, const MatrixXd& some,
                                        const MatrixXd& always, int count) {
  if (use.corners == 0) return std::nullopt;
  const auto L = lowerFactor(use.H);
  if (!L) return std::nullopt;
  const MatrixXd W = L->triangularView<Eigen::Lower>().solve(use.C * some);
  const MatrixXd D = some.transpose() * use.D * some;
  const SymmetricEigen eigen = symmetricEigen(symmetric(D - W.transpose() * W));
  const Eigen::Index room = std::max<Eigen::Index>(0, count - always.cols());
  const Eigen::Index strongest = std::min(room, some.cols());
  MatrixXd out(some.rows(), strongest + always.cols());
  out << some * eigen.vectors.rightCols(strongest), always;
  return out;
}

ErrorComponents errorComponents(std::span<const ViewTerms> views) {
  ErrorComponents out;
  if (views.empty()) return out;
  FieldMoments sum(views.front());
  for (const ViewTerms& view : views) {
    if (view.corners > 0) sum.add(view);
  }
  if (sum.corners == 0) return out;
  out.mean_squared_px = sum.squared_px / sum.corners;
  out.sigma2 = sum.sigma2();
  const double D_squared = sum.DD.trace();
  if (!(D_squared > 0)) return out;
  sum.H +=
      std::max(kFreeRidge / sum.corners, kLeastRidge) * MatrixXd(sum.H.diagonal().asDiagonal());
  const auto L = lowerFactor(sum.H);
  // C^T H^-1 C is what the parameters take of a common field. Where H is singular they are taken to
  // have had nothing of it.
  MatrixXd M = sum.D;
  if (L) {
    const MatrixXd W = L->triangularView<Eigen::Lower>().solve(sum.C);
    M -= W.transpose() * W;
  }
  // s_v = F^T e of a field c and noise: E |s_v|^2 = sigma^2 tr D_v + (tau^2 + b^2) |D_v|^2, c being
  // random with equal variances of its functions.
  const double t = std::max(0.0, (sum.s_squared - out.sigma2 * sum.D.trace()) / D_squared);
  const double M_squared = M.squaredNorm();
  if (M_squared <= kTellsApart * D_squared) {
    out.b2 = 0.5 * t;
  } else {
    out.told_apart = true;
    // At the optimum the parameters have taken their part of a common c, and sum s_v = M c: E |sum
    // s_v|^2 = sigma^2 tr M + b^2 |M|^2 + tau^2 sum |D_v|^2, tau^2 = t - b^2.
    const double common = sum.s.squaredNorm() - out.sigma2 * std::max(0.0, M.trace());
    const double b2 = (common - t * D_squared) / (M_squared - D_squared);
    out.b2 = std::clamp(b2, 0.0, t);
  }
  out.tau2 = t - out.b2;
  out.shared = {symmetric(M), std::move(sum.DD), std::move(sum.s)};
  return out;
}

ErrorComponents guarded(ErrorComponents components) {
  constexpr double kRaised = 16;
  components.b2 = std::min(kRaised * components.b2, 0.45 * components.sigma2);
  components.tau2 = std::min(kRaised * components.tau2, components.sigma2 / 9);
  return components;
}

MatrixXd sharedMoment(const ErrorComponents& components, Eigen::Index functions) {
  const auto& [M, Q, s] = components.shared;
  const double b2 = components.b2;
  const MatrixXd prior = b2 * MatrixXd::Identity(functions, functions);
  if (!(b2 > 0) || s.size() == 0) return prior;
  const MatrixXd noise = components.sigma2 * M + components.tau2 * Q;
  MatrixXd all = b2 * M * M + noise;
  // Of a function that the parameters have taken entirely there is neither misfit nor noise.
  all.diagonal().array() += kSharedRidge * all.trace() / static_cast<double>(functions);
  const MatrixXd A = b2 * all.llt().solve(M).transpose();
  // b^2 (I - A M) in the form that rounding leaves positive (Joseph).
  const MatrixXd left = MatrixXd::Identity(functions, functions) - A * M;
  const VectorXd beta = A * s;
  return symmetric(b2 * left * left.transpose() + A * noise * A.transpose() +
                   beta * beta.transpose());
}

double relativeExcess(double E, const ErrorComponents& components) {
  if (!(components.mean_squared_px > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(1 + E / components.mean_squared_px) - 1;
}

PredictedError::PredictedError(const LaterUse& use, const ErrorComponents& components)
    : sigma2_(components.sigma2), tau2_(components.tau2) {
  const Eigen::Index n = use.H.rows();
  MatrixXd H_T = use.H;
  // A direction of the parameters that later use does not touch costs nothing there.
  H_T.diagonal() *= 1 + 1e-6;
  const auto L = lowerFactor(H_T);
  assert(L);
  L_ = *L;
  // L^T A_T = L^-1 C_T, since A_T = (L L^T)^-1 C_T.
  bias_ = L_.triangularView<Eigen::Lower>().solve(use.C);
  H_ = kKnownBefore * H_T;
  Q_ = MatrixXd::Zero(n, n);
  const Eigen::Index K = use.C.cols();
  C_ = MatrixXd::Zero(n, K);
  if (!(components.b2 > 0)) return;
  const SymmetricEigen moment = symmetricEigen(sharedMoment(components, K));
  const VectorXd roots = moment.values.cwiseMax(0.0).cwiseSqrt();
  spread_ = MatrixXd::Zero(excess::wholeLanes(K), K);
  spread_.topRows(K) = roots.asDiagonal() * moment.vectors.transpose();
}

void PredictedError::add(const ViewTerms& view) {
  H_ += view.I;
  Q_.noalias() += view.C * view.C.transpose();
  C_ += view.C;
}

double PredictedError::value() const { return evaluate(H_, nullptr); }

double PredictedError::valueWith(const ViewTerms& view) const {
  return evaluate(H_ + view.I, &view.C);
}

double PredictedError::evaluate(const MatrixXd& H, const MatrixXd* C_v) const {
  // Without b the kernel makes nothing of C, without tau nothing of Q: then they are not copied.
  const MatrixXd* C = &C_;
  const MatrixXd* Q = &Q_;
  MatrixXd C_all, Q_all;
  if (C_v != nullptr && spread_.size() > 0) {
    C_all = C_ + *C_v;
    C = &C_all;
  }
  if (C_v != nullptr && tau2_ > 0) {
    Q_all = Q_;
    Q_all.selfadjointView<Eigen::Lower>().rankUpdate(*C_v);
    Q = &Q_all;
  }
  const excess::Input in{H, *C, *Q, L_, bias_, spread_, sigma2_, tau2_};
#if defined(__x86_64__)
  if (bestInstructionSet() == InstructionSet::kAvx2) return valueAvx2(in);
#endif
  return excess::value<2>(in);
}

}  // namespace plumbline

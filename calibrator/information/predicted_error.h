// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

#include "calibrator/base/enum_words.h"

namespace plumbline {

// By how much will a calibration from some views miss where the camera is used later? Expected
// excess of the squared error there over what a calibration without error leaves, per corner:
//
//   E = tr(H_T H^-1 G H^-1) + |H_T^1/2 (H^-1 C - A_T) S|_F^2   [px^2],   A_T = H_T^-1 C_T
//
// variance plus squared bias (Box and Draper, "A basis for the selection of a response surface
// design", JASA 1959). Over the views used: H sums what they tell of the parameters under 1 px of
// noise, and C how the parameters answer to a smooth field of misfit; G = sigma^2 H + tau^2 sum
// C_v C_v^T is the covariance of the normal equations' right side, sigma [px] the noise of a
// corner, tau a misfit that every view draws anew, b one that they share: each so many px per
// function of the field. S S^T is the second moment of the shared one's coefficients: b^2 I before
// the residuals are asked which of them it has. H_T, C_T, D_T are the same sums, per corner and
// without loss, over the frames that stand for later use. Without misfit E is sigma^2 tr(H_T H^-1):
// I-optimality.

/// One view at an estimate, for unit noise, its pose eliminated: with J the columns of n
/// parameters, F those of the field, e the residuals, weighted by the loss,
/// I = J^T J, C = J^T F, D = F^T F, s = F^T e.
struct ViewTerms {
  Eigen::MatrixXd I;      ///< n x n [1 / parameter^2 per px^2]
  Eigen::MatrixXd C;      ///< n x K
  Eigen::MatrixXd D;      ///< K x K; empty for a view that nobody has taken
  Eigen::VectorXd s;      ///< K; likewise
  double squared_px = 0;  ///< sum |e|^2, without loss [px^2]
  double corners = 0;     ///< used; 0: the view says nothing
};

/// What later use asks of the parameters, per corner: sums of I, C and D.
struct LaterUse {
  Eigen::MatrixXd H, C, D;
  double corners = 0;

  /// Of both, weighted by their corners.
  LaterUse& operator+=(const LaterUse& other);
};
LaterUse laterUse(std::span<const ViewTerms> views);

/// `count` columns (fewer if there are no more, more where `always` has more): those of `always`,
/// and before them the orthonormal directions among the combinations `some` of the field's columns
/// that leave most where the camera is used once the parameters have taken what they can:
/// eigenvectors of B^T (D_T - C_T^T H_T^-1 C_T) B, B = some, times B.
/// Empty where H_T is singular.
std::optional<Eigen::MatrixXd> strongestFields(const LaterUse& use, const Eigen::MatrixXd& some,
                                               const Eigen::MatrixXd& always, int count = 16);

/// By what views are chosen.
enum class ViewCriterion {
  kMutualInformation,  ///< what they tell of the parameters
  kPredictedError,     ///< by how much they lower E
};
constexpr std::array<const char*, 2> enumWords(ViewCriterion /*of*/) {
  return {"mi", "predicted-error"};
}

/// What the residuals tell of the coefficients c of the misfit that all views share:
/// s = M c + noise of covariance sigma^2 M + tau^2 Q, where s = sum s_v, M = D - C^T H^-1 C (the
/// rest the parameters have taken) and Q = sum D_v^2.
struct SharedMisfit {
  Eigen::MatrixXd M, Q;
  Eigen::VectorXd s;
};

/// Which parts the residuals have, each squared.
struct ErrorComponents {
  double sigma2 = 0;           ///< noise per axis [px^2]
  double tau2 = 0;             ///< misfit of a view by itself [px^2 per function]
  double b2 = 0;               ///< misfit that all views share [px^2 per function]
  double mean_squared_px = 0;  ///< mean |e|^2 of a corner [px^2]
  bool told_apart = false;     ///< the views tell b from tau; otherwise they share t evenly
  SharedMisfit shared{};       ///< empty: nothing but b^2 is known
};

/// From the residuals of V views used, by moments of s_v: with N corners, n parameters, K functions
///   sigma^2 = (sum e^2 - sum s_v^T (D_v + ridge)^-1 s_v) / (2 N - 6 V - n - K V),
///   t = (sum |s_v|^2 - sigma^2 sum tr D_v) / sum |D_v|^2,   M = D - C^T H^-1 C,
///   b^2 = (|sum s_v|^2 - sigma^2 tr M - t sum |D_v|^2) / (|M|^2 - sum |D_v|^2), in [0, t],
/// and tau^2 = t - b^2; b^2 = t / 2 while the views are too few to part them
/// (|M|^2 <= 1.5 sum |D_v|^2). At least a fifth of the squared error is noise.
ErrorComponents errorComponents(std::span<const ViewTerms> views);

/// As they enter the score: b^2 = min(16 b^2, 0.45 sigma^2), tau^2 = min(16 tau^2, sigma^2 / 9).
/// The moments see the misfit where the views are and underestimate it at the image's border; the
/// bounds keep a misfit that was estimated from few views from ruling the choice.
ErrorComponents guarded(ErrorComponents components);

/// E[c c^T] = beta beta^T + P of the shared misfit, its prior N(0, b^2 I): with the gain
/// A = b^2 M (b^2 M^2 + sigma^2 M + tau^2 Q)^-1, beta = A s and P = b^2 (I - A M). With few views
/// it is near b^2 I; as they come it turns to the misfit that is there. b^2 I where `shared` is
/// empty.
Eigen::MatrixXd sharedMoment(const ErrorComponents& components, Eigen::Index functions);

/// sqrt(1 + E / mean |e|^2) - 1: the share by which E raises the error of a corner in later use.
double relativeExcess(double E, const ErrorComponents& components);

/// E of a growing set of views. Costs of a further view with n = 22, K = 16: see
/// tests/benchmarks/guidance_views_benchmark.cpp.
class PredictedError {
 public:
  /// Nothing is known but a millionth of what a corner of later use tells. `use`: reduced to the
  /// fields that the views have, and regular (strongestFields() of it is not empty).
  PredictedError(const LaterUse& use, const ErrorComponents& components);

  void add(const ViewTerms& view);
  double value() const;                           ///< E of the views added [px^2]
  double valueWith(const ViewTerms& view) const;  ///< and of one more, which stays out [px^2]

 private:
  double sigma2_, tau2_;
  Eigen::MatrixXd spread_;     // S^T, its rows padded to whole lanes; empty without b
  Eigen::MatrixXd H_, Q_, C_;  // sums over views; Q of C_v C_v^T
  Eigen::MatrixXd L_;          // H_T = L L^T
  Eigen::MatrixXd bias_;       // L^T A_T
  double evaluate(const Eigen::MatrixXd& H, const Eigen::MatrixXd* C_v) const;
};

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/predicted_error.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/information/excess_kernel.h"

namespace plumbline {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kErrorParameters = 6, kFunctions = 4, kErrorRows = 120;

/// Views of a linear model whose residuals hold noise, a field of each view's own, and a common
/// one: random columns of parameters and fields, units orders of magnitude apart. Six more columns
/// of each view's own, as of a pose, are eliminated.
struct LinearViews {
  std::vector<MatrixXd> J, F;
  std::vector<ViewTerms> terms;
  VectorXd common;                                ///< field of all views
  VectorXd g = VectorXd::Zero(kErrorParameters);  ///< sum of J^T e

  LinearViews(int views, double sigma, double tau, double b, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](Eigen::Index rows, Eigen::Index columns) {
      return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
    };
    common = b * draw(kFunctions, 1);
    for (int v = 0; v < views; ++v) {
      const MatrixXd pose = draw(kErrorRows, 6);
      const MatrixXd rest = MatrixXd::Identity(kErrorRows, kErrorRows) -
                            pose * (pose.transpose() * pose).inverse() * pose.transpose();
      MatrixXd columns = rest * draw(kErrorRows, kErrorParameters);
      for (int j = 1; j < kErrorParameters; j += 2) columns.col(j) *= 1e-3;
      J.push_back(columns);
      F.push_back(rest * draw(kErrorRows, kFunctions) + columns.col(0) * draw(1, kFunctions));
      const VectorXd field = common + tau * draw(kFunctions, 1);
      const VectorXd e = rest * (sigma * draw(kErrorRows, 1)) + F.back() * field;
      g += J.back().transpose() * e;
      terms.push_back({J.back().transpose() * J.back(), J.back().transpose() * F.back(),
                       F.back().transpose() * F.back(), F.back().transpose() * e, e.squaredNorm(),
                       kErrorRows / 2});
    }
  }
};

/// By inverses, as the equation is printed.
double byInverses(const LinearViews& views, const LaterUse& use, const ErrorComponents& c) {
  MatrixXd H = MatrixXd::Zero(kErrorParameters, kErrorParameters), G = H;
  MatrixXd C = MatrixXd::Zero(kErrorParameters, kFunctions);
  for (const ViewTerms& v : views.terms) {
    H += v.I;
    C += v.C;
    G += c.sigma2 * v.I + c.tau2 * v.C * v.C.transpose();
  }
  const MatrixXd Hi = H.inverse();
  const MatrixXd root = use.H.llt().matrixL().transpose();
  const MatrixXd A = use.H.inverse() * use.C;
  return (use.H * Hi * G * Hi).trace() + c.b2 * (root * (Hi * C - A)).squaredNorm();
}

TEST(PredictedError, HandValueOfOneParameter) {
  // H = 4, C = 2, tau^2 C_v^2 = 0.5 * 4; H_T = 2, C_T = 3, so A_T = 1.5 and H^-1 C = 0.5:
  // E = 2 (0.25 * 4 + 0.5 * 4) / 16 + 0.1 * 2 * 1 = 0.375 + 0.2.
  const auto one = [](double x) { return MatrixXd(MatrixXd::Constant(1, 1, x)); };
  const LaterUse use{one(2), one(3), one(9), 1};
  PredictedError error(use, {0.25, 0.5, 0.1, 1, true});
  const ViewTerms view{one(4), one(2), {}, {}, 0, 1};
  EXPECT_NEAR(error.valueWith(view), 0.575, 1e-5);
  error.add(view);
  EXPECT_NEAR(error.value(), 0.575, 1e-5);  // what is known before counts a millionth
}

TEST(PredictedError, IsWhatTheEquationSaysOfManyViews) {
  const LinearViews views(7, 0.3, 0.2, 0.1, 1);
  const LaterUse use = laterUse(LinearViews(9, 0, 0, 0, 2).terms);
  const ErrorComponents c{0.09, 0.04, 0.01, 1, true};
  PredictedError error(use, c);
  for (std::size_t v = 0; v + 1 < views.terms.size(); ++v) error.add(views.terms[v]);
  const double expected = byInverses(views, use, c);
  EXPECT_NEAR(error.valueWith(views.terms.back()), expected, 1e-6 * expected);
  error.add(views.terms.back());
  EXPECT_NEAR(error.value(), expected, 1e-6 * expected);
}

/// Every width of the kernel, with sides that fill no whole number of lanes.
TEST(PredictedError, EveryWidthOfTheKernelIsTheEquation) {
  const LinearViews views(7, 0.3, 0.2, 0.1, 10);
  const LaterUse use = laterUse(LinearViews(9, 0, 0, 0, 11).terms);
  const ErrorComponents c{0.09, 0.04, 0.01, 1, true};
  MatrixXd H = MatrixXd::Zero(kErrorParameters, kErrorParameters), Q = H;
  MatrixXd C = MatrixXd::Zero(kErrorParameters, kFunctions);
  for (const ViewTerms& v : views.terms) {
    H += v.I;
    C += v.C;
    Q += v.C * v.C.transpose();
  }
  const MatrixXd L = use.H.llt().matrixL();
  const MatrixXd bias = L.triangularView<Eigen::Lower>().solve(use.C);
  const double expected = byInverses(views, use, c);
  const MatrixXd spread = std::sqrt(c.b2) * MatrixXd::Identity(kFunctions, kFunctions);
  const excess::Input in{H, C, Q, L, bias, spread, c.sigma2, c.tau2};
  EXPECT_NEAR(excess::value<2>(in), expected, 1e-9 * expected);
  EXPECT_NEAR(excess::value<4>(in), expected, 1e-9 * expected);
  H(3, 3) = -1;
  EXPECT_TRUE(std::isinf(excess::value<2>(in)));
}

TEST(PredictedError, WithoutMisfitItIsTheVarianceInLaterUse) {
  const LinearViews views(5, 0.3, 0, 0, 3);
  const LaterUse use = laterUse(views.terms);
  PredictedError error(use, {0.09, 0, 0, 1, true});
  for (const ViewTerms& v : views.terms) error.add(v);
  // Used as it was made: sigma^2 n over the corners.
  EXPECT_NEAR(error.value(), 0.09 * kErrorParameters / (5 * kErrorRows / 2), 1e-7);
}

/// The equation is an expectation: averaged over draws of noise and fields, least squares on the
/// views misses later use by so much.
TEST(PredictedError, IsTheMeanExcessOfLeastSquaresOverDraws) {
  constexpr double kSigma = 0.3, kTau = 0.2, kB = 0.15;
  const LinearViews used(6, 0, 0, 0, 4), later(8, 0, 0, 0, 5);
  const LaterUse use = laterUse(later.terms);
  MatrixXd H = MatrixXd::Zero(kErrorParameters, kErrorParameters);
  for (const ViewTerms& v : used.terms) H += v.I;
  const Eigen::LLT<MatrixXd> llt(H);
  const MatrixXd A_T = use.H.ldlt().solve(use.C);
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  const auto draw = [&](int n) {
    return VectorXd(VectorXd::NullaryExpr(n, [&] { return normal(random); }));
  };
  constexpr int kDraws = 4000;
  double excess = 0;
  for (int d = 0; d < kDraws; ++d) {
    const VectorXd common = kB * draw(kFunctions);
    VectorXd g = VectorXd::Zero(kErrorParameters);
    for (std::size_t v = 0; v < used.J.size(); ++v) {
      const VectorXd e = kSigma * draw(kErrorRows) + used.F[v] * (common + kTau * draw(kFunctions));
      g += used.J[v].transpose() * e;
    }
    // The best that parameters can do in later use under the common field is A_T common.
    const VectorXd miss = llt.solve(g) - A_T * common;
    excess += miss.dot(use.H * miss) / kDraws;
  }
  PredictedError error(use, {kSigma * kSigma, kTau * kTau, kB * kB, 1, true});
  for (const ViewTerms& v : used.terms) error.add(v);
  // A mean of 4000 draws of a quadratic form: its deviation is about 2 %.
  EXPECT_NEAR(error.value() / excess, 1, 0.08);
}

/// Bayes' rule: over draws of the shared misfit from its prior, least squares leave s, and beta has
/// errors of covariance P.
TEST(SharedMoment, IsTheSecondMomentGivenTheResiduals) {
  constexpr double kSigma = 0.3, kTau = 0.05, kB = 0.15;
  MatrixXd mean = MatrixXd::Zero(kFunctions, kFunctions), truth = mean;
  double squared = 0, expected = 0;
  constexpr int kDraws = 120;
  for (int d = 0; d < kDraws; ++d) {
    LinearViews views(6, kSigma, kTau, kB, 1000 + d);
    MatrixXd H = MatrixXd::Zero(kErrorParameters, kErrorParameters);
    for (const ViewTerms& v : views.terms) H += v.I;
    const VectorXd fitted = H.ldlt().solve(views.g);
    for (ViewTerms& v : views.terms) v.s -= v.C.transpose() * fitted;
    ErrorComponents c = errorComponents(views.terms);
    c.sigma2 = kSigma * kSigma;
    c.tau2 = kTau * kTau;
    c.b2 = kB * kB;
    mean += sharedMoment(c, kFunctions) / kDraws;
    truth += views.common * views.common.transpose() / kDraws;
    // beta beta^T + P without s is P: the difference is beta up to its sign.
    ErrorComponents blind = c;
    blind.shared.s.setZero();
    const MatrixXd P = sharedMoment(blind, kFunctions);
    const Eigen::JacobiSVD<MatrixXd> svd(sharedMoment(c, kFunctions) - P, Eigen::ComputeThinU);
    VectorXd beta = svd.matrixU().col(0) * std::sqrt(svd.singularValues()[0]);
    if (beta.dot(views.common) < 0) beta = -beta;
    squared += (beta - views.common).squaredNorm() / kDraws;
    expected += P.trace() / kDraws;
  }
  EXPECT_LT((mean - truth).norm(), 0.2 * truth.norm());
  EXPECT_NEAR(squared / expected, 1, 0.25);         // of 480 squares: 6 %
  EXPECT_LT(expected, 0.2 * kFunctions * kB * kB);  // six views tell nearly all of it
}

TEST(SharedMoment, WithoutResidualsItIsThePrior) {
  const ErrorComponents c{0.09, 0.04, 0.01, 1, true, {}};
  EXPECT_EQ(sharedMoment(c, 3), MatrixXd(0.01 * MatrixXd::Identity(3, 3)));
}

/// The misfit that is there counts, and not only how large it is: of two views as informative, the
/// better one answers to it as later use does.
TEST(PredictedError, TurnsToTheMisfitThatTheResidualsShow) {
  const auto one = [](double x) { return MatrixXd(MatrixXd::Constant(1, 1, x)); };
  const LaterUse use{one(1), MatrixXd::Zero(1, 2), MatrixXd::Identity(2, 2), 1};
  ErrorComponents c{1e-4, 0, 0.0025, 1, true, {}};
  c.shared = {100 * MatrixXd::Identity(2, 2), MatrixXd::Zero(2, 2), Eigen::Vector2d(0, 10)};
  const auto view = [&](double first, double second) {
    return ViewTerms{one(1), Eigen::RowVector2d(first, second), {}, {}, 0, 1};
  };
  const PredictedError error(use, c);
  EXPECT_LT(error.valueWith(view(1, 0)), 0.2 * error.valueWith(view(0, 1)));
  c.shared = {};
  const PredictedError blind(use, c);
  EXPECT_NEAR(blind.valueWith(view(1, 0)), blind.valueWith(view(0, 1)), 1e-12);
}

TEST(ErrorComponents, AreFoundFromTheResiduals) {
  double sigma2 = 0, tau2 = 0, b2 = 0;
  constexpr int kDraws = 40;
  for (int d = 0; d < kDraws; ++d) {
    const auto found = errorComponents(LinearViews(40, 0.3, 0.1, 0.08, 100 + d).terms);
    EXPECT_TRUE(found.told_apart);
    sigma2 += found.sigma2 / kDraws;
    tau2 += found.tau2 / kDraws;
    b2 += found.b2 / kDraws;
  }
  // The ridge and the parameters' share leave a few per cent. The common field is one draw of four
  // numbers each time: 40 draws know its mean square to 1.5 / sqrt(160) = 11 %.
  EXPECT_NEAR(sigma2 / 0.09, 1, 0.15);
  EXPECT_NEAR(tau2 / 0.01, 1, 0.15);
  EXPECT_NEAR(b2 / 0.0064, 1, 0.35);
}

TEST(ErrorComponents, ExactDataHaveNoMisfit) {
  double misfit = 0;
  for (int d = 0; d < 20; ++d) {
    const auto found = errorComponents(LinearViews(20, 0.3, 0, 0, 200 + d).terms);
    EXPECT_NEAR(found.sigma2 / 0.09, 1, 0.15);
    misfit = std::max(misfit, found.tau2 + found.b2);
  }
  // Of the moments' own noise: sigma^2 over sqrt of views times rows of a function.
  EXPECT_LT(misfit, 0.05 * 0.09);
}

TEST(ErrorComponents, OneViewCannotTellACommonFieldFromItsOwn) {
  const auto found = errorComponents(LinearViews(1, 0.1, 0.5, 0.5, 7).terms);
  EXPECT_FALSE(found.told_apart);
  EXPECT_EQ(found.b2, found.tau2);
  EXPECT_GT(found.b2, 0);
}

// Two parameters that do the same take of a common field what one takes, however many corners.
TEST(ErrorComponents, ParametersThatViewsLeaveFreeTakeNothingMore) {
  const LinearViews views(20, 0.3, 0.1, 0.3, 11);
  auto once = views.terms, twice = views.terms;
  for (std::size_t v = 0; v < once.size(); ++v) {
    once[v].corners = twice[v].corners = 4000;
    MatrixXd doubled = MatrixXd::Identity(kErrorParameters + 1, kErrorParameters);
    doubled.bottomRows(1) = doubled.topRows(1);
    twice[v].I = doubled * once[v].I * doubled.transpose();
    twice[v].C = doubled * once[v].C;
  }
  const ErrorComponents one = errorComponents(once), both = errorComponents(twice);
  EXPECT_GT(one.b2, 0);
  EXPECT_NEAR(both.b2 / one.b2, 1, 1e-3);
  EXPECT_NEAR(both.tau2 / one.tau2, 1, 1e-3);
}

TEST(ErrorComponents, GuardsKeepTheMisfitBelowTheNoise) {
  const ErrorComponents raised = guarded({1, 0.001, 0.002, 2, true});
  EXPECT_DOUBLE_EQ(raised.tau2, 0.016);
  EXPECT_DOUBLE_EQ(raised.b2, 0.032);
  const ErrorComponents cut = guarded({1, 1, 1, 2, true});
  EXPECT_DOUBLE_EQ(cut.tau2, 1.0 / 9);
  EXPECT_DOUBLE_EQ(cut.b2, 0.45);
  EXPECT_NEAR(relativeExcess(0.42, {0, 0, 0, 2, true}), 0.1, 1e-15);
}

TEST(StrongestFields, AreThoseThatParametersCannotTake) {
  LinearViews views(5, 0, 0, 0, 8);
  // The first function becomes a column of the parameters: nothing of it is left.
  for (std::size_t v = 0; v < views.terms.size(); ++v) {
    views.F[v].col(0) = views.J[v].col(0);
    views.terms[v].C = views.J[v].transpose() * views.F[v];
    views.terms[v].D = views.F[v].transpose() * views.F[v];
  }
  const auto fields =
      strongestFields(laterUse(views.terms), MatrixXd::Identity(kFunctions, kFunctions),
                      MatrixXd(kFunctions, 0), kFunctions - 1);
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->cols(), kFunctions - 1);
  const VectorXd absorbed = VectorXd::Unit(kFunctions, 0);
  EXPECT_LT((fields->transpose() * absorbed).norm(), 1e-6);
  EXPECT_LT((fields->transpose() * *fields - MatrixXd::Identity(3, 3)).norm(), 1e-12);
}

TEST(StrongestFields, ThoseAskedForAreAlwaysThere) {
  const LinearViews views(5, 0, 0, 0, 12);
  const MatrixXd all = MatrixXd::Identity(kFunctions, kFunctions);
  const auto fields = strongestFields(laterUse(views.terms), all.rightCols(3), all.leftCols(1), 3);
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->cols(), 3);
  EXPECT_EQ(VectorXd(fields->col(2)), VectorXd(all.col(0)));
  EXPECT_LT((fields->transpose() * *fields - MatrixXd::Identity(3, 3)).norm(), 1e-12);
}

// As of a rig of so many cameras that their radial fields alone are more than were asked for.
TEST(StrongestFields, MoreThanAskedForAreAllThere) {
  const LinearViews views(5, 0, 0, 0, 12);
  const MatrixXd all = MatrixXd::Identity(kFunctions, kFunctions);
  const auto fields = strongestFields(laterUse(views.terms), all.rightCols(1), all.leftCols(3), 2);
  ASSERT_TRUE(fields);
  EXPECT_EQ(*fields, MatrixXd(all.leftCols(3)));
}

TEST(StrongestFields, NothingWhereLaterUseLeavesParametersFree) {
  LinearViews views(3, 0, 0, 0, 9);
  for (ViewTerms& v : views.terms) {
    v.I.row(2).setZero();
    v.I.col(2).setZero();
  }
  const MatrixXd all = MatrixXd::Identity(kFunctions, kFunctions), none(kFunctions, 0);
  EXPECT_FALSE(strongestFields(laterUse(views.terms), all, none));
  EXPECT_FALSE(strongestFields(LaterUse{}, all, none));
}

}  // namespace
}  // namespace plumbline

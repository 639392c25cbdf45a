// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/board/higher_terms.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "calibrator/batch/board/target.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

constexpr double kSettled = 0.1;    // last step over the terms' standard deviations
constexpr double kStartStd = 1e-4;  // of a term [m]
constexpr double kLeastStd = 1e-7;  // [m]; smaller ones change nothing
constexpr int kEvidenceRounds = 50;

constexpr double kSameVariance = 1e-3;  // relative change that ends the search for the evidence

/// Groups of one variance each: cubic, quartic and remainders, in the plane and in height.
constexpr std::size_t kGroups = 6;
std::size_t groupOf(int term, int plane) {
  if (term >= kHigherTerms) return term < kHigherTerms + plane ? 4 : 5;
  const bool quartic = term % kHigherFunctions >= kCubicFunctions;
  const bool height = term >= 2 * kHigherFunctions;
  return (quartic ? 2 : 0) + (height ? 1 : 0);
}

/// The board with other higher terms h.
void setHigher(const Eigen::VectorXd& h, const std::optional<RemainderSpace>& space,
               TargetShape& shape) {
  shape.higher = h.head<kHigherTerms>();
  if (space) shape.corners = space->corners(h.tail(h.size() - kHigherTerms));
}

Eigen::VectorXd higherOf(const TargetShape& shape, const std::optional<RemainderSpace>& space) {
  Eigen::VectorXd h = Eigen::VectorXd::Zero(kHigherTerms + (space ? space->size() : 0));
  if (shape.higher) h.head<kHigherTerms>() = *shape.higher;
  if (space && shape.corners) h.tail(h.size() - kHigherTerms) = space->coordinates(*shape.corners);
  return h;
}

/// Of A^-1 = L^-T L^-1: the squares of the columns of L^-1, which begin at its diagonal.
Eigen::VectorXd inverseDiagonal(const Eigen::LLT<Eigen::MatrixXd>& llt) {
  constexpr Eigen::Index kColumns = 48;  // at a time
  const Eigen::Index n = llt.rows();
  const Eigen::MatrixXd L = llt.matrixL();
  Eigen::VectorXd diagonal(n);
  for (Eigen::Index j = 0; j < n; j += kColumns) {
    const Eigen::Index rows = n - j, width = std::min(kColumns, rows);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Identity(rows, width);
    L.bottomRightCorner(rows, rows).triangularView<Eigen::Lower>().solveInPlace(columns);
    diagonal.segment(j, width) = columns.colwise().squaredNorm();
  }
  return diagonal;
}

}  // namespace

RemainderSpace::RemainderSpace(const AprilGrid& board) {
  constexpr int kSimilarity = 4;  // in the plane: translation, scale, rotation
  constexpr int kFirst = kSimilarity + kTargetTerms;
  const int n = board.cornerCount();
  const TargetBasis terms(board);
  const HigherBasis higher(board);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(2 * n, kFirst + 2 * kHigherFunctions);
  Eigen::MatrixXd Z(n, 6 + kHigherFunctions);
  for (int id = 0; id < n; ++id) {
    // Of order one, like the functions beside them: pivots compare columns.
    const Eigen::Vector2d p = board.corner(id) / board.width();
    const Eigen::Matrix<double, 3, kTargetTerms> B = terms.columns(id);
    const Eigen::RowVectorXd phi = higher.functions(id).transpose();
    P.block<2, kSimilarity>(2 * id, 0) << 1, 0, p.x(), -p.y(), 0, 1, p.y(), p.x();
    P.block<2, kTargetTerms>(2 * id, kSimilarity) = B.topRows<2>();
    P.block<1, kHigherFunctions>(2 * id, kFirst) = phi;
    P.block<1, kHigherFunctions>(2 * id + 1, kFirst + kHigherFunctions) = phi;
    // In height translation along z and turns about x and y are the similarity's part.
    Z.row(id) << 1, p.x(), p.y(), B.block<1, 3>(2, 8), phi;
  }
  // With pivots: on a small grid columns coincide or are zero, and what the others span counts.
  plane_.compute(P);
  height_.compute(Z);
}

Eigen::MatrixXd RemainderSpace::reduced(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
  // The first rows of Q^T x are what similarity and terms explain; the last ones are orthogonal to
  // all of them.
  const Eigen::MatrixXd P = plane_.householderQ().adjoint() * rows.topRows(plane_.rows());
  const Eigen::MatrixXd Z = height_.householderQ().adjoint() * rows.bottomRows(height_.rows());
  Eigen::MatrixXd out(size(), rows.cols());
  out << P.bottomRows(plane()), Z.bottomRows(height());
  return out;
}

Eigen::VectorXd RemainderSpace::corners(const Eigen::VectorXd& coordinates) const {
  Eigen::VectorXd P = Eigen::VectorXd::Zero(plane_.rows());
  Eigen::VectorXd Z = Eigen::VectorXd::Zero(height_.rows());
  P.tail(plane()) = coordinates.head(plane());
  Z.tail(height()) = coordinates.tail(height());
  const Eigen::VectorXd in_plane = plane_.householderQ() * P;
  const Eigen::VectorXd heights = height_.householderQ() * Z;
  Eigen::Matrix3Xd out(3, Z.size());
  out << Eigen::Map<const Eigen::Matrix2Xd>(in_plane.data(), 2, Z.size()), heights.transpose();
  return out.reshaped();
}

Eigen::VectorXd RemainderSpace::coordinates(const Eigen::VectorXd& corners) const {
  const Eigen::Map<const Eigen::Matrix3Xd> d(corners.data(), 3, height_.rows());
  Eigen::VectorXd rows(corners.size());
  rows << d.topRows<2>().reshaped(), d.row(2).transpose();
  return reduced(rows).col(0);
}

// With a prior of information P = noise / variance the mean is (H + P)^-1 linear; the variance of a
// group becomes sum mean^2 / gamma, gamma = sum (1 - P V) the number of its terms that the corners,
// not the prior, determine (MacKay 1992), again and again.
HigherPosterior higherPosterior(const Eigen::MatrixXd& H, const Eigen::VectorXd& linear,
                                const HigherKnowledge& known) {
  const auto size = static_cast<int>(H.rows());
  const int given = known.prior && known.prior->given ? kHigherTerms : 0;
  const double noise = known.noise;
  const auto group = [&](int j) { return groupOf(j, known.remainders_in_plane); };
  std::array<double, kGroups> variance{};
  variance.fill(kStartStd * kStartStd);
  HigherPosterior out;
  out.prior.given = given > 0;
  out.prior.mean.setZero(size);
  out.prior.information.setZero(size);
  if (given > 0) {
    out.prior.mean.head(given) = known.prior->mean.head(given);
    out.prior.information.head(given) = known.prior->information.head(given);
  }
  for (int round = 0; round < kEvidenceRounds; ++round) {
    for (int j = given; j < size; ++j) out.prior.information[j] = noise / variance[group(j)];
    Eigen::MatrixXd A = H;
    A.diagonal() += out.prior.information;
    const Eigen::LLT<Eigen::MatrixXd> llt(A);
    const Eigen::VectorXd V = inverseDiagonal(llt);
    out.mean = llt.solve(linear + out.prior.information.cwiseProduct(out.prior.mean));
    out.std = (noise * V).cwiseMax(0).cwiseSqrt();
    std::array<double, kGroups> squares{}, determined{};
    for (int j = given; j < size; ++j) {
      squares[group(j)] += out.mean[j] * out.mean[j];
      determined[group(j)] += 1 - out.prior.information[j] * V[j];
    }
    double change = 0;
    for (std::size_t g = 0; g < kGroups; ++g) {
      const double before = variance[g];
      // Not zero: that would hold the terms there, and be found again in every round.
      variance[g] = std::max(kLeastStd * kLeastStd, squares[g] / std::max(determined[g], 1e-9));
      change = std::max(change, std::abs(variance[g] / before - 1));
    }
    if (change < kSameVariance) break;
  }
  // Of the gradient P h, h having the prior's variance noise / P: P (noise / P) P.
  out.prior.scatter = noise * out.prior.information;
  if (given > 0) out.prior.scatter.head(given) = known.prior->scatter.head(given);
  return out;
}

CameraSolution withHigherTerms(CameraProblem& problem, CameraSolution without,
                               const MinimiserOptions& solver, const HigherSteps& steps) {
  CameraSolution solution = std::move(without);
  const auto space = remainderSpaceOf(problem.target->grid, steps.detail);
  Eigen::VectorXd at = higherOf(problem.target->grid.shape, space);
  const double least = std::pow(kLeastNoisePx / problem.pixel_sigma, 2);
  for (int round = 0; round < steps.rounds; ++round) {
    const JointSystem joint = jointSystem(problem, solution.estimate, steps.detail);
    const auto covariance = covarianceOf(joint.S_gg);
    // Without it there is no saying how cameras and terms would follow h.
    if (!covariance) break;
    // One Newton step of the higher terms with everything else following, H = S_hh - S_hg S_gg^-1
    // S_gh; then the batch solves for everything else with them held.
    const Eigen::MatrixXd K = *covariance * joint.S_gh;
    const Eigen::MatrixXd H = joint.S_hh - joint.S_gh.transpose() * K;
    // K^T s_g: a rough solver stops before the minimum of cameras and terms.
    const Eigen::VectorXd g = joint.scores.rowwise().sum() - K.transpose() * joint.s_g;
    const double noise = std::max(noiseRatio(problem, solution.estimate), least);
    // H at - g: the cost about zero, not about where the terms stand, for the prior is about its
    // own mean.
    const HigherPosterior found =
        higherPosterior(H, H * at - g, {noise, problem.target->higher, space ? space->plane() : 0});
    const double step = (found.mean - at).cwiseQuotient(found.std).cwiseAbs().maxCoeff();
    // The first step is taken however short it is: with it the board gets its prior.
    if (round > 0 && step < kSettled) break;
    at = found.mean;
    auto model = std::make_shared<TargetModel>(*problem.target);
    setHigher(at, space, model->grid.shape);
    model->higher = found.prior;
    problem.target = std::move(model);
    CameraSolution next = solveCameraProblem(problem, solution.estimate, solver);
    next.iterations += solution.iterations;
    solution = std::move(next);
    if (!solution.converged) break;
  }
  return solution;
}

HigherTerms HigherShare::deviations(double noise) const {
  return (noise * V.diagonal().head<kHigherTerms>()).cwiseMax(0).cwiseSqrt();
}

Eigen::MatrixXd HigherShare::eliminatedFrom(const Eigen::MatrixXd& scores_g) const {
  return scores_g - S_gh * (V * (scores - K.transpose() * scores_g));
}

Eigen::MatrixXd HigherShare::marginalised(const Eigen::MatrixXd& information) const {
  const auto fixed = covarianceOf(information);
  if (!fixed) return information;
  const auto out = covarianceOf(*fixed + covariance);  // the inverse
  return out ? *out : information;
}

std::optional<HigherShare> higherShare(const CameraProblem& problem,
                                       const CameraEstimate& estimate) {
  if (!estimate.target || !problem.target->higher) return std::nullopt;
  const HigherPrior& prior = *problem.target->higher;
  const auto size = prior.information.size();
  JointSystem joint = jointSystem(
      problem, estimate, size > kHigherTerms ? BoardDetail::kCorners : BoardDetail::kHigher);
  const auto covariance = covarianceOf(joint.S_gg);
  if (!covariance) return std::nullopt;
  HigherShare out;
  out.K = *covariance * joint.S_gh;
  Eigen::MatrixXd A = joint.S_hh - joint.S_gh.transpose() * out.K;
  A.diagonal() += prior.information;
  out.V = A.llt().solve(Eigen::MatrixXd::Identity(size, size));
  out.S_gh = std::move(joint.S_gh);
  out.scores = std::move(joint.scores);
  const Eigen::MatrixXd KV = out.K * out.V;
  out.covariance = KV * out.K.transpose();
  out.known = KV * prior.scatter.asDiagonal() * KV.transpose();
  return out;
}

}  // namespace plumbline

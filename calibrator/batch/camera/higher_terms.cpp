// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/higher_terms.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "calibrator/base/lie.h"
#include "calibrator/base/parallel.h"
#include "calibrator/batch/camera/target.h"
#include "calibrator/camera/camera.h"
#include "calibrator/information/covariance.h"
#include "calibrator/residuals/tangent.h"

namespace plumbline {
namespace {

constexpr double kSettled = 0.1;    // last step over the terms' standard deviations
constexpr double kStartStd = 1e-4;  // of a term [m]
constexpr double kLeastStd = 1e-7;  // [m]; smaller ones change nothing
constexpr int kEvidenceRounds = 50;

using PoseHigher = Eigen::Matrix<double, 6, kHigherTerms>;
using LensPoint = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxIntrinsics, 3>;
using LensHigher =
    Eigen::Matrix<double, Eigen::Dynamic, kHigherTerms, 0, kMaxIntrinsics, kHigherTerms>;

/// X (x) phi: the columns of an axis a are X.col(a) phi^T.
template <class Out, class Columns>
void addKronecker(const Columns& X, const HigherBasis::Functions& phi, Out& out) {
  for (int axis = 0; axis < 3; ++axis) {
    out.template middleCols<kHigherFunctions>(kHigherFunctions * axis).noalias() +=
        X.col(axis).lazyProduct(phi.transpose());
  }
}

/// A corner's share: J_F = de/dp_F, weighted.
struct CornerRows {
  Projection projection;
  Eigen::Matrix<double, 2, 6> J_pose;  ///< in the twist of the camera's pose
  Eigen::Matrix<double, 2, 3> J_F;
  Eigen::Vector2d e;
  double weight = 0;
};

std::optional<CornerRows> rowsOf(const Intrinsics& lens, const Transform& T_CF,
                                 const PackedView& view, int k, const Eigen::Vector3d& p_F,
                                 double cauchy_px) {
  const Eigen::Vector3d p = T_CF * p_F;
  const auto projection = projectWithJacobians(lens, p);
  if (!projection) return std::nullopt;
  CornerRows out;
  out.projection = *projection;
  out.e = projection->uv - Eigen::Vector2d(view.u[k], view.v[k]);
  out.J_pose << projection->J_point, -projection->J_point * skew(p);
  out.J_F = projection->J_point * T_CF.R;
  const double ratio = cauchy_px > 0 ? out.e.squaredNorm() / (cauchy_px * cauchy_px) : 0;
  // rho'(s) of rho(s) = c^2 log(1 + s / c^2).
  out.weight = 1 / (1 + ratio);
  return out;
}

/// Sums over frames of one chunk, in the frames' order.
struct HigherSums {
  std::vector<Eigen::Matrix3d> M;            ///< per corner of the board: J_F^T J_F
  std::vector<Eigen::Matrix3d> M_edge;       ///< the same by tagEdgeScale()
  std::vector<std::vector<LensPoint>> lens;  ///< per camera and corner: J_k^T J_F
  std::vector<PoseHigher> pose;              ///< per camera, in its own twist

  HigherSums(int corners, const CameraLayout& layout)
      : M(static_cast<std::size_t>(corners), Eigen::Matrix3d::Zero()), M_edge(M) {
    for (const int size : layout.intrinsics_size) {
      lens.emplace_back(M.size(), LensPoint::Zero(size, 3));
      pose.emplace_back(PoseHigher::Zero());
    }
  }
  void add(const HigherSums& other) {
    for (std::size_t i = 0; i < M.size(); ++i) {
      M[i] += other.M[i];
      M_edge[i] += other.M_edge[i];
    }
    for (std::size_t c = 0; c < lens.size(); ++c) {
      for (std::size_t i = 0; i < M.size(); ++i) lens[c][i] += other.lens[c][i];
      pose[c] += other.pose[c];
    }
  }
};

/// The board's places and functions that the corners of all views share.
struct HigherBoard {
  explicit HigherBoard(const TargetModel& model, const TargetTerms& terms)
      : basis(model.basis), higher(model.grid), tag_edge(terms[kTargetTerms - 1]) {
    AprilGrid board = model.grid;
    board.shape.terms = terms;
    board.shape.terms[kTargetTerms - 1] = 0;
    points = cornerPoints(board);
  }
  Eigen::Vector3d point(int id, double edge_scale) const {
    const auto& f = basis.functions(id);
    Eigen::Vector3d p = points[static_cast<std::size_t>(id)];
    p.x() += tag_edge * edge_scale * f[TargetBasis::kEdgeX];
    p.y() += tag_edge * edge_scale * f[TargetBasis::kEdgeY];
    return p;
  }
  TargetBasis basis;
  HigherBasis higher;
  std::vector<Eigen::Vector3d> points;
  double tag_edge;
};

/// What one camera's view adds to its frame: P in the camera's twist, and the terms' gradient.
struct ViewShare {
  PoseHigher P = PoseHigher::Zero();
  HigherTerms b = HigherTerms::Zero();
};

ViewShare addHigherView(const HigherBoard& board, const Intrinsics& lens, const Transform& T_CF,
                        const PackedView& view, double cauchy_px, double frame_weight,
                        std::size_t c, HigherSums& sums) {
  ViewShare out;
  for (int k = 0; k < view.count; ++k) {
    if (!(view.w[k] > 0)) continue;
    const int id = view.id[k];
    const auto rows = rowsOf(lens, T_CF, view, k, board.point(id, view.edge[k]), cauchy_px);
    if (!rows) continue;
    const auto& phi = board.higher.functions(id);
    const Eigen::Matrix<double, 2, 3> weighted = frame_weight * rows->weight * rows->J_F;
    const Eigen::Matrix3d M = rows->J_F.transpose() * weighted;
    sums.M[static_cast<std::size_t>(id)] += M;
    sums.M_edge[static_cast<std::size_t>(id)] += view.edge[k] * M;
    addKronecker(Eigen::Matrix<double, 6, 3>(rows->J_pose.transpose() * weighted), phi, out.P);
    sums.lens[c][static_cast<std::size_t>(id)].noalias() +=
        rows->projection.J_intrinsics.transpose().lazyProduct(weighted);
    const Eigen::Vector3d gradient = weighted.transpose() * rows->e;
    for (int axis = 0; axis < 3; ++axis) {
      out.b.segment<kHigherFunctions>(kHigherFunctions * axis) += gradient[axis] * phi;
    }
  }
  sums.pose[c] += out.P;
  return out;
}

/// Everything of the higher terms in the normal equations, about an estimate.
struct HigherNormals {
  std::vector<PoseHigher> P;  ///< per frame, in the twist of T_C0F
  Eigen::MatrixXd b;          ///< their gradient, a column per frame
  Eigen::MatrixXd G_gh;       ///< with cameras and terms, in the layout's order
  Eigen::MatrixXd G_hh;
};

HigherSums sumFrames(const CameraProblem& problem, const CameraEstimate& estimate,
                     const CameraLayout& layout, const HigherBoard& board, HigherNormals& out) {
  std::vector<Transform> T_CiC0;
  std::vector<Matrix6d> chain;
  for (const Transform& T : estimate.T_C0Ci) {
    T_CiC0.push_back(T.inverse());
    chain.push_back(adjoint(T_CiC0.back()));
  }
  const int corners = board.basis.cornerCount();
  std::vector<HigherSums> parts(
      static_cast<std::size_t>(chunkCount(problem.frameCount(), kFrameChunk)),
      HigherSums(corners, layout));
  const double scale = 1 / (problem.pixel_sigma * problem.pixel_sigma);
  forChunks(problem.frameCount(), kFrameChunk, problem.threads, [&](const Chunk& chunk) {
    HigherSums& sums = parts[static_cast<std::size_t>(chunk.index)];
    for (int i = chunk.begin; i < chunk.end; ++i) {
      const auto f = static_cast<std::size_t>(i);
      for (std::size_t c = 0; c < chain.size(); ++c) {
        const int index = problem.frames[f].view[c];
        if (index < 0) continue;
        const ViewShare view =
            addHigherView(board, estimate.intrinsics[c], T_CiC0[c] * estimate.T_C0F[f],
                          problem.corners[c].view(index), problem.gram.cauchy_px,
                          scale * problem.weight(i), c, sums);
        out.P[f] += chain[c].transpose() * view.P;
        out.b.col(i) += view.b;
      }
    }
  });
  for (std::size_t i = 1; i < parts.size(); ++i) parts[0].add(parts[i]);
  return std::move(parts[0]);
}

/// The products with the cameras' parameters and the twelve terms.
void placeSums(const HigherSums& sums, const CameraEstimate& estimate, const CameraLayout& layout,
               const HigherBoard& board, HigherNormals& out) {
  for (std::size_t c = 0; c < sums.lens.size(); ++c) {
    LensHigher lens = LensHigher::Zero(layout.intrinsics_size[c], kHigherTerms);
    for (std::size_t i = 0; i < sums.M.size(); ++i) {
      addKronecker(sums.lens[c][i], board.higher.functions(static_cast<int>(i)), lens);
    }
    out.G_gh.middleRows(layout.intrinsics[c], layout.intrinsics_size[c]) = lens;
    if (c == 0) continue;
    const Eigen::Matrix3d A = -estimate.T_C0Ci[c].inverse().R;  // of twists, in the tangent
    out.G_gh.middleRows<3>(layout.T_C0Ci[c]) = A.transpose() * sums.pose[c].topRows<3>();
    out.G_gh.middleRows<3>(layout.T_C0Ci[c] + 3) = A.transpose() * sums.pose[c].bottomRows<3>();
  }
  Eigen::Matrix<double, kTargetTerms, kHigherTerms> terms;
  terms.setZero();
  for (int id = 0; id < board.basis.cornerCount(); ++id) {
    const auto i = static_cast<std::size_t>(id);
    const auto& phi = board.higher.functions(id);
    const Eigen::Matrix<double, 3, kTargetTerms> B = board.basis.columns(id);
    Eigen::Matrix<double, kTargetTerms, 3> BtM = B.transpose() * sums.M[i];
    BtM.row(kTargetTerms - 1) = B.col(kTargetTerms - 1).transpose() * sums.M_edge[i];
    addKronecker(BtM, phi, terms);
    const HigherBasis::Functions& f = phi;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        out.G_hh
            .block<kHigherFunctions, kHigherFunctions>(kHigherFunctions * a, kHigherFunctions * b)
            .noalias() += sums.M[i](a, b) * f * f.transpose();
      }
    }
  }
  out.G_gh.middleRows<kTargetTerms>(layout.target) = terms;
}

HigherNormals higherNormals(const CameraProblem& problem, const CameraEstimate& estimate) {
  const CameraLayout layout(estimate);
  const HigherBoard board(*problem.target, *estimate.target);
  HigherNormals out;
  out.P.assign(problem.frames.size(), PoseHigher::Zero());
  out.b.setZero(kHigherTerms, problem.frameCount());
  out.G_gh.setZero(layout.size, kHigherTerms);
  out.G_hh.setZero(kHigherTerms, kHigherTerms);
  const HigherSums sums = sumFrames(problem, estimate, layout, board, out);
  placeSums(sums, estimate, layout, board, out);
  return out;
}

/// Of the variances of the prior: cubic and quartic, in the plane and in height.
int groupOf(int term) {
  const bool quartic = term % kHigherFunctions >= kCubicFunctions;
  const bool height = term >= 2 * kHigherFunctions;
  return (quartic ? 2 : 0) + (height ? 1 : 0);
}

/// The terms under a prior that is given.
HigherPosterior underPrior(const HigherPrior& prior, const Eigen::MatrixXd& H,
                           const HigherTerms& linear, double noise) {
  Eigen::MatrixXd A = H;
  A.diagonal() += prior.information;
  const Eigen::LLT<Eigen::MatrixXd> llt(A);
  HigherPosterior out;
  out.mean = llt.solve(linear + prior.information.cwiseProduct(prior.mean));
  const Eigen::MatrixXd V = llt.solve(Eigen::MatrixXd::Identity(kHigherTerms, kHigherTerms));
  out.std = (noise * V.diagonal()).cwiseMax(0).cwiseSqrt();
  out.prior = prior;
  return out;
}

}  // namespace

JointSystem jointSystem(const CameraProblem& problem, const CameraEstimate& estimate) {
  // Re-weighted as the products with the higher terms are, which know no curvature of the loss.
  const CameraNormals normals = normalsAt(problem, estimate, {problem.gram.cauchy_px, 0});
  HigherNormals higher = higherNormals(problem, estimate);
  JointSystem out{normals.G, std::move(higher.G_gh), std::move(higher.G_hh), normals.b,
                  std::move(higher.b)};
  for (int i = 0; i < problem.frameCount(); ++i) {
    const auto f = static_cast<std::size_t>(i);
    const Eigen::LLT<Matrix6d> llt(normals.H[f]);
    if (llt.info() != Eigen::Success) continue;
    const Eigen::MatrixXd W_g = llt.matrixL().solve(normals.P.middleRows<6>(6 * i));
    const PoseHigher W_h = llt.matrixL().solve(higher.P[f]);
    const Vector6d w = llt.matrixL().solve(normals.b_pose.segment<6>(6 * i));
    out.S_gg.noalias() -= W_g.transpose() * W_g;
    out.S_gh.noalias() -= W_g.transpose() * W_h;
    out.S_hh.noalias() -= W_h.transpose() * W_h;
    out.s_g.noalias() -= W_g.transpose() * w;
    out.scores.col(i).noalias() -= W_h.transpose() * w;
  }
  return out;
}

// With a prior of information P = noise / variance the mean is (H + P)^-1 linear; the variance of a
// group becomes sum mean^2 / gamma, gamma = sum (1 - P V) the number of its terms that the corners,
// not the prior, determine (MacKay 1992), again and again.
HigherPosterior higherPosterior(const Eigen::MatrixXd& H, const HigherTerms& linear, double noise) {
  std::array<double, 4> variance{};
  variance.fill(kStartStd * kStartStd);
  HigherPosterior out;
  for (int round = 0; round < kEvidenceRounds; ++round) {
    for (int j = 0; j < kHigherTerms; ++j) {
      out.prior.information[j] = noise / variance[static_cast<std::size_t>(groupOf(j))];
    }
    Eigen::MatrixXd A = H;
    A.diagonal() += out.prior.information;
    const Eigen::MatrixXd V = A.llt().solve(Eigen::MatrixXd::Identity(kHigherTerms, kHigherTerms));
    out.mean = V * linear;
    out.std = (noise * V.diagonal()).cwiseMax(0).cwiseSqrt();
    std::array<double, 4> squares{}, determined{};
    for (int j = 0; j < kHigherTerms; ++j) {
      const auto group = static_cast<std::size_t>(groupOf(j));
      squares[group] += out.mean[j] * out.mean[j];
      determined[group] += 1 - out.prior.information[j] * V(j, j);
    }
    for (std::size_t group = 0; group < variance.size(); ++group) {
      variance[group] =
          std::max(kLeastStd * kLeastStd, squares[group] / std::max(determined[group], 1e-9));
    }
  }
  // Of the gradient P h, h having the prior's variance noise / P: P (noise / P) P.
  out.prior.scatter = noise * out.prior.information;
  return out;
}

CameraSolution withHigherTerms(CameraProblem& problem, CameraSolution without,
                               const MinimiserOptions& solver, int rounds) {
  CameraSolution solution = std::move(without);
  HigherTerms at = problem.target->grid.shape.higher.value_or(HigherTerms::Zero());
  for (int round = 0; round < rounds; ++round) {
    const JointSystem joint = jointSystem(problem, solution.estimate);
    const auto covariance = covarianceOf(joint.S_gg);
    if (!covariance) break;
    const Eigen::MatrixXd K = *covariance * joint.S_gh;
    const Eigen::MatrixXd H = joint.S_hh - joint.S_gh.transpose() * K;
    // K^T s_g: a rough solver stops before the minimum of cameras and terms.
    const HigherTerms g = joint.scores.rowwise().sum() - K.transpose() * joint.s_g;
    const double noise = noiseRatio(problem, solution.estimate);
    const std::optional<HigherPrior>& prior = problem.target->higher;
    const HigherPosterior found = prior && prior->given ? underPrior(*prior, H, H * at - g, noise)
                                                        : higherPosterior(H, H * at - g, noise);
    const double step = (found.mean - at).cwiseQuotient(found.std).cwiseAbs().maxCoeff();
    if (round > 0 && step < kSettled) break;
    at = found.mean;
    auto model = std::make_shared<TargetModel>(*problem.target);
    model->grid.shape.higher = at;
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
  return (noise * V.diagonal()).cwiseMax(0).cwiseSqrt();
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
  JointSystem joint = jointSystem(problem, estimate);
  const auto covariance = covarianceOf(joint.S_gg);
  if (!covariance) return std::nullopt;
  HigherShare out;
  out.K = *covariance * joint.S_gh;
  Eigen::MatrixXd A = joint.S_hh - joint.S_gh.transpose() * out.K;
  A.diagonal() += prior.information;
  out.V = A.llt().solve(Eigen::MatrixXd::Identity(kHigherTerms, kHigherTerms));
  out.S_gh = std::move(joint.S_gh);
  out.scores = std::move(joint.scores);
  const Eigen::MatrixXd KV = out.K * out.V;
  out.covariance = KV * out.K.transpose();
  out.known = KV * prior.scatter.asDiagonal() * KV.transpose();
  return out;
}

}  // namespace plumbline

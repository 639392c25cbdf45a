// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "calibrator/base/parallel.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/camera/camera.h"

namespace plumbline {
namespace {

using PoseHigher = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using LensPoint = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxIntrinsics, 3>;

/// A corner's share: J_F = de/dp_F, weighted.
struct CornerRows {
  Projection projection;
  Eigen::Matrix<double, 2, 6> J_pose;  ///< in the twist of the camera's pose
  Eigen::Matrix<double, 2, 3> J_F;
  Eigen::Vector2d e;
  double weight = 0;
};

/// Empty where the corner cannot be projected: the kernels give it no gradient either.
std::optional<CornerRows> rowsOf(const Intrinsics& lens, const Transform& T_CF,
                                 const PackedView& view, int k, const Eigen::Vector3d& p_F,
                                 double cauchy_px) {
  const Eigen::Vector3d p = T_CF * p_F;
  const auto projection = projectBeyondFold(lens, p);
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

/// Columns of the higher terms in the normal equations: the polynomials, then with remainders x, y
/// of every corner of the board, then their heights.
struct HigherColumns {
  explicit HigherColumns(const AprilGrid& board, BoardDetail detail)
      : corners(detail == BoardDetail::kCorners ? board.cornerCount() : 0),
        size(kHigherTerms + 3 * corners) {}
  int plane(int id) const { return kHigherTerms + 2 * id; }
  int height(int id) const { return kHigherTerms + 2 * corners + id; }

  /// Adds products X (n x 3) with the displacement of a corner: the columns of an axis a of the
  /// polynomials are X.col(a) phi^T, those of the corner are X.
  template <class X, class Out>
  void add(const X& x, int id, const HigherBasis::Functions& phi, Out& out) const {
    for (int axis = 0; axis < 3; ++axis) {
      out.template middleCols<kHigherFunctions>(kHigherFunctions * axis).noalias() +=
          x.col(axis).lazyProduct(phi.transpose());
    }
    if (corners == 0) return;
    out.template middleCols<2>(plane(id)) += x.template leftCols<2>();
    out.col(height(id)) += x.col(2);
  }

  int corners;  ///< of the board; 0: without remainders
  int size;
};

/// Sums over frames of one chunk, in the frames' order.
struct HigherSums {
  std::vector<Eigen::Matrix3d> M;            ///< per corner of the board: J_F^T J_F
  std::vector<Eigen::Matrix3d> M_edge;       ///< the same by tagEdgeScale()
  std::vector<std::vector<LensPoint>> lens;  ///< per camera and corner: J_k^T J_F
  std::vector<PoseHigher> pose;              ///< per camera, in its own twist

  HigherSums(int corners, int columns, const CameraLayout& layout)
      : M(corners, Eigen::Matrix3d::Zero()), M_edge(M) {
    for (const int size : layout.intrinsics_size) {
      lens.emplace_back(M.size(), LensPoint::Zero(size, 3));
      pose.emplace_back(PoseHigher::Zero(6, columns));
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
  HigherBoard(const TargetModel& model, const TargetTerms& terms, BoardDetail detail)
      : basis(model.basis),
        higher(model.grid),
        columns(model.grid, detail),
        placed(withTerms(model.grid, terms)) {}
  static AprilGrid withTerms(AprilGrid board, const TargetTerms& terms) {
    board.shape.terms = terms;
    return board;
  }
  TargetBasis basis;
  HigherBasis higher;
  HigherColumns columns;
  PlacedBoard placed;
};

/// What one camera's view adds to its frame: P in the camera's twist, and the terms' gradient.
struct ViewShare {
  PoseHigher P;
  Eigen::RowVectorXd b;
};

ViewShare addHigherView(const HigherBoard& board, const Intrinsics& lens, const Transform& T_CF,
                        const PackedView& view, double cauchy_px, double frame_weight,
                        std::size_t c, HigherSums& sums) {
  const HigherColumns& columns = board.columns;
  ViewShare out{PoseHigher::Zero(6, columns.size), Eigen::RowVectorXd::Zero(columns.size)};
  for (int k = 0; k < view.count; ++k) {
    // Weights are 0 or 1 here.
    if (!(view.w[k] > 0)) continue;
    const int id = view.id[k];
    const auto rows = rowsOf(lens, T_CF, view, k, board.placed.point(id, view.edge[k]), cauchy_px);
    if (!rows) continue;
    const auto& phi = board.higher.functions(id);
    const Eigen::Matrix<double, 2, 3> weighted = frame_weight * rows->weight * rows->J_F;
    const Eigen::Matrix3d M = rows->J_F.transpose() * weighted;
    // A corner has the same functions in all views: their products are taken once, of these sums.
    sums.M[id] += M;
    sums.M_edge[id] += view.edge[k] * M;
    columns.add(Eigen::Matrix<double, 6, 3>(rows->J_pose.transpose() * weighted), id, phi, out.P);
    sums.lens[c][id].noalias() += rows->projection.J_intrinsics.transpose().lazyProduct(weighted);
    columns.add(Eigen::RowVector3d(rows->e.transpose() * weighted), id, phi, out.b);
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

/// The sums of all frames; each frame's P and gradient go to `out`.
HigherSums sumFrames(const CameraProblem& problem, const CameraEstimate& estimate,
                     const CameraLayout& layout, const HigherBoard& board, HigherNormals& out) {
  const std::vector<CameraDerivatives> chain = derivativesOf(estimate);
  const int corners = board.basis.cornerCount();
  std::vector<HigherSums> parts(chunkCount(problem.frameCount(), kFrameChunk),
                                HigherSums(corners, board.columns.size, layout));
  const double scale = 1 / (problem.pixel_sigma * problem.pixel_sigma);
  forChunks(problem.frameCount(), kFrameChunk, problem.threads, [&](const Chunk& chunk) {
    HigherSums& sums = parts[chunk.index];
    for (int f = chunk.begin; f < chunk.end; ++f) {
      for (std::size_t c = 0; c < chain.size(); ++c) {
        const int index = problem.frames[f].view[c];
        if (index < 0) continue;
        const ViewShare view =
            addHigherView(board, estimate.intrinsics[c], chain[c].T_CiC0 * estimate.T_C0F[f],
                          problem.corners[c].view(index), problem.gram.cauchy_px,
                          scale * problem.weight(f), c, sums);
        out.P[f] += chain[c].A_pose.transpose() * view.P;
        out.b.col(f) += view.b.transpose();
      }
    }
  });
  // In the order of the chunks, so that no sum depends on the threads.
  for (std::size_t i = 1; i < parts.size(); ++i) parts[0].add(parts[i]);
  return std::move(parts[0]);
}

/// The products with the cameras' parameters and the twelve terms.
void placeSums(const HigherSums& sums, const CameraEstimate& estimate, const CameraLayout& layout,
               const HigherBoard& board, HigherNormals& out) {
  for (std::size_t c = 0; c < sums.lens.size(); ++c) {
    auto lens = out.G_gh.middleRows(layout.intrinsics[c], layout.intrinsics_size[c]);
    for (int id = 0; id < board.basis.cornerCount(); ++id) {
      board.columns.add(sums.lens[c][id], id, board.higher.functions(id), lens);
    }
    if (c == 0) continue;
    const Eigen::Matrix3d A = -estimate.T_C0Ci[c].inverse().R;  // of twists, in the tangent
    out.G_gh.middleRows<3>(layout.T_C0Ci[c]) = A.transpose() * sums.pose[c].topRows<3>();
    out.G_gh.middleRows<3>(layout.T_C0Ci[c] + 3) = A.transpose() * sums.pose[c].bottomRows<3>();
  }
  auto terms = out.G_gh.middleRows<kTargetTerms>(layout.target);
  for (int id = 0; id < board.basis.cornerCount(); ++id) {
    const auto& phi = board.higher.functions(id);
    const Eigen::Matrix<double, 3, kTargetTerms> B = board.basis.columns(id);
    Eigen::Matrix<double, kTargetTerms, 3> BtM = B.transpose() * sums.M[id];
    // tag_edge alone has another column in every view, by the size at which it shows the tag.
    BtM.row(kTargetTerms - 1) = B.col(kTargetTerms - 1).transpose() * sums.M_edge[id];
    board.columns.add(BtM, id, phi, terms);
    Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(3, board.columns.size);  // of the displacement
    board.columns.add(Eigen::Matrix3d::Identity(), id, phi, Q);
    const auto polynomials = Q.leftCols<kHigherTerms>();
    // Blocks of other corners stay zero: before the poses are eliminated a corner's remainder meets
    // no other's.
    out.G_hh.topLeftCorner<kHigherTerms, kHigherTerms>() +=
        polynomials.transpose() * sums.M[id] * polynomials;
    if (board.columns.corners == 0) continue;
    const std::array<int, 3> at{board.columns.plane(id), board.columns.plane(id) + 1,
                                board.columns.height(id)};
    for (int a = 0; a < 3; ++a) {
      out.G_hh.col(at[a]).head<kHigherTerms>() = polynomials.transpose() * sums.M[id].col(a);
      out.G_hh.row(at[a]).head<kHigherTerms>() = sums.M[id].row(a) * polynomials;
      for (int b = 0; b < 3; ++b) out.G_hh(at[a], at[b]) = sums.M[id](a, b);
    }
  }
}

HigherNormals higherNormals(const CameraProblem& problem, const CameraEstimate& estimate,
                            BoardDetail detail) {
  const CameraLayout layout(estimate);
  const HigherBoard board(*problem.target, *estimate.target, detail);
  const int size = board.columns.size;
  HigherNormals out;
  out.P.assign(problem.frames.size(), PoseHigher::Zero(6, size));
  out.b.setZero(size, problem.frameCount());
  out.G_gh.setZero(layout.size, size);
  out.G_hh.setZero(size, size);
  const HigherSums sums = sumFrames(problem, estimate, layout, board, out);
  placeSums(sums, estimate, layout, board, out);
  return out;
}

/// Rows in the order of HigherColumns become those of the polynomials and of the coordinates.
Eigen::MatrixXd reducedRows(const RemainderSpace& space, const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd out(kHigherTerms + space.size(), rows.cols());
  out << rows.topRows<kHigherTerms>(), space.reduced(rows.bottomRows(rows.rows() - kHigherTerms));
  return out;
}

}  // namespace

std::optional<RemainderSpace> remainderSpaceOf(const AprilGrid& board, BoardDetail detail) {
  if (detail != BoardDetail::kCorners) return std::nullopt;
  return RemainderSpace(board);
}

JointSystem jointSystem(const CameraProblem& problem, const CameraEstimate& estimate,
                        BoardDetail detail) {
  // Re-weighted as the products with the higher terms are, which know no curvature of the loss.
  const CameraNormals normals = normalsAt(problem, estimate, {problem.gram.cauchy_px, 0});
  HigherNormals higher = higherNormals(problem, estimate, detail);
  JointSystem out{normals.G, std::move(higher.G_gh), std::move(higher.G_hh), normals.b,
                  std::move(higher.b)};
  // The frames of a chunk stand below each other: one product of matrices in place of many small.
  Eigen::MatrixXd W_g, W_h;
  Eigen::VectorXd w;
  for (int first = 0; first < problem.frameCount(); first += kFrameChunk) {
    const int count = std::min(kFrameChunk, problem.frameCount() - first);
    W_g.setZero(6 * count, out.S_gg.cols());
    W_h.setZero(6 * count, out.S_hh.cols());
    w.setZero(6 * count);
    for (int k = 0; k < count; ++k) {
      const int f = first + k;
      const PoseElimination R(normals.H[f]);
      // S = G - P^T H^-1 P by W = R P, R^T R = H^-1.
      W_g.middleRows<6>(6 * k) = R * normals.P.middleRows<6>(6 * f);
      W_h.middleRows<6>(6 * k) = R * higher.P[f];
      w.segment<6>(6 * k) = R * normals.b_pose.segment<6>(6 * f);
      // s_h of a frame less what its pose takes up.
      out.scores.col(f).noalias() -= W_h.middleRows<6>(6 * k).transpose() * w.segment<6>(6 * k);
    }
    out.S_gg.noalias() -= W_g.transpose() * W_g;
    out.S_gh.noalias() -= W_g.transpose() * W_h;
    out.S_hh.noalias() -= W_h.transpose() * W_h;
    out.s_g.noalias() -= W_g.transpose() * w;
  }
  if (const auto space = remainderSpaceOf(problem.target->grid, detail)) {
    // From displacements of corners to coordinates of the space, on both sides of S_hh.
    out.S_gh = reducedRows(*space, out.S_gh.transpose()).transpose();
    out.S_hh = reducedRows(*space, reducedRows(*space, out.S_hh).transpose());
    out.scores = reducedRows(*space, out.scores);
  }
  return out;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/problem.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "calibrator/base/parallel.h"
#include "calibrator/dense/decompositions.h"

namespace plumbline {
namespace {

/// H * diag(A, A) without the zeros.
template <class Rows>
Eigen::Matrix<double, Rows::RowsAtCompileTime, 6> timesTwice(const Rows& H,
                                                             const Eigen::Matrix3d& A) {
  Eigen::Matrix<double, Rows::RowsAtCompileTime, 6> out(H.rows(), 6);
  out.template leftCols<3>().noalias() = H.template leftCols<3>().lazyProduct(A);
  out.template rightCols<3>().noalias() = H.template rightCols<3>().lazyProduct(A);
  return out;
}

/// Sums over frames of one chunk: per camera, in its own twist, so that the chain to the tangent of
/// T_C0Ci is applied once instead of once per frame.
struct CameraSums {
  TargetViewGram gram;
  bool target;
  CameraSums(int intrinsics, bool with_target) : target(with_target) {
    // Pose rows are the camera's own twist: summed over frames they serve T_C0Ci, which acts on all
    // of them; those of the frames' poses are placed by addFrame().
    gram.H_pose_k.setZero(6, intrinsics);
    gram.H_k.setZero(intrinsics, intrinsics);
    gram.b_k.setZero(intrinsics);
    gram.H_pose_s.setZero();
    gram.H_k_s.setZero(intrinsics, kTargetTerms);
    gram.H_s.setZero();
    gram.b_s.setZero();
  }
  void add(const TargetViewGram& g, double weight) {
    gram.H += weight * g.H;
    gram.b += weight * g.b;
    gram.H_pose_k += weight * g.H_pose_k;
    gram.H_k += weight * g.H_k;
    gram.b_k += weight * g.b_k;
    gram.cost += weight * g.cost;
    if (!target) return;
    gram.H_pose_s += weight * g.H_pose_s;
    gram.H_k_s += weight * g.H_k_s;
    gram.H_s += weight * g.H_s;
    gram.b_s += weight * g.b_s;
  }
};

std::vector<CameraSums> emptySums(const CameraLayout& layout) {
  std::vector<CameraSums> sums;
  for (const int size : layout.intrinsics_size) sums.emplace_back(size, layout.target >= 0);
  return sums;
}

/// The corners of a board with given terms, and the columns of a view on it: places x y z in F,
/// then the functions of the basis.
class PlacedTarget {
 public:
  PlacedTarget(const TargetModel& model, const TargetTerms& terms)
      : tag_edge_(terms[kTargetTerms - 1]) {
    AprilGrid board = model.grid;
    board.shape.terms = terms;
    board.shape.terms[kTargetTerms - 1] = 0;  // the tags' edges depend on the view
    const std::vector<Eigen::Vector3d> points = cornerPoints(board);
    for (std::size_t id = 0; id < points.size(); ++id) {
      std::array<double, kColumns> row{};
      std::copy_n(points[id].data(), 3, row.begin());
      const auto& functions = model.basis.functions(static_cast<int>(id));
      std::copy(functions.begin(), functions.end(), row.begin() + 3);
      rows_.push_back(row);
    }
  }

  /// The view with its corners on this board; `columns` is the memory of both.
  PackedView place(PackedView view, std::vector<double>& columns, TargetColumns& target) const {
    const int n = view.padded;
    columns.resize(kColumns * n);
    for (int j = 0; j < n; ++j) {
      const auto& row = rows_[view.id[j]];
      for (std::size_t i = 0; i < kColumns; ++i) columns[i * n + j] = row[i];
      for (std::size_t axis = 0; axis < 2; ++axis) {
        // The function at the size at which this view shows the tag: tag_edge's column, and times
        // the term what it moves the corner by.
        double& edge = columns[(3 + TargetBasis::kEdgeX + axis) * n + j];
        edge *= view.edge[j];
        columns[axis * n + j] += tag_edge_ * edge;
      }
    }
    view.x = columns.data();
    view.y = view.x + n;
    view.z = view.y + n;
    for (std::size_t i = 0; i < TargetBasis::kFunctions; ++i) {
      target.function[i] = columns.data() + (3 + i) * n;
    }
    return view;
  }

 private:
  static constexpr std::size_t kColumns = 3 + TargetBasis::kFunctions;
  std::vector<std::array<double, kColumns>> rows_;
  double tag_edge_;
};

/// Everything that the evaluation of a frame reads.
struct Evaluation {
  const CameraProblem& problem;
  const CameraEstimate& estimate;
  const CameraLayout& layout;
  const std::vector<CameraDerivatives>& derivatives;
  const GramOptions& gram;
  const std::optional<PlacedTarget>& target;
};

/// Terms of a frame's views, one per camera that has one, and the pose's block of them.
struct FrameTerms {
  std::vector<TargetViewGram> grams;  ///< without their last part where the board is fixed
  Matrix6d H;
  std::vector<double> columns;  ///< memory of PlacedTarget::place()
};

void evaluateView(const Evaluation& at, std::size_t c, const Transform& T_CiF,
                  const PackedView& view, const GramOptions& gram, FrameTerms& terms) {
  TargetViewGram& g = terms.grams[c];
  const Intrinsics& lens = at.estimate.intrinsics[c];
  if (!at.target) {
    // What is left of `g` has no reader where the board is fixed.
    static_cast<ViewGram&>(g) = viewGram(lens, T_CiF, view, gram);
    return;
  }
  TargetColumns columns{};
  // It reads terms.columns, until the next view is placed there.
  const PackedView placed = at.target->place(view, terms.columns, columns);
  g = targetViewGram(lens, T_CiF, placed, columns, gram);
}

void evaluateFrame(const Evaluation& at, std::size_t f, const GramOptions& gram,
                   FrameTerms& terms) {
  const Frame& frame = at.problem.frames[f];
  terms.grams.resize(frame.view.size());
  terms.H.setZero();
  for (std::size_t c = 0; c < frame.view.size(); ++c) {
    if (frame.view[c] < 0) continue;
    const CameraDerivatives& d = at.derivatives[c];
    // Camera 0's twist is the frame's own, without an adjoint in between.
    const Transform T_CiF = c == 0 ? at.estimate.T_C0F[f] : d.T_CiC0 * at.estimate.T_C0F[f];
    evaluateView(at, c, T_CiF, at.problem.corners[c].view(frame.view[c]), gram, terms);
    const ViewGram& g = terms.grams[c];
    if (c == 0) {
      terms.H += g.H;
    } else {
      const Matrix6d AtH = d.A_pose.transpose().lazyProduct(g.H);
      terms.H.noalias() += AtH.lazyProduct(d.A_pose);
    }
  }
}

/// Adds one frame: its own rows in `out`, its cameras' terms in `sums`. Where the loss' whole
/// second derivative leaves the pose without a minimum, this frame is content with re-weighting.
void addFrame(const Evaluation& at, int f, FrameTerms& terms, CameraNormals& out,
              std::vector<CameraSums>& sums) {
  const Frame& frame = at.problem.frames[f];
  evaluateFrame(at, f, at.gram, terms);
  if (at.gram.triggs_clamp > 0 && Eigen::LLT<Matrix6d>(terms.H).info() != Eigen::Success) {
    evaluateFrame(at, f, GramOptions{at.gram.cauchy_px, 0}, terms);
  }
  // The Gram matrices are in pixels: here they get the unit of the cost.
  const double weight = at.problem.weight(f) / (at.problem.pixel_sigma * at.problem.pixel_sigma);
  out.H[f] = weight * terms.H;
  auto b = out.b_pose.segment<6>(6 * f);
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (frame.view[c] < 0) continue;
    const TargetViewGram& g = terms.grams[c];
    const CameraDerivatives& d = at.derivatives[c];
    sums[c].add(g, weight);
    if (at.layout.target >= 0) {
      out.P.block<6, kTargetTerms>(6 * f, at.layout.target) +=
          weight * (c == 0 ? g.H_pose_s : d.A_pose.transpose() * g.H_pose_s);
    }
    auto P_k = out.P.block(6 * f, at.layout.intrinsics[c], 6, at.layout.intrinsics_size[c]);
    if (c == 0) {
      b += weight * g.b;
      P_k = weight * g.H_pose_k;
      continue;
    }
    const Matrix6d At = weight * d.A_pose.transpose();
    b.noalias() += At.lazyProduct(g.b);
    P_k.noalias() = At.lazyProduct(g.H_pose_k);
    // Pose and T_C0Ci act alike, by the camera's twist: its H between their chains.
    out.P.block<6, 6>(6 * f, at.layout.T_C0Ci[c]) = timesTwice(Matrix6d(At.lazyProduct(g.H)), d.A);
  }
}

/// Camera c's terms into the cameras' part.
void addCamera(const TargetViewGram& g, const CameraDerivatives& d, const CameraLayout& layout,
               std::size_t c, CameraNormals& out) {
  const int k = layout.intrinsics[c];
  const int n = layout.intrinsics_size[c];
  out.G.block(k, k, n, n) += g.H_k;
  out.b.segment(k, n) += g.b_k;
  out.cost += 0.5 * g.cost;
  const int s = layout.target;
  if (s >= 0) {
    out.G.block<kTargetTerms, kTargetTerms>(s, s) += g.H_s;
    out.b.segment<kTargetTerms>(s) += g.b_s;
    out.G.block(k, s, n, kTargetTerms) += g.H_k_s;
    out.G.block(s, k, kTargetTerms, n) += g.H_k_s.transpose();
  }
  if (c == 0) return;
  const int e = layout.T_C0Ci[c];
  // T_C0Ci moves the target in every frame as a twist of the camera would: the chain is applied to
  // the sum.
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = d.A;
  A.bottomRightCorner<3, 3>() = d.A;
  out.G.block<6, 6>(e, e) += A.transpose() * g.H * A;
  out.b.segment<6>(e) += A.transpose() * g.b;
  const Eigen::MatrixXd cross = A.transpose() * g.H_pose_k;
  out.G.block(e, k, 6, n) += cross;
  out.G.block(k, e, n, 6) += cross.transpose();
  if (s < 0) return;
  const Eigen::Matrix<double, 6, kTargetTerms> with_target = A.transpose() * g.H_pose_s;
  out.G.block<6, kTargetTerms>(e, s) += with_target;
  out.G.block<kTargetTerms, 6>(s, e) += with_target.transpose();
}

void addTargetPrior(const CameraProblem& problem, const CameraEstimate& estimate,
                    const CameraLayout& layout, CameraNormals& out) {
  const TargetModel& model = *problem.target;
  const TargetTerms gradient = model.priorGradient(*estimate.target);
  out.G.block<kTargetTerms, kTargetTerms>(layout.target, layout.target) += model.information;
  out.b.segment<kTargetTerms>(layout.target) += gradient;
  out.cost += 0.5 * gradient.dot(*estimate.target - model.mean);
}

constexpr double kFreePose = 1e-12;  // share of a pose's information that is rounding

}  // namespace

std::vector<CameraDerivatives> derivativesOf(const CameraEstimate& estimate) {
  std::vector<CameraDerivatives> all;
  for (const Transform& T_C0Ci : estimate.T_C0Ci) {
    const Transform T_CiC0 = T_C0Ci.inverse();
    // Both adjoint and tangent have a lever arm (view_gram.h), and of T_C0Ci itself they cancel.
    all.push_back({T_CiC0, adjoint(T_CiC0), -T_CiC0.R});
  }
  return all;
}

bool isDetermined(const Matrix6d& H, const Eigen::LLT<Matrix6d>& llt) {
  if (llt.info() != Eigen::Success) return false;
  // Over the diagonal they are those of H scaled to a unit diagonal.
  const Vector6d pivots = llt.matrixLLT().diagonal().cwiseAbs2();
  return (pivots.array() >= kFreePose * H.diagonal().array()).all();
}

PoseElimination::PoseElimination(const Matrix6d& H) : llt_(H) {
  if (isDetermined(H, llt_)) return;
  // By a unit diagonal: rotations and translations have no common unit, and rounding is judged by
  // shares.
  Vector6d scale = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) {
    if (H(i, i) > 0) scale[i] = 1 / std::sqrt(H(i, i));
  }
  const SymmetricEigen eigen = symmetricEigen(scale.asDiagonal() * H * scale.asDiagonal());
  Vector6d root = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) {
    if (eigen.values[i] > kFreePose) root[i] = 1 / std::sqrt(eigen.values[i]);
  }
  R_ = root.asDiagonal() * eigen.vectors.transpose() * scale.asDiagonal();
}

Eigen::MatrixXd PoseElimination::operator*(const Eigen::Ref<const Eigen::MatrixXd>& P) const {
  assert(P.rows() == 6);
  return R_ ? Eigen::MatrixXd(*R_ * P) : Eigen::MatrixXd(llt_.matrixL().solve(P));
}

CameraEstimate estimateOf(const std::vector<CameraCalibration>& cameras,
                          std::span<const Transform> T_FC0) {
  CameraEstimate estimate;
  for (const CameraCalibration& camera : cameras) {
    estimate.intrinsics.push_back(camera.intrinsics);
    estimate.T_C0Ci.push_back(camera.T_C0Ci);
  }
  for (const Transform& T : T_FC0) estimate.T_C0F.push_back(T.inverse());
  return estimate;
}

CameraLayout::CameraLayout(const std::vector<Intrinsics>& cameras) {
  for (const Intrinsics& camera : cameras) {
    intrinsics.push_back(size);
    intrinsics_size.push_back(
        static_cast<int>(camera.projection.size() + camera.distortion.size()));
    size += intrinsics_size.back();
  }
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    // T_C0C0 is the identity, and no parameter.
    T_C0Ci.push_back(c == 0 ? -1 : size);
    if (c > 0) size += 6;
  }
}

CameraLayout::CameraLayout(const CameraEstimate& estimate) : CameraLayout(estimate.intrinsics) {
  if (!estimate.target) return;
  target = size;
  size += kTargetTerms;
}

Eigen::VectorXd cameraDifference(const CameraEstimate& to, const CameraEstimate& from) {
  assert(!from.target || to.target);
  const CameraLayout layout(from);
  Eigen::VectorXd d(layout.size);
  for (std::size_t c = 0; c < from.intrinsics.size(); ++c) {
    d.segment(layout.intrinsics[c], layout.intrinsics_size[c]) =
        to.intrinsics[c].stacked() - from.intrinsics[c].stacked();
    if (c > 0) d.segment<6>(layout.T_C0Ci[c]) = boxminus(to.T_C0Ci[c], from.T_C0Ci[c]);
  }
  if (from.target) d.tail<kTargetTerms>() = *to.target - *from.target;
  return d;
}

CameraNormals normalsAt(const CameraProblem& problem, const CameraEstimate& estimate) {
  return normalsAt(problem, estimate, problem.gram);
}

CameraNormals normalsAt(const CameraProblem& problem, const CameraEstimate& estimate,
                        const GramOptions& gram) {
  assert(static_cast<int>(estimate.T_C0F.size()) == problem.frameCount());
  assert(!estimate.target || problem.target);
  const CameraLayout layout(estimate);
  const auto derivatives = derivativesOf(estimate);
  std::optional<PlacedTarget> target;
  if (estimate.target) target.emplace(*problem.target, *estimate.target);
  const Evaluation at{problem, estimate, layout, derivatives, gram, target};
  const int frames = problem.frameCount();
  CameraNormals out;
  out.H.assign(frames, Matrix6d::Zero());
  out.P.setZero(6 * frames, layout.size);
  out.b_pose.setZero(6 * frames);
  out.G.setZero(layout.size, layout.size);
  out.b.setZero(layout.size);
  std::vector<std::vector<CameraSums>> sums(chunkCount(frames, kFrameChunk), emptySums(layout));
  forChunks(frames, kFrameChunk, problem.threads, [&](const Chunk& chunk) {
    FrameTerms terms;
    for (int f = chunk.begin; f < chunk.end; ++f) addFrame(at, f, terms, out, sums[chunk.index]);
  });
  std::vector<CameraSums> total = emptySums(layout);
  // Chunk by chunk in their order, so that no sum depends on the threads.
  for (const auto& part : sums) {
    for (std::size_t c = 0; c < total.size(); ++c) total[c].add(part[c].gram, 1);
  }
  for (std::size_t c = 0; c < total.size(); ++c) {
    addCamera(total[c].gram, derivatives[c], layout, c, out);
  }
  if (estimate.target) addTargetPrior(problem, estimate, layout, out);
  if (problem.prior) {
    const QuadraticCost prior = problem.prior(estimate);
    out.G += prior.H;
    out.b += prior.b;
    out.cost += prior.c;
  }
  return out;
}

std::vector<Eigen::MatrixXd> frameInformation(const CameraProblem& problem,
                                              const CameraEstimate& estimate) {
  std::vector<Eigen::MatrixXd> shares(problem.frames.size());
  CameraProblem inner = problem;
  // One frame is one chunk: threads would find nothing to share.
  inner.threads = 1;
  // Each frame as a problem of its own; what is known beforehand is no frame's.
  inner.prior = nullptr;
  CameraEstimate at = estimate;
  for (std::size_t f = 0; f < shares.size(); ++f) {
    inner.frames = {problem.frames[f]};
    inner.weights = {problem.weight(static_cast<int>(f))};
    at.T_C0F = {estimate.T_C0F[f]};
    shares[f] = reducedInformation(normalsAt(inner, at));
    if (!at.target) continue;
    shares[f].bottomRightCorner<kTargetTerms, kTargetTerms>() -= problem.target->information;
  }
  return shares;
}

Eigen::MatrixXd reducedInformation(const CameraNormals& normals) {
  // G less P^T H^-1 P of every frame; the frames have nothing in common but the cameras.
  Eigen::MatrixXd S = normals.G;
  for (std::size_t f = 0; f < normals.H.size(); ++f) {
    const Eigen::MatrixXd W = PoseElimination(normals.H[f]) * normals.P.middleRows<6>(6 * f);
    S -= W.transpose() * W;
  }
  return S;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/view_terms.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrator/base/parallel.h"

namespace plumbline {
namespace {

// Of cellWeights(): the bounds keep a cell with a corner or two from outweighing the image.
constexpr double kSeenRaised = 0.06;  // kappa
constexpr double kSeenMost = 50;
constexpr double kImageMost = 20;
constexpr double kLeastHalf = 1;  // of a box [px]
constexpr int kUseChunk = 4;      // frames

}  // namespace

int CornerCells::cellOf(double u, double v, const Resolution& image) {
  const auto place = [](double x, int size, int count) {
    // The image begins half a pixel before the centre of its first one.
    return std::clamp(static_cast<int>((x + 0.5) * count / size), 0, count - 1);
  };
  return place(v, image.height, kRows) * kColumns + place(u, image.width, kColumns);
}

/// Sums of one frame: H of the pose; X = [P | C | b] its 6 rows against the parameters, the fields
/// and the residuals; and G, C, D, s of the parameters and fields themselves. Products over six
/// rows or fewer are taken coefficient by coefficient: blocks for the cache cost more than they
/// save.
class ViewTermsMaker::Sum {
 public:
  explicit Sum(const ViewTermsMaker& maker)
      : maker_(maker), n_(maker.layout_.camerasSize()), K_(maker.field_.size()) {
    H_.setZero();
    X_.setZero(6, n_ + K_ + 1);
    out_.I.setZero(n_, n_);
    out_.C.setZero(n_, K_);
  }

  void keepSquares() {
    squares_ = true;
    out_.D.setZero(K_, K_);
    out_.s.setZero(K_);
  }

  void add(std::size_t c, const FieldGram& g) {
    const CameraLayout& layout = maker_.layout_;
    const int k = layout.intrinsics[c];
    const int size = layout.intrinsics_size[c];
    out_.I.block(k, k, size, size) += g.H_k;
    if (c == 0) {
      H_ += g.H;
      X_.middleCols(k, size) += g.H_pose_k;
      X_.col(n_ + K_) += g.b;
      addFields(c, g, Matrix6d::Identity(), -1);
      return;
    }
    // T_CiF = T_CiC0 T_C0F: its twist is A d + E e, e the tangent of T_C0Ci.
    const Matrix6d& A = maker_.derivatives_[c].A_pose;
    const int e = layout.T_C0Ci[c];
    Matrix6d E = Matrix6d::Zero();
    E.topLeftCorner<3, 3>() = E.bottomRightCorner<3, 3>() = maker_.derivatives_[c].A;
    const Matrix6d AtH = A.transpose() * g.H;
    H_.noalias() += AtH * A;
    X_.middleCols(k, size) += A.transpose().lazyProduct(g.H_pose_k);
    X_.middleCols<6>(e).noalias() += AtH * E;
    X_.col(n_ + K_).noalias() += A.transpose() * g.b;
    out_.I.block<6, 6>(e, e).noalias() += E.transpose() * g.H * E;
    const Eigen::MatrixXd cross = E.transpose().lazyProduct(g.H_pose_k);
    out_.I.block(e, k, 6, size) += cross;
    out_.I.block(k, e, size, 6) += cross.transpose();
    addFields(c, g, A, e);
  }

  /// Without the pose; says nothing where that is free.
  ViewTerms finish() && {
    const Eigen::LLT<Matrix6d> llt(H_);
    if (!isDetermined(H_, llt)) {
      for (Eigen::MatrixXd* sum : {&out_.I, &out_.C, &out_.D}) sum->setZero();
      out_.s.setZero();
      // Without corners it is no frame of the selection (fittingFrames()).
      out_.squared_px = out_.corners = 0;
      return std::move(out_);
    }
    const Matrix6d L_inverse = llt.matrixL().solve(Matrix6d::Identity());
    // H = L L^T: products of columns of L^-1 X are X^T H^-1 X, what the pose takes away.
    const SixRows Y = L_inverse.lazyProduct(X_);
    const auto P = Y.leftCols(n_);
    const auto F = Y.middleCols(n_, K_);
    out_.I -= P.transpose().lazyProduct(P);
    out_.C -= P.transpose().lazyProduct(F);
    if (squares_) {
      out_.D.noalias() -= F.transpose() * F;
      out_.s.noalias() -= F.transpose() * Y.col(n_ + K_);
    }
    return std::move(out_);
  }

  void count(double squared_px, double corners) {
    out_.squared_px += squared_px;
    out_.corners += corners;
  }

 private:
  using SixRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  void addFields(std::size_t c, const FieldGram& g, const Matrix6d& A, int e) {
    const MisfitField& field = maker_.field_;
    // Combinations are over all cameras and share their columns; without, each camera has its own.
    const bool combined = field.columns.size() > 0;
    const Eigen::Index at = combined ? 0 : c * kFieldColumns;
    const Eigen::Index columns = g.H_k_f.cols();
    out_.C.block(maker_.layout_.intrinsics[c], at, g.H_k_f.rows(), columns) += g.H_k_f;
    auto X = X_.middleCols(n_ + at, columns);
    if (e < 0) {
      X += g.H_pose_f;
    } else {
      X += A.transpose().lazyProduct(g.H_pose_f);
      const Eigen::Matrix3d& R = maker_.derivatives_[c].T_CiC0.R;
      out_.C.block(e, at, 3, columns) -= R.transpose().lazyProduct(g.H_pose_f.topRows<3>());
      out_.C.block(e + 3, at, 3, columns) -= R.transpose().lazyProduct(g.H_pose_f.bottomRows<3>());
    }
    if (!squares_) return;
    if (combined) return addSquares(g, field.ofCamera(c));
    for (int row = 0; row < 2; ++row) {
      // The same functions along u and along v: one block serves both.
      const Eigen::Index f = at + row * kFieldFunctions;
      out_.D.block<kFieldFunctions, kFieldFunctions>(f, f) += g.H_f;
    }
    out_.s.segment<kFieldColumns>(at) += g.b_f;
  }

  /// D and s of combinations R of the columns: R^T diag(H_f, H_f) R.
  void addSquares(const FieldGram& g, const Eigen::Ref<const Eigen::MatrixXd>& R) {
    for (int row = 0; row < 2; ++row) {
      const auto half = R.middleRows(row * kFieldFunctions, kFieldFunctions);
      const Eigen::MatrixXd weighted = g.H_f * half;
      out_.D.noalias() += half.transpose() * weighted;
    }
    out_.s.noalias() += R.transpose() * g.b_f;
  }

  const ViewTermsMaker& maker_;
  Eigen::Index n_, K_;
  Matrix6d H_;
  SixRows X_;
  ViewTerms out_;
  bool squares_ = false;
};

ViewTermsMaker::ViewTermsMaker(const CameraEstimate& cameras, MisfitField field, double cauchy_px)
    : cameras_(cameras),
      layout_(cameras.intrinsics),
      field_(std::move(field)),
      cauchy_px_(cauchy_px),
      derivatives_(derivativesOf(cameras)) {
  assert(field_.boxes.size() == cameras.intrinsics.size());
}

ViewTerms ViewTermsMaker::seen(const RigView& frame, std::span<const double> cell_weights) const {
  Sum sum(*this);
  sum.keepSquares();
  std::vector<double> roots;
  for (std::size_t c = 0; c < frame.views.size(); ++c) {
    PackedView view = frame.views[c];
    if (view.count == 0) continue;
    const double used = view.used();
    if (!cell_weights.empty()) {
      // A view's weights multiply residuals: squares get the cell's weight by its root.
      roots.assign(view.w, view.w + view.padded);
      for (int k = 0; k < view.count; ++k) {
        const int cell =
            CornerCells::cellOf(view.u[k], view.v[k], cameras_.intrinsics[c].resolution);
        roots[k] *= std::sqrt(cell_weights[c * CornerCells::kCount + cell]);
      }
      view.w = roots.data();
    }
    // Re-weighted (clamp 0): with the loss' own curvature a frame's information might be
    // indefinite.
    const FieldGram g =
        fieldGram(cameras_.intrinsics[c], derivatives_[c].T_CiC0 * frame.T_C0F, view,
                  field_.boxes[c], FieldSquares::kKeep, {cauchy_px_, 0}, field_.ofCamera(c));
    sum.add(c, g);
    sum.count(g.squared_error, used);
  }
  return std::move(sum).finish();
}

ViewTerms ViewTermsMaker::imagined(const RigView& frame) const {
  Sum sum(*this);
  for (std::size_t c = 0; c < frame.views.size(); ++c) {
    const PackedView& view = frame.views[c];
    if (view.count == 0) continue;
    sum.add(c, fieldGram(cameras_.intrinsics[c], derivatives_[c].T_CiC0 * frame.T_C0F, view,
                         field_.boxes[c], FieldSquares::kDrop, {0, 0}, field_.ofCamera(c)));
    sum.count(0, view.count);
  }
  return std::move(sum).finish();
}

std::vector<double> cellWeights(const std::vector<RigView>& frames, const CameraEstimate& cameras,
                                LaterUseKind kind) {
  std::vector<double> weights(cameras.intrinsics.size() * CornerCells::kCount, 0);
  double corners = 0;
  for (const RigView& frame : frames) {
    for (std::size_t c = 0; c < frame.views.size(); ++c) {
      const PackedView& view = frame.views[c];
      for (int k = 0; k < view.count; ++k) {
        const int cell =
            CornerCells::cellOf(view.u[k], view.v[k], cameras.intrinsics[c].resolution);
        // By weight, so that rejected corners make no cell look seen.
        weights[c * CornerCells::kCount + cell] += view.w[k];
        corners += view.w[k];
      }
    }
  }
  // Over all cells of all cameras, those without corners included.
  const double mean = corners / static_cast<double>(weights.size());
  for (double& w : weights) {
    // A cell without corners has none that it could weigh.
    const double q = w > 0 ? mean / w : 0;
    w = kind == LaterUseKind::kSeen ? 1 + kSeenRaised * std::min(q, kSeenMost)
                                    : std::min(q, kImageMost);
  }
  return weights;
}

std::vector<FieldBox> seenBoxes(const std::vector<RigView>& frames, const CameraEstimate& cameras) {
  std::vector<FieldBox> boxes;
  for (std::size_t c = 0; c < cameras.intrinsics.size(); ++c) {
    const Resolution& image = cameras.intrinsics[c].resolution;
    const double most = std::numeric_limits<double>::infinity();
    Eigen::Array2d low(most, most), high(-most, -most);
    for (const RigView& frame : frames) {
      const PackedView& view = frame.views[c];
      for (int k = 0; k < view.count; ++k) {
        // A gross error far outside would stretch the box, and with it the functions over it.
        if (!(view.w[k] > 0)) continue;
        low = low.min(Eigen::Array2d(view.u[k], view.v[k]));
        high = high.max(Eigen::Array2d(view.u[k], view.v[k]));
      }
    }
    // No corner: the whole image, from edge to edge of its outermost pixels.
    if (!(low <= high).all()) {
      low = {-0.5, -0.5};
      high = {image.width - 0.5, image.height - 0.5};
    }
    // Held to the box: far from it of r^7 rounding alone would be left.
    const Eigen::Array2d axis = cameras.intrinsics[c].projection.tail<2>().array();
    boxes.push_back(
        {0.5 * (low + high), (0.5 * (high - low)).max(kLeastHalf), axis.max(low).min(high)});
  }
  return boxes;
}

std::optional<ErrorModel> errorModel(const std::vector<RigView>& frames,
                                     const CameraEstimate& cameras, double cauchy_px,
                                     LaterUseKind kind, int threads) {
  // With every column first: by what later use asks of them it is decided which combinations stay.
  // Without the loss: later use asks for every corner alike. Its weights would hide the misfit just
  // where the model does not fit (docs/counterfactuals.md, "With the default loss").
  const ViewTermsMaker all(cameras, {seenBoxes(frames, cameras), {}}, 0);
  const std::vector<double> weights = cellWeights(frames, cameras, kind);
  const int count = static_cast<int>(frames.size());
  std::vector<LaterUse> parts(chunkCount(count, kUseChunk));
  forChunks(count, kUseChunk, threads, [&](const Chunk& chunk) {
    std::vector<ViewTerms> terms;
    for (int i = chunk.begin; i < chunk.end; ++i) {
      terms.push_back(all.seen(frames[i], weights));
    }
    parts[chunk.index] = laterUse(terms);
  });
  LaterUse use;
  // In the order of the chunks, whatever the threads.
  for (const LaterUse& part : parts) use += part;
  const FieldBase base = fieldBase(all.field().boxes);
  const auto fields = strongestFields(use, base.polynomials, base.radials);
  if (!fields) return std::nullopt;
  return ErrorModel{{use.H, use.C * *fields, fields->transpose() * use.D * *fields, use.corners},
                    ViewTermsMaker(cameras, {all.field().boxes, *fields}, cauchy_px)};
}

}  // namespace plumbline

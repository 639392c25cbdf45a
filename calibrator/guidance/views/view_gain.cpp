// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/view_gain.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <limits>

#include "calibrator/base/parallel.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

// Least pivot of I scaled to a unit diagonal. Below it lies rounding alone: the parameters' units
// (px, m, rad) are gone, so a pivot is the part of a parameter's information that no other
// explains.
constexpr double kLeastPivot = 1e-13;

}  // namespace

/// Lower triangle of sigma^2 [H P; P^T G + I] of one view, pose first; and the memory that takes
/// it.
class ViewScorer::Sum {
 public:
  explicit Sum(const ViewScorer& scorer) : s_(scorer), A_(scorer.before_) {
    for (const VisibleTags& tags : scorer.visible_) {
      predicted_.emplace_back(tags.cornerCount());
    }
  }

  void clear() {
    A_ = s_.before_;
    any_ = false;
  }
  bool any() const { return any_; }
  PredictedCorners& predicted(std::size_t camera) { return predicted_[camera]; }

  /// One camera's part. All cameras of a rig share the pose of camera 0, so their squares add up in
  /// one pose block; camera i > 0 enters through T_CiF = T_CiC0 T_C0F.
  void add(std::size_t c, const Transform& T_CiF, const PackedView& view, const GramOptions& gram) {
    any_ = true;
    const ViewGram g = viewGram(s_.cameras_.intrinsics[c], T_CiF, view, gram);
    const int k = 6 + s_.layout_.intrinsics[c];
    const int n = s_.layout_.intrinsics_size[c];
    A_.block(k, k, n, n) += g.H_k;
    if (c == 0) {
      A_.topLeftCorner<6, 6>() += g.H;
      A_.block(k, 0, n, 6) = g.H_pose_k.transpose();
      return;
    }
    // In the tangent of T_C0Ci: diag(-R, -R), R = R_CiC0.
    const Eigen::Matrix3d& R = s_.T_CiC0_[c].R;
    const Matrix6d A_pose = adjoint(s_.T_CiC0_[c]);
    const int e = 6 + s_.layout_.T_C0Ci[c];
    Matrix6d EH;  // diag(-R, -R)^T H
    EH.topRows<3>().noalias() = -R.transpose() * g.H.topRows<3>();
    EH.bottomRows<3>().noalias() = -R.transpose() * g.H.bottomRows<3>();
    const Matrix6d AtH = A_pose.transpose().lazyProduct(g.H);
    A_.topLeftCorner<6, 6>() += AtH.lazyProduct(A_pose);
    A_.block<6, 6>(e, 0) = EH.lazyProduct(A_pose);
    A_.block<6, 3>(e, e) -= EH.leftCols<3>().lazyProduct(R);
    A_.block<6, 3>(e, e + 3) -= EH.rightCols<3>().lazyProduct(R);
    A_.block(k, 0, n, 6) = g.H_pose_k.transpose().lazyProduct(A_pose);
    A_.block(e, k, 3, n) -= R.transpose().lazyProduct(g.H_pose_k.topRows<3>());
    A_.block(e + 3, k, 3, n) -= R.transpose().lazyProduct(g.H_pose_k.bottomRows<3>());
  }

  /// 0.5 log |I + S|; NaN where the pose is not determined. Uses A up.
  ///
  /// The pose stands first, so the factor's last n pivots are those of the Schur complement
  /// I + G - P^T H^-1 P: the pose is marginalised by the order alone. A is sigma^2 times the
  /// information, hence n log sigma.
  double halfLogDeterminant() {
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(A_);
    if (llt.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::Index n = s_.layout_.size;
    return A_.diagonal().tail(n).array().log().sum() -
           static_cast<double>(n) * std::log(s_.options_.pixel_sigma);
  }

 private:
  const ViewScorer& s_;
  Eigen::MatrixXd A_;
  std::vector<PredictedCorners> predicted_;
  bool any_ = false;
};

ViewScorer::ViewScorer(const AprilGrid& target, const CameraEstimate& cameras,
                       const Eigen::MatrixXd& information, const ViewGainOptions& options)
    : target_(target), cameras_(cameras), layout_(cameras.intrinsics), options_(options) {
  options.check();
  for (std::size_t c = 0; c < cameras.intrinsics.size(); ++c) {
    visible_.emplace_back(cameras.intrinsics[c], target, VisibleTags::Limits());
    T_CiC0_.push_back(cameras.T_C0Ci[c].inverse());
  }
  assert(information.rows() == layout_.size && information.cols() == layout_.size);
  before_.setZero(6 + layout_.size, 6 + layout_.size);
  before_.bottomRightCorner(layout_.size, layout_.size) =
      options.pixel_sigma * options.pixel_sigma * information;
  // What follows has logarithms and roots of these; until then nothing is determined.
  if (!information.allFinite() || !(information.diagonal().array() > 0).all()) return;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * information * scale.asDiagonal());
  if (llt.info() != Eigen::Success) return;
  const auto pivots = llt.matrixLLT().diagonal().array();
  determined_ = (pivots.square() >= kLeastPivot).all();
  half_log_determinant_ = (pivots / scale.array()).log().sum();
}

std::vector<Corner> ViewScorer::predictedCorners(int camera, const Transform& T_FC0) const {
  const auto c = static_cast<std::size_t>(camera);
  return visible_[c].corners(T_CiC0_[c] * T_FC0.inverse());
}

/// NaN where the view says nothing.
double ViewScorer::gainOf(Sum& sum) const {
  if (!sum.any()) return std::numeric_limits<double>::quiet_NaN();
  // Before the views kept determine the cameras, any view gains without bound: take it.
  if (!determined_) return std::numeric_limits<double>::infinity();
  return sum.halfLogDeterminant() - half_log_determinant_;
}

double ViewScorer::seenGain(const std::vector<std::vector<Corner>>& corners,
                            const Transform& T_FC0) const {
  Sum sum(*this);
  sum.clear();
  const Transform T_C0F = T_FC0.inverse();
  for (std::size_t c = 0; c < visible_.size(); ++c) {
    // Under the loss: a false corner must not pass for information.
    if (corners[c].empty()) continue;
    const PackedCorners packed(target_, {{0, corners[c]}});
    sum.add(c, T_CiC0_[c] * T_C0F, packed.view(0), {options_.cauchy_px, 0});
  }
  return gainOf(sum);
}

std::vector<double> ViewScorer::predictedGains(const std::vector<Transform>& T_FC0,
                                               int threads) const {
  std::vector<double> gains(T_FC0.size());
  forChunks(static_cast<int>(T_FC0.size()), kViewChunk, threads, [&](const Chunk& chunk) {
    Sum sum(*this);
    for (auto i = static_cast<std::size_t>(chunk.begin); i < static_cast<std::size_t>(chunk.end);
         ++i) {
      sum.clear();
      const Transform T_C0F = T_FC0[i].inverse();
      for (std::size_t c = 0; c < visible_.size(); ++c) {
        const Transform T_CiF = T_CiC0_[c] * T_C0F;
        visible_[c].predict(T_CiF, sum.predicted(c));
        const PackedView view = sum.predicted(c).view();
        // Too few corners are no detection (DetectorOptions::min_tags), whatever they would gain.
        if (view.count >= options_.min_corners) sum.add(c, T_CiF, view, {0, 0});
      }
      gains[i] = gainOf(sum);
    }
  });
  return gains;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// The board's terms in a view's Gram matrix, against sums over corners with dense rows whose
// derivatives by the terms are central differences.
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/residuals/view_gram.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/example_view.h"
#include "tests/calibrator/residuals/naive_gram.h"

namespace plumbline {
namespace {

AprilGrid bentBoard() {
  AprilGrid board;
  for (int j = 0; j < kTargetTerms; ++j) board.shape.terms[j] = 2e-4 * (j % 5 - 2);
  board.shape.terms[kTargetTerms - 1] = 0;  // it depends on the view (PackedCorners)
  return board;
}

/// The functions of a board's basis at the corners of a view.
struct Columns {
  std::vector<double> values;
  TargetColumns target{};

  Columns(const AprilGrid& board, const PackedView& view) {
    const TargetBasis basis(board);
    const auto n = static_cast<std::size_t>(view.padded);
    values.resize(TargetBasis::kFunctions * n);
    for (std::size_t i = 0; i < TargetBasis::kFunctions; ++i) {
      for (std::size_t j = 0; j < n; ++j) values[i * n + j] = basis.functions(view.id[j])[i];
      target.function[i] = values.data() + i * n;
    }
  }
};

Eigen::Vector2d pixel(const Intrinsics& camera, const Transform& T_CF, AprilGrid board, int id,
                      int term, double step) {
  board.shape.terms[term] += step;
  return project(camera, T_CF * cornerPoints(board)[static_cast<std::size_t>(id)]).value();
}

/// Rows (pose 6, intrinsics 8, terms 12) of each corner.
struct DenseSums {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(26, 26);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(26);
};

DenseSums denseSums(const Intrinsics& camera, const Transform& T_CF, const AprilGrid& board,
                    const PackedView& view, const GramOptions& options) {
  constexpr double kStep = 1e-5;  // [m]
  const auto points = cornerPoints(board);
  DenseSums sums;
  for (int i = 0; i < view.count; ++i) {
    const Eigen::Vector3d p = T_CF * points[static_cast<std::size_t>(view.id[i])];
    const Projection at = projectWithJacobians(camera, p).value();
    const Eigen::Vector2d e = at.uv - Eigen::Vector2d(view.u[i], view.v[i]);
    Eigen::Matrix<double, 2, 26> J;
    J.leftCols<14>() << at.J_point, -at.J_point * skew(p), at.J_intrinsics;
    for (int j = 0; j < kTargetTerms; ++j) {
      J.col(14 + j) = (pixel(camera, T_CF, board, view.id[i], j, kStep) -
                       pixel(camera, T_CF, board, view.id[i], j, -kStep)) /
                      (2 * kStep);
    }
    const double c2 = options.cauchy_px * options.cauchy_px;
    const double slope = c2 > 0 ? 1 / (1 + e.squaredNorm() / c2) : 1.0;
    sums.H += J.transpose() * test::naiveWeight(e, options) * J;
    sums.b += slope * J.transpose() * e;
  }
  return sums;
}

DenseSums assembled(const TargetViewGram& g) {
  DenseSums out;
  out.H << g.H, g.H_pose_k, g.H_pose_s, g.H_pose_k.transpose(), g.H_k, g.H_k_s,
      g.H_pose_s.transpose(), g.H_k_s.transpose(), g.H_s;
  out.b << g.b, g.b_k, g.b_s;
  return out;
}

TEST(TargetViewGram, EqualsTheSumOverCornersForEveryModelLossAndInstructionSet) {
  const AprilGrid board = bentBoard();
  const Transform T_CF = test::examplePose();
  for (const Intrinsics& camera : test::allCameras()) {
    const ImageView view = test::noisyView(board, camera, T_CF, 51, 2.0, 1);
    const PackedCorners corners(board, {view});
    const Columns columns(board, corners.view(0));
    for (const GramOptions& options : {GramOptions{0, 0}, GramOptions{1.5, 0.7}}) {
      const DenseSums naive = denseSums(camera, T_CF, board, corners.view(0), options);
      const Eigen::VectorXd scale = naive.H.diagonal().cwiseSqrt().cwiseInverse();
      for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2}) {
        if (!isAvailable(set)) continue;
        const DenseSums gram =
            assembled(targetViewGram(camera, T_CF, corners.view(0), columns.target, options, set));
        const Eigen::MatrixXd d = scale.asDiagonal() * (gram.H - naive.H) * scale.asDiagonal();
        EXPECT_LT(d.cwiseAbs().maxCoeff(), 1e-7);
        EXPECT_LT((scale.asDiagonal() * (gram.b - naive.b)).cwiseAbs().maxCoeff(), 1e-5);
      }
    }
  }
}

TEST(TargetViewGram, ItsPartWithoutTheBoardIsViewGram) {
  const AprilGrid board = bentBoard();
  const Transform T_CF = test::examplePose();
  const Intrinsics camera = test::allCameras().front();
  const PackedCorners corners(board, {test::noisyView(board, camera, T_CF, 144, 1.0, 2)});
  const Columns columns(board, corners.view(0));
  const ViewGram plain = viewGram(camera, T_CF, corners.view(0));
  const TargetViewGram with = targetViewGram(camera, T_CF, corners.view(0), columns.target);
  EXPECT_LT((with.H - plain.H).norm(), 1e-13 * plain.H.norm());
  EXPECT_LT((with.H_k - plain.H_k).norm(), 1e-13 * plain.H_k.norm());
  EXPECT_NEAR(with.cost, plain.cost, 1e-13 * plain.cost);
}

}  // namespace
}  // namespace plumbline

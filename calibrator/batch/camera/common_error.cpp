// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/common_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "calibrator/base/parallel.h"
#include "calibrator/batch/board/target.h"
#include "calibrator/information/covariance.h"
#include "calibrator/residuals/field_gram.h"

namespace plumbline {
namespace {

constexpr int kMostFrames = 30;

/// Some frames of a problem, with copies of their corners.
struct Sample {
  std::vector<PackedCorners> corners;
  CameraProblem problem;  ///< without corners
  CameraEstimate estimate;
};

/// Frames by the cameras that see them, each kind in order of time: evenly cut, all kinds are there
/// as often as in the recording, whatever the cameras' rates.
std::vector<int> framesByKind(const CameraProblem& problem) {
  std::vector<int> order(problem.frames.size());
  std::iota(order.begin(), order.end(), 0);
  const auto kind = [&](int f) {
    std::vector<bool> sees;
    for (const int view : problem.frames[f].view) sees.push_back(view >= 0);
    return sees;
  };
  std::ranges::stable_sort(order, {}, kind);
  return order;
}

Sample sampleOf(const CameraProblem& problem, const CameraEstimate& estimate, int most) {
  Sample out{{}, problem, estimate};
  const std::vector<int> order = framesByKind(problem);
  const int all = problem.frameCount(), count = std::min(all, most);
  out.problem.frames.clear();
  out.problem.weights.clear();
  out.problem.corners = {};
  out.problem.threads = 1;
  // A part of the frames goes with as much of what is known of the board; of cameras nothing is.
  out.problem.prior = nullptr;
  if (problem.target) {
    TargetModel target = *problem.target;
    target.information *= static_cast<double>(count) / all;
    out.problem.target = std::make_shared<const TargetModel>(std::move(target));
  }
  out.estimate.T_C0F.clear();
  std::vector<std::vector<int>> views(problem.corners.size());
  for (int i = 0; i < count; ++i) {
    const int f = order[i * all / count];
    Frame frame = problem.frames[f];
    for (std::size_t c = 0; c < views.size(); ++c) {
      if (frame.view[c] < 0) continue;
      views[c].push_back(frame.view[c]);
      frame.view[c] = static_cast<int>(views[c].size()) - 1;
    }
    out.problem.frames.push_back(std::move(frame));
    out.estimate.T_C0F.push_back(estimate.T_C0F[f]);
  }
  for (std::size_t c = 0; c < views.size(); ++c) {
    out.corners.push_back(problem.corners[c].thinned(views[c], std::numeric_limits<int>::max()));
  }
  return out;
}

/// Gradient of the cost by cameras and terms, the poses eliminated.
Eigen::VectorXd reducedGradient(const CameraNormals& n) {
  Eigen::VectorXd out = n.b;
  for (std::size_t f = 0; f < n.H.size(); ++f) {
    const PoseElimination R(n.H[f]);
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(f);
    out -= (R * n.P.middleRows<6>(at)).transpose() * (R * n.b_pose.segment<6>(at));
  }
  return out;
}

/// Over the whole image, from edge to edge of its outermost pixels.
FieldBox wholeImage(const Resolution& image) {
  const Eigen::Vector2d half(0.5 * image.width, 0.5 * image.height);
  const Eigen::Vector2d centre = half.array() - 0.5;
  return {centre, half, centre};
}

/// For 1 px, of `most` frames; empty where these do not determine the cameras.
std::optional<Eigen::MatrixXd> movesOf(const CameraProblem& problem, const CameraEstimate& estimate,
                                       int most) {
  const Sample sample = sampleOf(problem, estimate, most);
  // Without loss the gradient is linear in the corners.
  const auto normalsOf = [&](const std::vector<PackedCorners>& corners) {
    CameraProblem at = sample.problem;
    at.corners = corners;
    return normalsAt(at, sample.estimate, {0, 0});
  };
  const CameraNormals as_measured = normalsOf(sample.corners);
  const auto inverse = covarianceOf(reducedInformation(as_measured));
  if (!inverse) return std::nullopt;
  const Eigen::VectorXd zero = reducedGradient(as_measured);
  const int columns = static_cast<int>(sample.corners.size()) * 2 * kFieldPolynomials;
  Eigen::MatrixXd C(zero.size(), columns);
  parallelCalls(columns, problem.threads, [&](int column) {
    const int c = column / (2 * kFieldPolynomials), k = column / 2 % kFieldPolynomials;
    const Eigen::Vector2d along = Eigen::Vector2d::Unit(column % 2);
    const FieldBox box = wholeImage(estimate.intrinsics[c].resolution);
    std::vector<PackedCorners> corners = sample.corners;
    corners[c].displace([&](double u, double v) -> Eigen::Vector2d {
      return along * fieldFunctions(box, {u, v})[k];
    });
    C.col(column) = reducedGradient(normalsOf(corners)) - zero;
  });
  return -*inverse * C;
}

}  // namespace

Eigen::MatrixXd commonErrorMoves(const CameraProblem& problem, const CameraEstimate& estimate,
                                 double px) {
  assert(px >= 0);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(CameraLayout(estimate).size, 0);
  if (px == 0) return none;
  auto moves = movesOf(problem, estimate, kMostFrames);
  if (!moves) moves = movesOf(problem, estimate, problem.frameCount());
  if (!moves) return none;
  return px * *moves;
}

double commonErrorPx(const CameraProblem& problem, const CameraEstimate& estimate) {
  return problem.common_error_share * problem.pixel_sigma *
         std::sqrt(noiseRatio(problem, estimate));
}

}  // namespace plumbline

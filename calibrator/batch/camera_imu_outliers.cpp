// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu_outliers.h"

#include <cmath>
#include <numeric>

#include "calibrator/batch/parallel_chunks.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

constexpr double kKalibrSigmas = 2;
constexpr double kKalibrLeast = 0.2;  // [px]
constexpr int kViewIterations = 20;

/// |measured - projected| of every corner; a corner that cannot be projected counts as far off.
std::vector<double> errorNorms(const Intrinsics& camera, const Transform& T_CF,
                               const PackedView& view) {
  std::vector<double> errors;
  for (int k = 0; k < view.count; ++k) {
    const auto p = project(camera, T_CF * Eigen::Vector3d(view.x[k], view.y[k], 0));
    errors.push_back(p ? (Eigen::Vector2d(view.u[k], view.v[k]) - *p).norm() : 1e6);
  }
  return errors;
}

/// Positions of one view's corners that Kalibr's rule rejects.
std::vector<int> kalibrOutliers(const Intrinsics& camera, const PackedView& view) {
  PoseRefinementOptions options;
  options.max_iterations = kViewIterations;
  const auto start = homographyPose(camera, view);
  if (!start) return {};
  const Transform T_CF = refinePose({{&camera, view, Transform()}}, *start, options).T_C0F;
  const std::vector<double> errors = errorNorms(camera, T_CF, view);
  const auto n = static_cast<double>(errors.size());
  const double mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  double variance = 0;
  for (const double e : errors) variance += (e - mean) * (e - mean) / n;
  const double limit = std::max(mean + kKalibrSigmas * std::sqrt(variance), kKalibrLeast);
  std::vector<int> rejected;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (errors[k] > limit) rejected.push_back(static_cast<int>(k));
  }
  return rejected;
}

}  // namespace

std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners,
                             const std::vector<CameraCalibration>& cameras,
                             const std::vector<Frame>& frames, int threads) {
  std::size_t count = 0;
  const int n = static_cast<int>(frames.size());
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    std::vector<std::vector<int>> rejected(frames.size());
    forChunks(n, 16, threads, [&](const Chunk& chunk) {
      for (int i = chunk.begin; i < chunk.end; ++i) {
        const int view = frames[static_cast<std::size_t>(i)].view[c];
        if (view < 0) continue;
        rejected[static_cast<std::size_t>(i)] =
            kalibrOutliers(cameras[c].intrinsics, corners[c].view(view));
      }
    });
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (const int k : rejected[i]) corners[c].setWeight(frames[i].view[c], k, 0);
      count += rejected[i].size();
    }
  }
  return count;
}

std::size_t rejectAboveSigma(CameraImuProblem& problem, const CameraImuEstimate& estimate,
                             double sigmas) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const CameraCalibration& camera = estimate.cameras[c];
    std::vector<std::vector<double>> errors(problem.frames.size());
    double squared = 0;
    double used = 0;
    for (std::size_t i = 0; i < problem.frames.size(); ++i) {
      if (problem.frames[i].view[c] < 0) continue;
      const PackedView view = problem.corners[c].view(problem.frames[i].view[c]);
      const Transform T_FC = estimate.states[i].T_FS * estimate.T_SC0 * camera.T_C0Ci;
      errors[i] = errorNorms(camera.intrinsics, T_FC.inverse(), view);
      for (int k = 0; k < view.count; ++k) {
        const double e = errors[i][static_cast<std::size_t>(k)];
        squared += view.w[k] * e * e;
        used += view.w[k];
      }
    }
    const double limit = sigmas * std::sqrt(0.5 * squared / std::max(used, 1.0));
    for (std::size_t i = 0; i < errors.size(); ++i) {
      for (std::size_t k = 0; k < errors[i].size(); ++k) {
        const int view = problem.frames[i].view[c];
        const bool is_used = problem.corners[c].view(view).w[k] > 0;
        if (!is_used || errors[i][k] <= limit) continue;
        problem.corners[c].setWeight(view, static_cast<int>(k), 0);
        ++count;
      }
    }
  }
  return count;
}

}  // namespace plumbline

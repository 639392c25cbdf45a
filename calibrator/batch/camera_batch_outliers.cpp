// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_batch_outliers.h"

#include <algorithm>
#include <cmath>

#include "calibrator/batch/camera_view_errors.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

constexpr double kKalibrSigmas = 2;
constexpr double kKalibrLeast = 0.2;                    // [px]
constexpr double kRayleighMedian = 1.1774100225154747;  // sqrt(2 ln 2)

/// |e| of every corner of one view.
std::vector<double> errorNorms(const Intrinsics& camera, const Transform& T_CF,
                               const PackedView& view) {
  std::vector<double> norms;
  norms.reserve(static_cast<std::size_t>(view.count));
  for (const Eigen::Vector2d& e : viewErrors(camera, T_CF, view)) norms.push_back(e.norm());
  return norms;
}

/// Rejects the used corners of a view with |e| above the limit; how many.
std::size_t rejectAbove(double limit, const std::vector<double>& errors, int view,
                        PackedCorners& corners) {
  std::size_t count = 0;
  for (int k = 0; k < static_cast<int>(errors.size()); ++k) {
    if (!(corners.view(view).w[k] > 0) || errors[static_cast<std::size_t>(k)] <= limit) continue;
    corners.setWeight(view, k, 0);
    ++count;
  }
  return count;
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Kalibr's limit for one view, from its used corners.
double kalibrLimit(const std::vector<double>& errors, const PackedView& view) {
  double n = 0;
  double sum = 0;
  double squares = 0;
  for (int k = 0; k < view.count; ++k) {
    if (!(view.w[k] > 0)) continue;
    const double e = errors[static_cast<std::size_t>(k)];
    n += 1;
    sum += e;
    squares += e * e;
  }
  if (n == 0) return kKalibrLeast;
  const double mean = sum / n;
  const double variance = std::max(0.0, squares / n - mean * mean);
  return std::max(mean + kKalibrSigmas * std::sqrt(variance), kKalibrLeast);
}

}  // namespace

std::size_t rejectAboveSigma(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate, double sigmas) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
    std::vector<std::vector<double>> errors(problem.frames.size());
    std::vector<double> used;
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      if (problem.frames[f].view[c] < 0) continue;
      const PackedView view = corners[c].view(problem.frames[f].view[c]);
      errors[f] = errorNorms(estimate.intrinsics[c], T_CiC0 * estimate.T_C0F[f], view);
      for (int k = 0; k < view.count; ++k) {
        if (view.w[k] > 0) used.push_back(errors[f][static_cast<std::size_t>(k)]);
      }
    }
    const double limit = sigmas * medianOf(std::move(used)) / kRayleighMedian;
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      const int view = problem.frames[f].view[c];
      if (view >= 0) count += rejectAbove(limit, errors[f], view, corners[c]);
    }
  }
  return count;
}

std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
    const Intrinsics& camera = estimate.intrinsics[c];
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      const int index = problem.frames[f].view[c];
      if (index < 0) continue;
      const PackedView view = corners[c].view(index);
      // For the view's own pose its camera plays camera 0.
      const PoseRefinement alone =
          refinePose({{&camera, view, Transform()}}, T_CiC0 * estimate.T_C0F[f]);
      const std::vector<double> errors = errorNorms(camera, alone.T_C0F, view);
      count += rejectAbove(kalibrLimit(errors, view), errors, index, corners[c]);
    }
  }
  return count;
}

}  // namespace plumbline

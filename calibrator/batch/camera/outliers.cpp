// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/outliers.h"

#include "calibrator/batch/corner_outliers.h"

namespace plumbline {
namespace {

/// Camera c's views in the problem's frames, at an estimate.
std::vector<PosedView> posedViews(const CameraProblem& problem, const CameraEstimate& estimate,
                                  std::size_t c) {
  const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
  std::vector<PosedView> views;
  for (std::size_t f = 0; f < problem.frames.size(); ++f) {
    const int view = problem.frames[f].view[c];
    if (view >= 0) views.push_back({view, T_CiC0 * estimate.T_C0F[f]});
  }
  return views;
}

}  // namespace

std::size_t rejectAboveSigma(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate, double sigmas) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    count += rejectAboveSigma(corners[c], estimate.intrinsics[c], posedViews(problem, estimate, c),
                              sigmas);
  }
  return count;
}

std::size_t rejectLikeKalibr(std::vector<PackedCorners>& corners, const CameraProblem& problem,
                             const CameraEstimate& estimate) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    for (const PosedView& posed : posedViews(problem, estimate, c)) {
      const auto rejected =
          kalibrOutliers(estimate.intrinsics[c], corners[c].view(posed.view), posed.T_CF);
      for (const int k : rejected) corners[c].setWeight(posed.view, k, 0);
      count += rejected.size();
    }
  }
  return count;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/outliers.h"

#include "calibrator/batch/camera_imu/exposure.h"
#include "calibrator/batch/corner_outliers.h"
#include "calibrator/batch/parallel_chunks.h"
#include "calibrator/initialise/camera_poses.h"

namespace plumbline {

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
        const PackedView packed = corners[c].view(view);
        const auto start = homographyPose(cameras[c].intrinsics, packed);
        if (!start) continue;
        rejected[static_cast<std::size_t>(i)] =
            kalibrOutliers(cameras[c].intrinsics, packed, *start);
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
    std::vector<PosedView> views;
    for (std::size_t i = 0; i < problem.frames.size(); ++i) {
      const int view = problem.frames[i].view[c];
      if (view >= 0) views.push_back({view, targetInCamera(problem, estimate, i, c)});
    }
    count += rejectAboveSigma(problem.corners[c], estimate.cameras[c].intrinsics, views, sigmas);
  }
  return count;
}

}  // namespace plumbline

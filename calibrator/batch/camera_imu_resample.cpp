// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu_resample.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "calibrator/batch/parallel_chunks.h"

namespace plumbline {
namespace {

void append(std::vector<double>& to, const Eigen::VectorXd& values) {
  to.insert(to.end(), values.begin(), values.end());
}

/// Parameters of `to` minus those of `from`, in the order of the stage's covariance.
Eigen::VectorXd difference(const CameraImuStageResult& to, const CameraImuStageResult& from,
                           bool free_cameras) {
  std::vector<double> d;
  append(d, boxminus(to.imu.T_SC0, from.imu.T_SC0));
  d.push_back(to.imu.time_offset_s - from.imu.time_offset_s);
  for (std::size_t c = 0; free_cameras && c < to.cameras.size(); ++c) {
    append(d, to.cameras[c].intrinsics.stacked() - from.cameras[c].intrinsics.stacked());
  }
  for (std::size_t c = 1; free_cameras && c < to.cameras.size(); ++c) {
    append(d, boxminus(to.cameras[c].T_C0Ci, from.cameras[c].T_C0Ci));
  }
  return Eigen::Map<const Eigen::VectorXd>(d.data(), static_cast<Eigen::Index>(d.size()));
}

}  // namespace

Result<ResampleSummary> resampleCameraImu(const Session& session,
                                          const CameraImuStageResult& earlier,
                                          const ResampleOptions& resample,
                                          const CameraImuOptions& options) {
  CameraImuOptions one_thread = options;
  one_thread.threads = 1;
  std::vector<std::optional<Eigen::VectorXd>> solved(
      static_cast<std::size_t>(std::max(0, resample.draws)));
  const int frames = static_cast<int>(earlier.frames.size());
  forChunks(static_cast<int>(solved.size()), 1, resample.threads, [&](const Chunk& chunk) {
    const auto stretches = drawStretches(frames, resample, chunk.index);
    const auto again = recalibrateCameraImu(session, earlier, stretches, one_thread);
    if (!again || !again->summary.converged) return;
    solved[static_cast<std::size_t>(chunk.index)] =
        difference(*again, earlier, options.free_cameras);
  });
  const ParameterCovariance& parameters = earlier.summary.covariance;
  Eigen::MatrixXd draws(static_cast<Eigen::Index>(parameters.names.size()), resample.draws);
  int count = 0;
  for (const auto& draw : solved) {
    if (draw) draws.col(count++) = *draw;
  }
  if (count < 2) {
    return Failure{FailureReason::kTooFewViews,
                   "fewer than two of the resampled camera-IMU problems have a solution",
                   "record longer, or leave out --resample"};
  }
  return summariseDraws(parameters, draws.leftCols(count), resample.draws - count);
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/resample.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrator/base/time_offsets.h"
#include "calibrator/batch/camera/difference.h"

namespace plumbline {
namespace {

constexpr std::string_view kOwnOffset = "time_offset.cam";

void append(std::vector<double>& to, const Eigen::VectorXd& values) {
  to.insert(to.end(), values.begin(), values.end());
}

/// Parameters of `to` minus those of `from`, in the order of the stage's covariance.
Eigen::VectorXd difference(const CameraImuStageResult& to, const CameraImuStageResult& from,
                           bool free_cameras) {
  std::vector<double> d;
  append(d, boxminus(to.imu.T_SC0, from.imu.T_SC0));
  d.push_back(to.imu.time_offset_s - from.imu.time_offset_s);
  if (free_cameras) append(d, cameraDifference(to.cameras, from.cameras));
  for (const std::string& name : from.summary.covariance.names) {
    if (name.rfind(kOwnOffset, 0) != 0) continue;
    const auto c = static_cast<std::size_t>(std::stoi(name.substr(kOwnOffset.size())));
    d.push_back(cameraTimeOffset(to.imu, c) - cameraTimeOffset(from.imu, c));
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
  const auto solve = [&](const std::vector<FrameStretch>& stretches) {
    const auto again = recalibrateCameraImu(session, earlier, stretches, one_thread);
    if (!again || !again->summary.converged) return std::optional<Eigen::VectorXd>();
    return std::optional(difference(*again, earlier, options.free_cameras));
  };
  return solveDraws(earlier.summary.covariance, static_cast<int>(earlier.frames.size()), resample,
                    "camera-IMU", solve);
}

}  // namespace plumbline

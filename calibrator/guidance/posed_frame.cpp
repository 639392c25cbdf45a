// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/posed_frame.h"

#include "calibrator/initialise/camera_poses.h"

namespace plumbline {
namespace {

constexpr double kGoodPose = 3;  // [px] of RMS error with which the first pose is taken

}  // namespace

std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras,
                                    const FramePoseOptions& options) {
  PosedFrame out{frame.index, frame.t, frame.corners, {}};
  std::vector<PackedCorners> packed;
  for (auto& corners : out.corners) {
    if (static_cast<int>(corners.size()) < options.min_corners) corners.clear();
    packed.emplace_back(target, std::vector<ImageView>{{frame.t, corners}});
  }
  std::vector<FrameView> views;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (out.corners[c].empty()) continue;
    views.push_back({&cameras[c].intrinsics, packed[c].view(0), cameras[c].T_C0Ci.inverse()});
  }
  const auto pose = findPose(views, kGoodPose);
  if (!pose || !(pose->errorPx() < options.max_rms_px)) return std::nullopt;
  out.T_FC0 = pose->T_C0F.inverse();
  return out;
}

}  // namespace plumbline

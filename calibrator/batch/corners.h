// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// Which corners a batch leaves out.
enum class CornerFilter {
  kNone,
  /// After a first solution: |e| above `sigmas` times the camera's standard deviation per axis,
  /// which is taken robustly, from the median of |e|; then solved again, in up to three rounds of
  /// the camera stage, two of the camera-IMU stage, one of scoreCameras(): corners_used of a
  /// calibration and of its score on the same session may differ.
  kSigma,
  /// As Kalibr does: |e| above mean + 2 std of its view, with only that view's pose free, and above
  /// 0.2 px.
  kKalibr,
};

/// e = measured - projected [px] of every corner of a view, rejected ones too, by the same function
/// that the Gram kernels charge. A corner that is not in front of the camera gets (1e5, 0).
std::vector<Eigen::Vector2d> viewErrors(const Intrinsics& camera, const Transform& T_CF,
                                        const PackedView& view);

/// All corners of a session, one block per camera; those of repeatedViews() have no weight.
std::vector<PackedCorners> packCorners(const Session& session);

/// Corners of a frame's views, rejected ones too.
std::size_t cornerCount(const Frame& frame, std::span<const PackedCorners> corners);
/// Those with weight alone.
double usedCount(const Frame& frame, std::span<const PackedCorners> corners);

/// The same without those that an earlier result of the session rejected (their weight is 0): its
/// frames, and the residuals that it lists.
std::vector<PackedCorners> usedCorners(const Session& session, const std::vector<Frame>& frames,
                                       const std::vector<CornerResidual>& residuals);

/// Reprojection errors of used corners [px], per camera.
using CameraErrors = std::vector<std::vector<Eigen::Vector2d>>;
CameraErrors usedErrors(const std::vector<CornerResidual>& residuals, std::size_t cameras);

/// What is said of them: of all cameras together, and of each.
struct ReprojectionSummary {
  ErrorStatistics reprojection;
  std::vector<ErrorStatistics> per_camera;
};
ReprojectionSummary summariseErrors(const CameraErrors& errors);

/// The used corners' errors into a stage's summary, and what the session offered.
void addReprojection(const CameraErrors& errors, const Session& session, StageSummary& summary);

/// A corner by camera, view of the camera and position within the view.
struct CornerPlace {
  std::size_t camera = 0;
  int view = 0;
  int position = 0;
};
/// Gives corners their weight: 0 rejects them.
void weigh(const std::vector<CornerPlace>& places, double weight,
           std::vector<PackedCorners>& corners);

/// One view of a camera (index into its PackedCorners) and the pose of the target in it.
struct PosedView {
  int view = 0;
  Transform T_CF;
};

/// One round of CornerFilter::kSigma for one camera at an estimate: gives weight 0 to every used
/// corner of the views with |e| above `sigmas` times the standard deviation per axis, taken
/// robustly from the median of |e| over the camera's used corners (median of a Rayleigh
/// distribution: sqrt(2 ln 2) = 1.1774 sigma), so that the outliers themselves do not widen it.
/// Corners that cannot be projected count as far off (see viewErrors()). Returns how many it
/// rejected.
std::size_t rejectAboveSigma(PackedCorners& corners, const Intrinsics& camera,
                             const std::vector<PosedView>& views, double sigmas);

/// CornerFilter::kKalibr for one camera: gives weight 0 to every used corner with |e| above mean +
/// 2 std of its view's used corners and above 0.2 px, with each pose refined from where it starts
/// on its view alone and the camera held. Returns how many it rejected.
std::size_t rejectLikeKalibr(PackedCorners& corners, const Intrinsics& camera,
                             const std::vector<PosedView>& starts, int threads);

}  // namespace plumbline

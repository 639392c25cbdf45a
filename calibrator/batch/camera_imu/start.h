// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/batch/corners.h"
#include "calibrator/initialise/imu_alignment.h"

namespace plumbline {

/// The samples with `shift` added to every stamp, exactly.
std::vector<ImuSample> shiftedSamples(const std::vector<ImuSample>& samples, TimeNs shift);

/// A pause between two neighbouring samples.
struct ImuGap {
  TimeNs from = 0;
  TimeNs to = 0;
};
/// Pauses longer than `max_intervals` times the median interval, in time order.
std::vector<ImuGap> imuGaps(std::span<const ImuSample> samples, double max_intervals);

struct FrameSelectionOptions {
  double time_offset_s = 0;
  double margin_s = 0.005;     ///< how far samples must reach beyond a frame [s]
  double max_interval_s = 10;  ///< frames further apart are joined by the bias walk only [s]
};

struct FrameSelection {
  std::vector<int> chosen;       ///< indices into the candidates, ascending
  std::vector<FrameLink> links;  ///< chosen.size() - 1
  int covered = 0;               ///< candidates that samples cover, linked or not
};

/// Chooses the frames (stamps in the camera's clock, ascending) that the samples cover, and how
/// neighbours are joined: inertially, or by the bias walk where a gap lies between them. A frame
/// that no inertial link reaches is left out, for nothing would determine its velocity.
FrameSelection selectFrames(std::span<const TimeNs> stamps, std::span<const ImuSample> samples,
                            std::span<const ImuGap> gaps, const FrameSelectionOptions& options);

/// Frames with a pose of their own, before the IMU has a say.
struct PosedFrames {
  std::vector<Frame> frames;
  std::vector<CameraPose> poses;
  int without_pose = 0;  ///< frames left out
  /// Corners to be left out: of misplaced tags, and grazing ones; see calibrator/initialise.
  std::vector<CornerPlace> rejected;
  Screening screening;  ///< of the views

  std::vector<TimeNs> stamps() const;
};
/// Pairs the session's views and finds each frame's pose from its corners alone: least squares from
/// a homography, and where that leaves corners far off, the best of several starts under a
/// redescending loss.
PosedFrames poseFrames(const Session& session, const std::vector<PackedCorners>& corners,
                       const std::vector<CameraCalibration>& cameras,
                       const CameraImuOptions& options);

/// First guess of everything that is not a frame's own.
struct CameraImuStart {
  Transform T_SC0;
  TimeOffsets time_offsets{TimeOffset()};
  Eigen::Vector3d gravity_direction = -Eigen::Vector3d::UnitZ();
  ImuBias bias;
  InertialCheck check;
  std::optional<PartOffsets> parts;  ///< time offsets of parts of the recording, by rates alone
};

/// Units and axes checked, time offset by correlation, rotation by alignment of rates, gravity,
/// translation and accelerometer bias by linear least squares.
Result<CameraImuStart> startCameraImu(std::span<const CameraPose> poses,
                                      std::span<const ImuSample> samples, const AprilGrid& target,
                                      const CameraImuOptions& options);

/// kStampsWander where parts of the recording have offsets that differ by more than 5 ms and ten
/// standard deviations.
std::optional<Failure> wanderingStamps(const std::optional<PartOffsets>& parts);

/// Gives every camera whose stamps are off camera 0's an offset of its own to be estimated,
/// starting at camera 0's.
void freeOwnOffsets(const Session& session, const std::vector<Frame>& frames, TimeOffsets& offsets);

/// The start under a given calibration, which is taken as it is: gravity from the mean specific
/// force, biases zero. Nothing of it can fail, whatever the calibration.
CameraImuStart startFromCalibration(std::span<const CameraPose> poses,
                                    std::span<const ImuSample> samples, const ImuCalibration& imu);

/// States at the frames: poses through T_SC0, velocities by differences of positions.
std::vector<ImuState> startStates(std::span<const CameraPose> poses, const CameraImuStart& start);

}  // namespace plumbline

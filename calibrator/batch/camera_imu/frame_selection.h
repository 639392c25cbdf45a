// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "calibrator/batch/camera_imu/problem.h"

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

}  // namespace plumbline

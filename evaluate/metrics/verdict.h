// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/frames.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// From where on a figure is caution, and from where on bad.
struct Bound {
  double caution = 0;
  double bad = 0;
};

/// Where a value stands that should be small; NaN is bad.
VerdictLevel levelAbove(double value, const Bound& bound);

/// Adds findings to others; under one subject, where that is given (pages show a level for each).
void append(std::vector<Finding>& to, std::vector<Finding> more,
            std::optional<FindingSubject> subject = {});

/// Thresholds of the verdict. The defaults are rules of thumb for rigs whose calibration feeds
/// visual-inertial odometry; every one is an option of the command line.
struct VerdictThresholds {
  Bound rmse_px{1.0, 2.0};            ///< reprojection RMSE of a camera, above
  Bound regional_error_px{0.9, 5.0};  ///< largest median error of an image region, above
  /// Part of a camera's error that neighbouring corners share, RMS per axis [px], above.
  Bound systematic_px{0.3, 3};
  Bound coverage{0.75, 0.5};            ///< share of image regions with corners, below
  Bound views{20, 8};                   ///< views used of a camera, below
  Bound tilt_deg{25, 10};               ///< 90 % quantile of the views' tilt to the target, below
  Bound rejected{0.1, 0.3};             ///< share of corners rejected as outliers, above
  Bound focal_std{0.005, 0.02};         ///< standard deviation of a focal length, relative, above
  Bound extrinsics_std_m{0.002, 0.01};  ///< of a translation between cameras [m], above
  Bound lever_arm_std_m{0.005, 0.02};   ///< of a component of T_SC0's translation [m], above
  Bound rotation_std_deg{0.2, 1.0};     ///< of a component of T_SC0's rotation [deg], above
  Bound offset_std_ms{0.5, 5.0};        ///< of the time offset [ms], above
  Bound lever_arm_m{0.5, 2.0};          ///< length of T_SC0's translation [m], above
  Bound offset_ms{100, 1000};           ///< size of the time offset [ms], above
  Bound camera_shift_ms{1, 100};        ///< largest time offset between cameras [ms], above
  /// Between the views of a frame that only a wider --sync-tolerance-ms pairs [ms], above.
  Bound frame_spread_ms{0, 100};
  Bound principal_point{0.1,
                        0.25};  ///< distance from the image's centre, relative to its side, above
  /// Strip without corners at the right or lower edge of an image that the rest says is smaller, as
  /// a share of its side, above.
  Bound resolution{0.04, 0.5};
  Bound unseen_rows{0, 1e3};  ///< upper rows of tags that no view ever showed, above
  /// |spacing by the corners / stated - 1|, above; EuRoC's imu_april shows 4 % (0.312
  /// for 0.3), for a reason that is not known.
  Bound tag_spacing{0.05, 0.1};
  Bound target_shape_mm{3, 20};        ///< RMS by which the board departs from the grid [mm], above
  Bound frames_without_imu{0.1, 0.6};  ///< share of the frames that no IMU samples cover, above
  Bound imu_gaps{0, 50};               ///< pauses of the IMU, above
  Bound imu_rate{0.2, 4};              ///< |measured / stated rate - 1|, above
  Bound target_scale{0.01, 0.03};      ///< |size by the IMU / stated - 1|, above
  /// What the linear inertial fit leaves, over noise, from where its scale is not believed (bad is
  /// not used).
  Bound inertial_fit{2, 1e6};
  /// Of frames' stamps [ms], above: at 1 rad/s and a focal length of 500 px 0.1 ms moves corners by
  /// 0.05 px, less than their noise.
  Bound stamp_jitter_ms{0.1, 3};
  Bound frames_against_imu{1.5, 10};  ///< noise of frames' poses over that of corners, above
  Bound imu_spikes{0, 1e6};           ///< samples that their neighbours contradict, above
  Bound repeated_views{0, 1e6};       ///< views that were delivered twice, above
  Bound misplaced_tags{0, 1e6};       ///< tags with another's id, above
  Bound false_corners{0.01, 0.5};     ///< share of corners far off where their view says, above
  Bound clipped_samples{0, 1e6};      ///< samples of a channel at the end of its range, above
  /// Share of a sensor's readings that repeat a neighbour, or lie on the line between both, above;
  /// a raw stream has 0.2 %, one interpolated from a third of its rate a third.
  Bound resampled{0.2, 2};
  Bound isolated_residual{30, 1e6};  ///< largest inertial residual over their median, above
  Bound long_residuals{2, 1e6};      ///< inertial residuals over what segments explain, above
  /// What an unmodelled fault, or a decentred lens, moves the calibration by, in its standard
  /// deviations, above.
  Bound fault_sigma{1, 50};
  /// Chi-square of the halves' difference over what one recording in a hundred exceeds by chance,
  /// above.
  Bound halves{1, 1e6};
  Bound gravity{0.003, 0.03};  ///< |gravity as measured / assumed - 1|, above
  /// By what factor an assumed density of the IMU is too small, above; below 1 / 5 (too large) it
  /// is caution as well, never bad.
  Bound imu_noise_factor{2, 10};
};

/// Applies every rule that the record has data for: the camera rules to each camera, the camera-IMU
/// rules where that stage ran. The largest of formal, cluster-robust and bootstrap standard
/// deviation is judged, since formal standard deviations are not accuracy.
/// `session`: the recording's, where it is at hand, with how its views were paired.
Verdict judge(const CalibrationRecord& record, const VerdictThresholds& thresholds = {},
              const Session* session = nullptr, const FrameOptions& pairing = {});

}  // namespace plumbline

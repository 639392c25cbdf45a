// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/trajectory/trajectory_builder.h"

namespace plumbline {

/// Rows of stamp, position and quaternion, separated by commas or blanks: TUM, OpenVINS, EuRoC.
///
/// A header line that names the columns decides their order and may state the stamps' unit.
/// Without one: 8 columns are x y z w and seconds; where commas separate them and the stamps are
/// nanoseconds, or the format was asked for, w x y z as in EuRoC; 20 columns are OpenVINS' (below);
/// 11 and more are EuRoC's; 4 columns are stamp and position.
///
/// OpenVINS (ov_eval, Loader.cpp and Recorder.h) appends the upper triangles of the orientation's
/// and then of the position's covariance. Its orientation error e stands in the body frame,
/// R = R_est Exp(e) (ResultTrajectory.cpp, calculate_nees), so that our da = R e and
/// Cov(da) = R Cov(e) R^T. The file has no cross terms; they are zero here.
TrajectoryFile readPoseTable(const TrajectorySource& source, const TrajectoryReadOptions& options);

/// KITTI's poses: T_WB as 12 numbers a line (3x4, row by row), with `options.times` one stamp in
/// seconds a line. Rotations must be orthonormal within 1e-2.
TrajectoryFile readKitti(const TrajectorySource& source, const TrajectoryReadOptions& options);

/// Motive's CSV (OptiTrack; written by version 1.23 of the format): pairs of names and values in
/// the first line, rows Type, Name, ID and kind of the columns, then frames. Positions are scaled
/// by `Length Units`; the order of the quaternion is that of the columns' axes; stamps are
/// frame / rate, for the Time column is rounded to milliseconds. Frames whose cells are empty are
/// skipped and counted. The take's start time is not used: it names no time zone.
TrajectoryFile readMotive(const TrajectorySource& source, const TrajectoryReadOptions& options);

/// Vicon's CSV: a line "Objects" (Tracker) or "Segments" (Nexus), the rate [Hz], a row with each
/// object's name over its first column, "Frame,Sub Frame,RX,RY,RZ[,RW],TX,TY,TZ,...", units, rows.
/// Stamps are frame / rate. RX,RY,RZ without RW are a rotation vector (what Vicon calls helical,
/// its default); an export as Euler angles has the same header and can only be told where a vector
/// is longer than a full turn, which is refused. Frames with empty cells, or all zeros, are skipped
/// and counted.
TrajectoryFile readVicon(const TrajectorySource& source, const TrajectoryReadOptions& options);

/// The body that `wanted` names among `names`, or the only one. Throws InputError with the names.
std::size_t chooseBody(const TrajectorySource& source, const std::vector<std::string>& names,
                       const std::string& wanted);

}  // namespace plumbline

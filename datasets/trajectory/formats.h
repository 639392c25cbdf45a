// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/files/bad_input.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/trajectory_reader.h"

namespace plumbline {

/// A file's text in memory, as the readers of the formats take it.
struct TrajectorySource {
  std::string path;
  std::string_view text;

  BadInput fault(int line, const Complaint& complaint) const {
    return badInput(path, line, complaint);
  }
};

/// The median of the intervals between poses, of which there must be two.
TimeNs medianInterval(const std::vector<StampedPose>& poses);

/// Largest | |q| - 1 | that is a rounded unit quaternion; two decimals leave 0.01.
constexpr double kQuaternionTolerance = 0.02;

/// Takes poses in the order of the file and refuses those that no trajectory has: numbers that are
/// not finite, quaternions that are far from unit length, stamps that descend.
class TrajectoryBuilder {
 public:
  TrajectoryBuilder(const TrajectorySource& source, TrajectoryFormat format, bool has_orientation);

  void reserve(std::size_t poses) { file_.trajectory.poses.reserve(poses); }
  /// Throws InputError with the line.
  void add(const StampedPose& pose, int line);
  void addCovariance(const Matrix6d& covariance) {
    file_.trajectory.covariances.push_back(covariance);
  }
  void remark(std::string text) { file_.remarks.push_back(std::move(text)); }
  const std::vector<StampedPose>& poses() const { return file_.trajectory.poses; }
  int firstLine() const { return first_line_; }

  /// The trajectory with remarks on equal stamps and, unless they are usual, gaps. Throws
  /// InputError where it is empty.
  TrajectoryFile finish(bool gaps_are_usual = false) &&;

 private:
  void checkOrder(const StampedPose& pose, int line);

  TrajectorySource source_;
  TrajectoryFile file_;
  int first_line_ = 0;
  int equal_stamps_ = 0;
  int equal_line_ = 0;  // of the first equal stamp
};

/// In which unit a table's stamps are: 10^power nanoseconds.
struct StampUnit {
  int power = 9;
  std::string remark;      ///< where the unit is not the format's; else empty
  bool certain = false;    ///< stated, or told by stamps since 1970; else the format's
  bool has_header = true;  ///< whether a header could state it
};

/// What the first rows of a table show of its stamps, in their own unit.
struct FirstStamps {
  int line = 1;  ///< of the first row
  double first = 0;
  std::optional<double> interval;  ///< median; nothing where there are fewer than three rows
};

/// The stated unit, else the format's, else seconds or nanoseconds where only they put the stamp
/// between 1990 and 2100. Throws InputError where the header is contradicted by that, or the
/// stamps are milliseconds or microseconds that no header states. Stamps whose intervals are a
/// usual rate (2 Hz to 1 kHz) in another unit than that are not since 1970, but of a clock that
/// counts from a start of its own: a simulation's, or the time since a sensor was switched on.
/// Throws also where the interval is far too long, before stamps overflow.
///
/// The units are powers as StampUnit's.
StampUnit decideStampUnit(const TrajectorySource& source, const FirstStamps& stamps,
                          std::optional<int> stated, int usual);

/// Throws InputError where the median interval is no rate of poses (0.2 ms to 20 s, or to an hour
/// where the unit is certain), naming the unit in which it would be.
void checkPoseIntervals(const TrajectorySource& source, const std::vector<StampedPose>& poses,
                        const StampUnit& unit, int line);

/// What the header line of a table of poses states; columns count from 0.
struct TableHeader {
  std::optional<int> stamp_power;                ///< 10^power nanoseconds are the stamps' unit
  std::optional<int> position;                   ///< column of x; y and z follow
  std::optional<std::array<int, 4>> quaternion;  ///< columns of x, y, z, w
};

/// Reads "# timestamp(s) tx ty tz qx qy qz qw", "#timestamp [ns], p_RS_R_x [m], ..., q_RS_w [],
/// ..." and their kind: a name of time, then names separated by commas or blanks, units in
/// brackets. Nothing where the line is some other comment.
std::optional<TableHeader> parseTableHeader(std::string_view line);

/// Rows of stamp, position and quaternion, separated by commas or blanks: TUM, OpenVINS, EuRoC.
///
/// A header line that names the columns decides their order and may state the stamps' unit; names
/// of a quaternion begin with q, or are four side by side that differ in their last letter. One
/// that names a position but no quaternion: orientations are read only where the first row has a
/// unit quaternion in the usual columns.
/// Without one: 8 columns are x y z w and seconds; where commas separate them and the stamps are
/// nanoseconds, or the format was asked for, w x y z as in EuRoC; 20 columns are OpenVINS' (below);
/// 11 and more are EuRoC's; 4 columns are stamp and position.
///
/// OpenVINS (ov_eval, Loader.cpp and Recorder.h) appends the upper triangles of the orientation's
/// and then of the position's covariance. Its orientation error e stands in the body frame,
/// R = R_est Exp(e) (ResultTrajectory.cpp, calculate_nees), so that our da = R e and
/// Cov(da) = R Cov(e) R^T. The file has no cross terms; they are zero here.
TrajectoryFile readPoseTable(const TrajectorySource& source, const TrajectoryReadOptions& options);

/// Mends what readPoseTable() has read from Kalibr's poses by their header (isKalibrPosesHeader()).
void correctKalibrPoses(const TrajectorySource& source, TrajectoryFile& file);

/// KITTI's poses: T_WB as 12 numbers a line (3x4, row by row), with `options.times` one stamp in
/// seconds a line, whose intervals must be those of poses. Rotations must be orthonormal within
/// 1e-2.
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

}  // namespace plumbline

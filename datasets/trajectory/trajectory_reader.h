// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// The layouts that readTrajectory knows; all give p_W = q p_B + p in metres, Hamilton.
enum class TrajectoryFormat {
  kTum,     ///< t [s], p xyz, q xyzw, separated by blanks; also with OpenVINS' covariances
  kEuroc,   ///< t [ns], p xyz, q wxyz, more; ends after p in leica0
  kKitti,   ///< 12 numbers, the upper 3x4 of T_WB row by row, no stamps
  kMotive,  ///< OptiTrack Motive's CSV export 1.2x with rigid bodies
  kVicon,   ///< Vicon Tracker's CSV export of objects
};
constexpr std::array<const char*, 5> enumWords(TrajectoryFormat /*of*/) {
  return {"tum", "euroc", "kitti", "motive", "vicon"};
}

struct TrajectoryReadOptions {
  std::optional<TrajectoryFormat> format;  ///< none: told from the content
  std::string body;             ///< rigid body of a mocap export; needed where it has several
  std::filesystem::path times;  ///< KITTI's times.txt [s]; without it frame i is at i seconds
  /// The caller knows in which order TUM's quaternions are: it is not judged by their values.
  bool order_is_stated = false;
  bool gaps_are_usual = false;  ///< no remark on them: the poses are of chosen views
};

struct TrajectoryFile {
  Trajectory trajectory;  ///< named after the file, without folder and extension
  TrajectoryFormat format = TrajectoryFormat::kTum;
  /// One sentence each: equal stamps, frames without the body, a unit that was recognised.
  std::vector<std::string> remarks;
};

/// Reads a whole trajectory. Stamps become int64 nanoseconds from their decimal text, without a
/// double in between (more than nine decimals of a second are rounded to the nearest); quaternions
/// stay as they are in the file, not normalised. Memory is linear in the file.
///
/// Throws InputError with file and line where the content is not a trajectory: too few or too many
/// columns, numbers that are not finite, quaternions that are far from unit length, stamps that
/// descend or that only make sense in another unit, quaternions in the other order; and where the
/// options name a body or times that files of this format do not have.
TrajectoryFile readTrajectory(const std::filesystem::path& path,
                              const TrajectoryReadOptions& options = {});

/// The first line of Kalibr's poses-*.csv: EuRoC's names without a unit of the stamps, 8 columns.
/// It promises w, x, y, z and Kalibr writes x, y, z, w of the conjugate (JPL), with w >= 0. Where
/// signs show that, and no format is asked for, readTrajectory() reads them so, with a remark;
/// where they show neither, as the header says, with a remark that nothing confirms it.
bool isKalibrPosesHeader(std::string_view line);

/// Poses that were read as that header says, as Kalibr has written them.
void readAsKalibrs(std::vector<StampedPose>& poses);

}  // namespace plumbline

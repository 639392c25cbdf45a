// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

/// How another odometry is made to refine the calibration, and how it prints what it arrives at.
struct OnlineCalibration {
  std::map<std::string, std::string> changes;  ///< of the runner's files: text, what replaces it
  std::string offset;                          ///< stands before t_d [s]
  /// Stands before T_C0S: unit quaternion x, y, z, w in JPL's convention, position [m].
  std::string extrinsics;
};

/// How another odometry is run, as third_party_configs/runners/NAME.yaml says (docs/odometry.md).
/// Words and file names may hold the fields {executable}, {settings} (folder of the exported
/// files), {calibration} (the file that was given), {sequence} (folder that holds mav0), {times}
/// (file with a stamp [ns] a line), {output} (folder of the run) and {run} (its number). An
/// argument $NAME is a variable of the environment, which must be set. In the texts of `files`
/// {cameras} (the calibration's number of them), {stereo} ("true" for two, else "false")
/// and {gravity} [m/s^2] are replaced.
struct Runner {
  std::string name;
  std::string executable;                    ///< found by PATH unless an option names another
  std::vector<std::string> words;            ///< its arguments
  std::optional<ExportTool> settings;        ///< what is exported into {settings}
  std::map<std::string, std::string> files;  ///< written beside them: name, text
  std::map<std::string, std::string> environment;
  std::string trajectory = "{output}/trajectory.txt";  ///< what it writes
  bool imu_clock = false;    ///< its stamps are the IMU's: t_d is taken off
  bool camera_body = false;  ///< its body is camera 0: turned into the IMU's by T_SC0
  bool needs_shifted_imu =
      false;           ///< it knows no time offset: runs on a copy with IMU stamps - t_d
  int least_runs = 1;  ///< fewer say little, as it is not deterministic
  std::optional<OnlineCalibration> online;  ///< empty: it refines nothing, or prints nothing of it
};

/// Reads a runner's file; throws InputError with file and line for unknown words.
Runner readRunner(const std::string& path);

/// "orbslam3", "openvins": those that come with Plumbline; empty for another name.
std::optional<Runner> knownRunner(const std::string& name);

/// A command as one gives it on the command line, its words split at blanks:
/// "my_vio --config {settings} {sequence} {output}/trajectory.txt". Nothing is exported.
Runner runnerOf(const std::string& command);

/// `text` with every {field} replaced by its value; throws InputError for one that is unknown or
/// not closed.
std::string filledIn(const std::string& text, const std::map<std::string, std::string>& fields);

}  // namespace plumbline

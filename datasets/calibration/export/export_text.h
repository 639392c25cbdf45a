// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

/// "Written by Plumbline VERSION from FILE."
std::string provenanceLine(const ExportOptions& options);

/// Paragraphs as lines of at most 96 columns, each behind `prefix`.
std::string wrapped(const std::vector<std::string>& paragraphs, const std::string& prefix);

/// The provenance and the paragraphs as a block of "# " lines.
std::string commentHeader(const ExportOptions& options, const std::vector<std::string>& paragraphs);

/// "%YAML:1.0", which OpenCV's FileStorage wants first, then commentHeader().
std::string opencvHeader(const ExportOptions& options, const std::vector<std::string>& paragraphs);

/// A 4x4 !!opencv-matrix under `key`; `dt` is 'd' (double) or 'f' (float).
std::string opencvMatrix(const std::string& key, const Transform& T, char dt);

/// "KEY: NUMBER\n" with every digit of the double.
std::string numberLine(const std::string& key, double value);

/// The rows of a matrix as "- [a, b, ...]" lines behind `indent`.
std::string yamlRows(const Eigen::MatrixXd& M, const std::string& indent);

/// A time in seconds as whole nanoseconds.
long long nanosecondsOf(double seconds);

/// "0.0021 s (2100000 ns)": every digit of the seconds.
std::string secondsText(double seconds);

/// Where cameras have time offsets of their own and the tool takes one for all, camera 0's: by how
/// much the other cameras' stamps must be moved first, t_d,i - t_d,0. Empty where there is nothing
/// to say.
std::vector<std::string> unlikeOffsets(const Calibration& calibration);

/// The camera's topic, or /NAME/image_raw where it has none that is a plain ROS name.
std::string topicOf(const CameraCalibration& camera);
/// Likewise for the IMU; /imu0.
std::string topicOf(const ImuCalibration& imu);

/// The name with everything but letters, digits, '_' and '-' replaced by '_': fit for a file.
std::string plainName(const std::string& name);

}  // namespace plumbline

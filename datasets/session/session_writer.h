// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/session.h"

namespace plumbline {

/// What stands in place of a camera's views.
enum class ViewFormat {
  kCorners,  ///< camN/corners.csv
  kImages,   ///< camN/data/<stamp>.png
};

/// A text file of a session folder.
struct TextFile {
  std::string path;  ///< relative to the folder, with '/'
  std::string text;
};

/// The text files of a session in the EuRoC ASL layout: mav0/camN/{data.csv,sensor.yaml} (and
/// corners.csv where the views are corners), mav0/imu0/{data.csv,sensor.yaml}, target.yaml and
/// imu.yaml as Kalibr reads them. Corners have 9 decimals, IMU samples 12 significant digits.
std::vector<TextFile> sessionFiles(const Session& session, double camera_rate_hz, ViewFormat views);

}  // namespace plumbline

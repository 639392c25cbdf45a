// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/calibration/calibration_extras.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// A calibration's file with all that belongs to it.
struct ComparedFile {
  std::string path;
  ComparedCalibration compared;
  CalibrationExtras extras;
  bool states_noise = false;     ///< whether calibration.imu->noise was read
  std::vector<Finding> remarks;  ///< what Kalibr's text beside its YAML says of itself
};

/// Reads the files. Kalibr's come with the texts and imu.yaml of their run, where these stand
/// beside them. Labels: as given, else the file's name without ending, with as many folders in
/// front as make all unique.
std::vector<ComparedFile> readCompared(const std::vector<std::string>& paths,
                                       const std::vector<std::string>& labels);

}  // namespace plumbline

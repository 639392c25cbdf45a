// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/calibration_score.h"

#include <algorithm>

namespace plumbline {

std::vector<std::string> cameraNames(const std::vector<CalibrationScore>& scores) {
  std::vector<std::string> names;
  for (const CalibrationScore& score : scores) {
    for (const std::string& name : score.cameras) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

const ErrorStatistics* errorsOf(const CalibrationScore& score, const std::string& camera) {
  const auto name = std::find(score.cameras.begin(), score.cameras.end(), camera);
  const auto i = static_cast<std::size_t>(name - score.cameras.begin());
  return i < score.per_camera.size() ? &score.per_camera[i] : nullptr;
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/calibration_score.h"

#include <algorithm>

namespace plumbline {

std::vector<std::string> cameraNames(const std::vector<CalibrationScore>& scores) {
  std::vector<std::string> names;
  for (const CalibrationScore& score : scores) {
    for (const std::string& name : score.cameras) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

const ErrorStatistics* errorsOf(const CalibrationScore& score, const std::string& camera) {
  const auto name = std::ranges::find(score.cameras, camera);
  const auto i = static_cast<std::size_t>(name - score.cameras.begin());
  const bool known = i < std::min(score.cameras.size(), score.per_camera.size());
  return known ? &score.per_camera[i] : nullptr;
}

std::string partName(const CalibrationScore& score) {
  return score.label + "/" + score.session + "/" + score.part;
}

Named<ErrorStatistics> errorsByCamera(const CalibrationScore& score) {
  Named<ErrorStatistics> errors;
  for (std::size_t c = 0; c < score.per_camera.size(); ++c) {
    errors.emplace_back(c < score.cameras.size() ? score.cameras[c] : "cam" + std::to_string(c),
                        score.per_camera[c]);
  }
  return errors;
}

void setErrorsByCamera(const Named<ErrorStatistics>& errors, CalibrationScore& score) {
  score.cameras.clear();
  score.per_camera.clear();
  for (const auto& [name, statistics] : errors) {
    score.cameras.push_back(name);
    score.per_camera.push_back(statistics);
  }
}

}  // namespace plumbline

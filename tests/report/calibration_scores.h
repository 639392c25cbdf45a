// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline::test {

/// A score of 9 px over 10 corners, with 5 corners and the given RMSE [px] in each camera named.
inline CalibrationScore scoreOf(const std::string& session,
                                const std::vector<std::pair<std::string, double>>& cameras) {
  CalibrationScore score;
  score.session = session;
  score.part = "all";
  score.reprojection.rmse_px = 9;
  score.reprojection.count = 10;
  for (const auto& [name, rmse_px] : cameras) {
    score.cameras.push_back(name);
    score.per_camera.push_back({});
    score.per_camera.back().rmse_px = rmse_px;
    score.per_camera.back().count = 5;
  }
  return score;
}

}  // namespace plumbline::test

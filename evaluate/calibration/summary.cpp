// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/summary.h"

#include <algorithm>

#include <fmt/format.h>

namespace plumbline {
namespace {

std::string rmse(const ErrorStatistics* e) {
  const bool known = e != nullptr && e->count > 0;
  return known ? fmt::format("{:>11.4f}", e->rmse_px) : fmt::format("{:>11}", "-");
}

std::string nameOf(const CalibrationScore& s) {
  if (s.part == "all") return s.session + (s.held_out ? ", held out" : "");
  return s.part + (s.held_out ? ", held out" : ", calibrated on");
}

std::string line(const CalibrationScore& s, const std::vector<std::string>& cameras,
                 std::size_t width) {
  if (s.reprojection.count == 0) return fmt::format("{:<{}}  {}\n", nameOf(s), width, s.problem);
  std::string text = fmt::format("{:<{}}", nameOf(s), width) + rmse(&s.reprojection);
  for (const std::string& camera : cameras) text += rmse(errorsOf(s, camera));
  text += rmse(s.camera_imu ? &*s.camera_imu : nullptr);
  text += fmt::format("{:>10}{:>8}\n", s.reprojection.count, s.views_used);
  if (!s.problem.empty()) text += "  " + s.problem + "\n";
  return text;
}

}  // namespace

std::string evaluationSummary(const CalibrationRecord& record) {
  const HeldCalibration& evaluation = *record.held;
  std::size_t width = 0;
  for (const CalibrationScore& score : evaluation.scores) {
    width = std::max(width, nameOf(score).size());
  }
  std::string text = fmt::format("{}\n{:<{}}{:>11}", evaluation.file, "RMSE [px]", width, "all");
  const std::vector<std::string> cameras = cameraNames(evaluation.scores);
  for (const std::string& camera : cameras) text += fmt::format("{:>11}", camera);
  text += fmt::format("{:>11}{:>10}{:>8}\n", "with IMU", "corners", "views");
  for (const CalibrationScore& score : evaluation.scores) text += line(score, cameras, width);
  return text;
}

}  // namespace plumbline

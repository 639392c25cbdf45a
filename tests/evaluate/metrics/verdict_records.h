// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline::test {

/// One camera, corners spread evenly over the image with the given error, views tilted as given.
inline CalibrationRecord cameraRecord(double error_px, double tilt_rad, int frames = 40) {
  CameraStageResult stage;
  CameraCalibration camera;
  camera.name = "cam0";
  camera.intrinsics.resolution = {800, 600};
  camera.intrinsics.projection = Eigen::Vector4d(450, 450, 400, 300);
  camera.intrinsics.distortion = Eigen::Vector4d::Zero();
  stage.cameras = {camera};
  for (int f = 0; f < frames; ++f) {
    stage.frames.push_back({f * 1'000'000'000LL, {f}});
    const Eigen::Matrix3d frontal = expSO3(Eigen::Vector3d(std::numbers::pi, 0, 0));
    stage.T_FC0.emplace_back(frontal * expSO3(Eigen::Vector3d(tilt_rad, 0, 0)),
                             Eigen::Vector3d(0, 0, 1));
    for (int k = 0; k < 48; ++k) {
      const float sign = (f + k) % 2 == 0 ? 1.0F : -1.0F;  // no systematic part
      stage.residuals.push_back(
          {0,
           f,
           4 * k,  // one corner of each tag
           {100.0F * static_cast<float>(k % 8) + 50, 100.0F * static_cast<float>(k / 8) + 50},
           {sign * static_cast<float>(error_px), 0},
           true});
    }
  }
  ErrorStatistics statistics;
  statistics.rmse_px = error_px;
  statistics.count = 1920;
  stage.summary.per_camera.push_back(statistics);
  stage.summary.corners_used = stage.summary.corners_offered = 1920;
  stage.summary.converged = true;
  CalibrationRecord record;
  record.target.cols = 8;
  record.target.rows = 6;
  record.camera = stage;
  return record;
}

/// Of the first finding whose rule contains the words.
inline VerdictLevel levelOf(const Verdict& verdict, const std::string& rule) {
  for (const Finding& finding : verdict.findings) {
    if (finding.rule.find(rule) != std::string::npos) return finding.level;
  }
  ADD_FAILURE() << "no finding " << rule;
  return VerdictLevel::kBad;
}

/// Of that very rule.
inline Finding findingOf(const Verdict& verdict, const std::string& rule) {
  for (const Finding& finding : verdict.findings) {
    if (finding.rule == rule) return finding;
  }
  throw std::runtime_error("no finding " + rule);
}

}  // namespace plumbline::test

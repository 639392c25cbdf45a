// SPDX-License-Identifier: BSD-3-Clause
// The systematic share of residuals: none for white noise, known for an error that is put in, most
// of it for a lens model that misfits.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/halves.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

/// Residuals of 100 views of the whole board: noise, and a smooth error of given RMS per axis.
CameraStageResult residualsOf(double noise_px, double smooth_px) {
  const AprilGrid board;
  CameraStageResult stage;
  stage.cameras.resize(1);
  stage.cameras[0].name = "cam0";
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, noise_px);
  for (int frame = 0; frame < 100; ++frame) {
    stage.frames.emplace_back();
    for (int id = 0; id < board.cornerCount(); ++id) {
      CornerResidual r;
      r.frame = frame;
      r.corner_id = id;
      const double phase = 3.1415926 * board.corner(id).x() / board.width() + frame;
      const double smooth = smooth_px * std::sqrt(2) * std::sin(phase);
      r.error = Eigen::Vector2f(static_cast<float>(smooth + normal(random)),
                                static_cast<float>(-smooth + normal(random)));
      stage.residuals.push_back(r);
    }
  }
  return stage;
}

TEST(BiasRatio, OfASmoothErrorIsItsShareOfTheSquares) {
  const BiasRatio bias = biasRatios(AprilGrid(), residualsOf(0.2, 0.4)).at(0);
  EXPECT_EQ(bias.patches, 900);
  EXPECT_NEAR(bias.noise_px, 0.2, 0.02);  // half a wave over the board hardly bends in a patch
  EXPECT_NEAR(bias.ratio, 0.8, 0.04);     // 0.16 / 0.20
}

TEST(BiasRatio, OfWhiteNoiseIsNothing) {
  const BiasRatio bias = biasRatios(AprilGrid(), residualsOf(0.2, 0)).at(0);
  EXPECT_NEAR(bias.noise_px, 0.2, 0.003);
  EXPECT_LT(bias.ratio, 2 / std::sqrt(900));
}

TEST(BiasRatio, SaysNothingOnFewPatches) {
  CameraStageResult stage = residualsOf(0.2, 0);
  stage.residuals.resize(144 * 2);
  EXPECT_EQ(biasRatios(AprilGrid(), stage).at(0).patches, 0);
}

TEST(BiasRatio, ABoardOfOneRowHasNoPatches) {
  AprilGrid row;
  row.rows = 1;
  CameraStageResult stage = residualsOf(0.2, 0);
  std::erase_if(stage.residuals,
                [&](const CornerResidual& r) { return r.corner_id >= row.cornerCount(); });
  const BiasRatio bias = biasRatios(row, stage).at(0);
  EXPECT_EQ(bias.patches, 0);
  EXPECT_NEAR(bias.error_px, 0.2, 0.02);
}

CameraStageResult calibratedAs(DistortionModel distortion) {
  SimulationOptions recording;
  recording.duration_s = 15;
  recording.camera_rate_hz = 5;
  recording.corner_sigma_px = 0.1;
  const auto s = simulateSession(simulatedRig("tumvi"), recording);  // equidistant
  CameraStageOptions options;
  options.cauchy_px = 0;
  options.models.assign(s.session.cameras.size(), {ProjectionModel::kPinhole, distortion});
  const auto result = calibrateCameras(s.session, options);
  EXPECT_TRUE(result.ok());
  return *result;
}

TEST(BiasRatio, TellsALensModelThatMisfits) {
  for (const BiasRatio& bias : calibratedAs(DistortionModel::kEquidistant).bias) {
    EXPECT_NEAR(bias.noise_px, 0.1, 0.005) << bias.camera;
    EXPECT_LT(bias.ratio, 0.05) << bias.camera;
  }
  for (const BiasRatio& bias : calibratedAs(DistortionModel::kFov).bias) {
    EXPECT_NEAR(bias.noise_px, 0.1, 0.03) << bias.camera;
    EXPECT_GT(bias.ratio, 0.3) << bias.camera;
  }
}

}  // namespace
}  // namespace plumbline

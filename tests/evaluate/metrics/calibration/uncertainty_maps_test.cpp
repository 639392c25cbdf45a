// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/uncertainty_maps.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/simulate/rig.h"

namespace plumbline {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// A solved stage of which the focal lengths alone are uncertain: by 0.5 px.
CameraStageResult stageOf(const std::vector<CameraCalibration>& cameras) {
  CameraStageResult stage;
  stage.cameras = cameras;
  ParameterCovariance& covariance = stage.summary.covariance;
  for (const CameraCalibration& camera : cameras) {
    const Intrinsics& k = camera.intrinsics;
    for (const auto& [name, unit] : intrinsicParameters(k.projection_model, k.distortion_model)) {
      covariance.names.push_back(camera.name + "." + name);
    }
  }
  const auto n = static_cast<Eigen::Index>(covariance.names.size());
  covariance.matrix = 1e-18 * Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::string& name = covariance.names[static_cast<std::size_t>(i)];
    if (name.ends_with(".fu") || name.ends_with(".fv")) covariance.matrix(i, i) = 0.25;
  }
  return stage;
}

TEST(UncertaintyMaps, AFocalLengthMovesPointsAwayFromTheCentre) {
  const auto cameras = simulatedRig("euroc").calibration.cameras;
  const CameraStageResult stage = stageOf(cameras);
  const auto maps = uncertaintyMaps(cameras, "session", uncertaintyOfStage(stage), {kFar});
  ASSERT_EQ(maps.size(), cameras.size());
  EXPECT_EQ(maps[1].camera, cameras[1].name);
  EXPECT_EQ(maps[0].method, "image fit to the formal covariance");
  const ImageGrid grid;
  const double centre = maps[0].values[static_cast<std::size_t>(grid.size() / 2)];
  EXPECT_LT(centre, 0.1 * maps[0].values.front());
  EXPECT_GT(maps[0].values.front(), 0.1);
  EXPECT_LT(maps[0].values.front(), 0.5);
}

TEST(UncertaintyMaps, TheRobustCovarianceIsTakenWhereThereIsOne) {
  const auto cameras = simulatedRig("euroc").calibration.cameras;
  CameraStageResult stage = stageOf(cameras);
  const auto formal = uncertaintyMaps(cameras, "", uncertaintyOfStage(stage), {kFar});
  const Eigen::Index n = stage.summary.covariance.matrix.rows();
  RobustCovariance& known = stage.robust_covariance.emplace();
  known.matrix = Eigen::MatrixXd::Identity(n + 12, n + 12);  // the board's terms last
  known.matrix.topLeftCorner(n, n) = 4 * stage.summary.covariance.matrix;
  const auto robust = uncertaintyMaps(cameras, "", uncertaintyOfStage(stage), {kFar});
  EXPECT_EQ(robust[0].method, "image fit to the cluster-robust covariance");
  for (std::size_t i = 0; i < formal[0].values.size(); i += 50) {
    EXPECT_NEAR(robust[0].values[i], 2 * formal[0].values[i], 1e-6 * formal[0].values[i]) << i;
  }
}

TEST(UncertaintyMaps, NothingIsMappedOfACameraThatTheCovarianceLacks) {
  const auto cameras = simulatedRig("euroc").calibration.cameras;
  CameraStageResult stage = stageOf({cameras[0]});
  stage.cameras = cameras;
  const auto maps = uncertaintyMaps(cameras, "", uncertaintyOfStage(stage), {kFar, 1});
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[1].camera, cameras[0].name);
  EXPECT_EQ(maps[1].range_m, 1);
}

}  // namespace
}  // namespace plumbline

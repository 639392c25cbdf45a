// SPDX-License-Identifier: BSD-3-Clause
// The camera stage ends where Ceres does, at the same cost.
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/oracle/camera_oracle.h"

namespace plumbline {
namespace {

TEST(CameraBatch, EqualsCeresWithAndWithoutLoss) {
  SimulationOptions recording;
  recording.duration_s = 4;
  recording.camera_rate_hz = 5;
  recording.corner_sigma_px = 0.3;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), recording);
  for (const double cauchy_px : {0.0, 1.5}) {
    CameraStageOptions options;
    options.cauchy_px = cauchy_px;
    const auto ours = calibrateCameras(s.session, options);
    ASSERT_TRUE(ours.ok()) << ours.failure();
    const oracle::CameraState state{ours->cameras, ours->T_FC0};
    const auto ceres = oracle::solveCameras(s.session, ours->frames, state,
                                            {.cauchy_px = cauchy_px, .covariance = false});
    EXPECT_NEAR(ours->summary.cost, ceres.cost, 1e-12 * ceres.cost);
    const Eigen::VectorXd std = ours->summary.covariance.standardDeviations();
    const Eigen::VectorXd d = oracle::difference(state, ceres.state).head(std.size());
    // So near that the cost tells them apart by its last digits alone.
    EXPECT_LT(d.cwiseQuotient(std).cwiseAbs().maxCoeff(), 5e-6);
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// What an error that all views share does to the calibration: corners displaced by smooth fields
// that the test draws itself, calibrated anew, against the covariance that is stated for such an
// error.
#include "calibrator/batch/camera/common_error.h"

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/batch/halves.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulatedSession stereoRecording(double sigma_px, double duration_s = 8) {
  SimulationOptions simulation;
  simulation.duration_s = duration_s;
  simulation.camera_rate_hz = 4;
  simulation.imu_rate_hz = 10;
  simulation.corner_sigma_px = sigma_px;
  return simulateSession(simulatedRig("euroc"), simulation);
}

/// sqrt(2 n + 1) P_n(x), n = 0 ... 5, by Bonnet's recursion.
std::array<double, 6> legendre(double x) {
  std::array<double, 6> P{1, x};
  for (int n = 1; n < 5; ++n) P[n + 1] = ((2 * n + 1) * x * P[n] - n * P[n - 1]) / (n + 1);
  for (int n = 0; n < 6; ++n) P[n] *= std::sqrt(2. * n + 1);
  return P;
}

/// All corners of both cameras, each camera's displaced by a field of its own.
Session displaced(Session session, double px, std::mt19937& random) {
  std::normal_distribution<double> amplitude(0, px);
  for (CameraStream& camera : session.cameras) {
    std::array<std::array<Eigen::Vector2d, 6>, 6> field;
    for (auto& row : field) {
      for (auto& d : row) d = {amplitude(random), amplitude(random)};
    }
    for (ImageView& view : camera.views) {
      for (Corner& corner : view.corners) {
        const auto x = legendre(2 * (corner.uv.x() + 0.5) / camera.resolution.width - 1);
        const auto y = legendre(2 * (corner.uv.y() + 0.5) / camera.resolution.height - 1);
        for (int i = 0; i < 6; ++i) {
          for (int j = 0; i + j < 6; ++j) corner.uv += x[i] * y[j] * field[i][j];
        }
      }
    }
  }
  return session;
}

CameraStageOptions withoutLoss() {
  CameraStageOptions options;
  options.cauchy_px = 0;
  return options;
}

/// Where exact corners lead: displaced by fields of 0.001 px, in whitened coordinates of the stated
/// covariance, 22 numbers a draw of mean square 1. 30 draws tell that to 6 %.
TEST(CommonError, IsTheScatterOfCalibrationsUnderDrawnFields) {
  constexpr double kPx = 1e-3;
  const SimulatedSession s = stereoRecording(0);
  const CameraStageResult exact = calibrateCameras(s.session, withoutLoss()).value();
  const auto corners = usedCorners(s.session, exact.frames, exact.residuals);
  const CameraProblem problem = problemOf(corners, exact.frames, withoutLoss());
  const Eigen::MatrixXd moves =
      commonErrorMoves(problem, estimateOf(exact.cameras, exact.T_FC0), kPx);
  const Eigen::LLT<Eigen::MatrixXd> llt(moves * moves.transpose());
  ASSERT_EQ(llt.info(), Eigen::Success);

  std::mt19937 random(1);
  constexpr int kDraws = 30;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    CameraStageOptions options = withoutLoss();
    options.start = exact.cameras;
    const auto moved = calibrateCameras(displaced(s.session, kPx, random), options);
    ASSERT_TRUE(moved.ok());
    const Eigen::VectorXd e = cameraDifference(moved->cameras, exact.cameras);
    squares += llt.matrixL().solve(e).squaredNorm() / static_cast<double>(e.size());
  }
  EXPECT_NEAR(squares / kDraws, 1, 0.2);
}

/// What a recording states, and what the halves' comparison says.
struct Stated {
  CameraStageResult result;
  std::optional<HalvesCheck> halves;
};

Stated stated(const Session& session, double share) {
  CameraStageOptions options = withoutLoss();
  options.common_error_share = share;
  Stated out{calibrateCameras(session, options).value(), {}};
  out.halves = checkCameraHalves(session, out.result, options);
  return out;
}

TEST(CommonError, EntersRobustDeviationsAtTheCornersNoiseAndNothingElse) {
  constexpr double kNoisePx = 0.2, kShare = 0.3;
  const SimulatedSession s = stereoRecording(kNoisePx);
  const Stated without = stated(s.session, 0), with = stated(s.session, kShare);
  const auto& a = without.result.summary;
  const auto& b = with.result.summary;

  const auto corners = usedCorners(s.session, with.result.frames, with.result.residuals);
  const CameraProblem problem = problemOf(corners, with.result.frames, withoutLoss());
  const Eigen::VectorXd common =
      commonErrorMoves(problem, estimateOf(with.result.cameras, with.result.T_FC0),
                       kShare * kNoisePx)
          .rowwise()
          .squaredNorm();
  const Eigen::ArrayXd added = b.robust_std->array().square() - a.robust_std->array().square();
  for (Eigen::Index k = 0; k < added.size(); ++k) {
    // The corners' noise is known to 1 % from their residuals.
    EXPECT_NEAR(added[k], common[k], 0.05 * common[k]) << b.covariance.names[k];
    EXPECT_GT((*b.robust_dof)[k], (*a.robust_dof)[k]) << b.covariance.names[k];
  }
  EXPECT_EQ(a.covariance.matrix, b.covariance.matrix) << "formal deviations are of noise alone";
}

TEST(CommonError, MakesHalvesThatAllHaveItDifferByNoMoreThanTheirViews) {
  const SimulatedSession s = stereoRecording(0.02);
  std::mt19937 random(3);
  const Session session = displaced(s.session, 0.02, random);
  const Stated without = stated(session, 0), with = stated(session, 1);
  ASSERT_TRUE(without.halves && with.halves);
  for (std::size_t k = 0; k < with.halves->blocks.size(); ++k) {
    EXPECT_LT(with.halves->blocks[k].chi2, 0.5 * without.halves->blocks[k].chi2);
  }
}

/// Standard deviations under 0.01 px.
Eigen::VectorXd deviationsOf(const Session& session) {
  const CameraStageResult result = calibrateCameras(session, withoutLoss()).value();
  const auto corners = usedCorners(session, result.frames, result.residuals);
  const CameraProblem problem = problemOf(corners, result.frames, withoutLoss());
  const CameraEstimate estimate = estimateOf(result.cameras, result.T_FC0);
  return commonErrorMoves(problem, estimate, 0.01).rowwise().norm();
}

// 120 frames, of which every fourth would be asked: none of those has camera 1.
TEST(CommonError, IsKnownWhereCamerasHaveUnlikeRates) {
  const SimulatedSession s = stereoRecording(0.1, 30);
  Session slow = s.session;
  auto& views = slow.cameras[1].views;
  for (std::size_t i = 0; i < views.size(); i += 2) views[i].corners.clear();
  const Eigen::VectorXd all = deviationsOf(s.session), half = deviationsOf(slow);
  // Other views answer to the fields in another way, but not much.
  for (Eigen::Index k = 0; k < all.size(); ++k) {
    EXPECT_GT(half[k], 0.5 * all[k]) << k;
    EXPECT_LT(half[k], 2 * all[k]) << k;
  }
}

TEST(CommonError, IsKnownOfOneCamera) {
  const SimulatedSession s = stereoRecording(0.1);
  Session mono = s.session;
  mono.cameras.resize(1);
  const Eigen::VectorXd deviations = deviationsOf(mono);
  EXPECT_EQ(deviations.size(), 8);
  EXPECT_GT(deviations.minCoeff(), 0);
}

TEST(CommonError, DoesNotDependOnThreads) {
  const SimulatedSession s = stereoRecording(0.2);
  const CameraStageResult result = calibrateCameras(s.session, withoutLoss()).value();
  const auto corners = usedCorners(s.session, result.frames, result.residuals);
  CameraProblem problem = problemOf(corners, result.frames, withoutLoss());
  const CameraEstimate estimate = estimateOf(result.cameras, result.T_FC0);
  const Eigen::MatrixXd one = commonErrorMoves(problem, estimate, 1e-3);
  problem.threads = 4;
  EXPECT_EQ(one, commonErrorMoves(problem, estimate, 1e-3));
}

}  // namespace
}  // namespace plumbline

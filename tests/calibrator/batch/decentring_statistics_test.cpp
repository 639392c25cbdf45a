// SPDX-License-Identifier: BSD-3-Clause
// A decentred lens under a model without tangential terms: poses absorb it, the test names it, and
// says by how much they turn.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

SimulatedSession recordedThrough(const Intrinsics& lens, double sigma_px, std::uint64_t seed = 1) {
  SimulatedRig rig = simulatedRig("euroc");
  rig.calibration.cameras.resize(1);
  rig.calibration.cameras[0].intrinsics = lens;
  SimulationOptions options;
  options.duration_s = 30;
  options.camera_rate_hz = 5;
  options.corner_sigma_px = sigma_px;
  options.seed = seed;
  return simulateSession(rig, options);
}

/// EuRoC's image through a decentred lens, of 100 degrees over the width at xi 0.9 and 130 at 1.5.
Intrinsics decentredWide(double p1, double p2, double xi = 1.5) {
  Intrinsics lens = test::radtanCamera();
  lens.projection_model = ProjectionModel::kOmni;
  lens.projection.resize(5);
  lens.projection << xi, 760, 759, 367.2, 248.4;
  lens.distortion << (xi > 1 ? -0.1 : -0.02), 0.01, p1, p2;
  return lens;
}

CameraStageResult calibratedUnder(const SimulatedSession& s, ProjectionModel projection,
                                  DistortionModel distortion = DistortionModel::kNone) {
  CameraStageOptions options;
  options.models = {{projection, distortion}};
  const auto result = calibrateCameras(s.session, options);
  EXPECT_TRUE(result.ok()) << result.failure();
  return result.value();
}

/// By how much estimated poses of the target are turned in the camera's frame, mean [rad].
Eigen::Vector3d meanTurnOf(const SimulatedSession& s, const CameraStageResult& result) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t f = 0; f < result.frames.size(); ++f) {
    const Transform T_FC = s.cameraPose(0, result.frames[f].t);
    const Transform turn(result.T_FC0[f].R.transpose() * T_FC.R, Eigen::Vector3d::Zero());
    sum += boxminus(turn, Transform()).tail<3>();
  }
  return sum / static_cast<double>(result.frames.size());
}

// Where nothing else misfits, one step leads to the terms themselves.
TEST(Decentring, OfAPinholeItIsTheTermsThatItsModelLacks) {
  Intrinsics lens = test::radtanCamera();
  lens.distortion << 0, 0, 3e-4, -5e-4;
  const SimulatedSession s = recordedThrough(lens, 0);
  const CameraStageResult result = calibratedUnder(s, ProjectionModel::kPinhole);
  ASSERT_EQ(result.decentring.size(), 1U);
  const Decentring& d = result.decentring[0];
  EXPECT_EQ(d.camera, "cam0");
  EXPECT_TRUE(d.isSignificant());
  EXPECT_NEAR(d.p[0], 3e-4, 3e-6);
  EXPECT_NEAR(d.p[1], -5e-4, 5e-6);
}

// Under the loss, too: all rows have the weights that it gives the residuals.
TEST(Decentring, OfAPinholeWithNoiseItIsWithinItsDeviations) {
  Intrinsics lens = test::radtanCamera();
  lens.distortion << 0, 0, 3e-4, -5e-4;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto result =
        calibratedUnder(recordedThrough(lens, 0.4, seed), ProjectionModel::kPinhole);
    const Decentring& d = result.decentring.at(0);
    EXPECT_LT(std::abs(d.p[0] - 3e-4) / d.std[0], 3.5) << seed;
    EXPECT_LT(std::abs(d.p[1] + 5e-4) / d.std[1], 3.5) << seed;
    EXPECT_LT(d.std.maxCoeff(), 2e-4) << seed;
  }
}

// What T_SC0 is off by: the turn undoes that of the poses, which residuals do not show.
TEST(Decentring, SaysByHowMuchThePosesOfAWideLensAreTurned) {
  for (const ProjectionModel model : {ProjectionModel::kEucm, ProjectionModel::kDs}) {
    const SimulatedSession s = recordedThrough(decentredWide(5e-4, -3e-4, 0.9), 0.2);
    const CameraStageResult result = calibratedUnder(s, model);
    const Decentring& d = result.decentring.at(0);
    const Eigen::Vector3d turned = meanTurnOf(s, result);
    EXPECT_LT(result.summary.reprojection.rmse_px, 0.2 * std::sqrt(2) * 1.01);
    EXPECT_GT(turned.norm(), 5e-4) << toString(model);
    EXPECT_TRUE(d.isSignificant()) << toString(model) << " " << d.f << " " << d.limit;
    EXPECT_LT((d.turn + turned).norm(), 0.35 * turned.norm())
        << toString(model) << ": " << d.turn.transpose() << " against " << turned.transpose();
  }
}

TEST(Decentring, OfACentredLensIsNotSignificant) {
  int significant = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const SimulatedSession s = recordedThrough(decentredWide(0, 0), 0.2, seed);
    for (const ProjectionModel model : {ProjectionModel::kEucm, ProjectionModel::kDs}) {
      const Decentring d = calibratedUnder(s, model).decentring.at(0);
      significant += d.isSignificant() ? 1 : 0;
      EXPECT_LT(d.p.cwiseQuotient(d.std).cwiseAbs().maxCoeff(), 4) << toString(model);
    }
  }
  EXPECT_EQ(significant, 0);
}

// Its terms are free in the test as they were in the batch, or they would have taken part of it.
TEST(Decentring, IsToldFromABoardThatIsBent) {
  const SimulatedSession s = recordedThrough(decentredWide(5e-4, -3e-4), 0.2);
  CameraStageOptions options;
  options.models = {{ProjectionModel::kEucm, DistortionModel::kNone}};
  options.target = TargetMode::kEstimate;
  const auto result = calibrateCameras(s.session, options);
  ASSERT_TRUE(result.ok()) << result.failure();
  const Decentring& d = result->decentring.at(0);
  const Eigen::Vector3d turned = meanTurnOf(s, *result);
  EXPECT_GT(d.f, 2 * d.limit);
  EXPECT_LT((d.turn + turned).norm(), 0.4 * turned.norm());
}

TEST(Decentring, IsNotTestedWhereTheModelHasTheTerms) {
  const SimulatedSession s = recordedThrough(test::radtanCamera(), 0.2);
  const auto result = calibratedUnder(s, ProjectionModel::kPinhole, DistortionModel::kRadtan);
  EXPECT_TRUE(result.decentring.empty());
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// One board from several recordings.
#include "calibrator/batch/joint_target.h"

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

const double kPrior = TargetModel(AprilGrid()).prior_std;

TargetFit fitOf(const TargetTerms& terms, double std) {
  TargetFit fit;
  fit.shape.terms = terms;
  fit.shape.covariance = std * std * TargetCovariance::Identity();
  fit.std.setConstant(std);
  return fit;
}

TEST(JointTarget, IsTheMeanWeightedByInformation) {
  const TargetTerms one = TargetTerms::Constant(1e-3);
  const JointTarget joint = joinTargets({fitOf(one, 1e-4), fitOf(2 * one, 2e-4)}, 1);
  EXPECT_NEAR(joint.shape.terms[3], (4 * 1e-3 + 2e-3) / 5, 1e-9);
  // 1 mm apart with 0.22 mm: 11 times 20.
  EXPECT_NEAR(joint.dispersion, 20, 1e-5);
  EXPECT_NEAR((*joint.shape.covariance)(3, 3), 20 * 1e-8 * 4 / 5, 1e-12);
  EXPECT_NEAR(joint.members[0].chi2, 11 * 20, 1e-3);
  EXPECT_NEAR(joint.members[1].chi2, 11 * 20, 1e-3);
  EXPECT_FALSE(joint.members[0].agrees());
  EXPECT_NEAR(joint.members[0].limit, 24.725, 1e-3);
}

TEST(JointTarget, SessionsThatAgreeAreNotTrustedMoreThanTheirDeviations) {
  const TargetTerms one = TargetTerms::Constant(1e-3);
  const JointTarget joint = joinTargets({fitOf(one, 1e-4), fitOf(one, 1e-4)}, 1);
  EXPECT_EQ(joint.dispersion, 1);
  EXPECT_NEAR((*joint.shape.covariance)(3, 3), 0.5e-8, 1e-13);
}

TEST(JointTarget, LargerRobustDeviationsCount) {
  TargetFit loose = fitOf(TargetTerms::Zero(), 1e-4);
  loose.std.setConstant(3e-4);
  const JointTarget joint = joinTargets({loose, fitOf(TargetTerms::Constant(1e-3), 3e-4)}, 1);
  EXPECT_NEAR(joint.shape.terms[0], 5e-4, 1e-9);
}

TEST(JointTarget, OneSessionIsItself) {
  const JointTarget joint = joinTargets({fitOf(TargetTerms::Constant(1e-3), 1e-4)}, kPrior);
  EXPECT_NEAR(joint.shape.terms[0], 1e-3, 1e-12);
  EXPECT_TRUE(joint.members[0].agrees());
  EXPECT_EQ(joint.members[0].terms, 0);
  EXPECT_THROW(joinTargets({}, kPrior), InputError);
  EXPECT_THROW(joinTargets({TargetFit()}, kPrior), InputError);
}

/// A recording of a board with these terms, as its camera stage has it.
TargetFit recorded(const TargetTerms& terms, std::uint64_t seed) {
  SimulationOptions options;
  options.target.shape.terms = terms;
  options.seed = seed;
  options.trajectory.seed = seed;
  options.duration_s = 20;
  options.camera_rate_hz = 5;
  SimulatedSession s = simulateSession(simulatedRig("euroc"), options);
  s.session.target.shape = {};
  CameraStageOptions stage;
  stage.target = TargetMode::kEstimate;
  stage.cauchy_px = 0;
  stage.pixel_sigma = 0.2;
  const auto result = calibrateCameras(s.session, stage);
  EXPECT_TRUE(result.ok());
  return *result->target_fit;
}

TEST(JointTarget, RecordingsOfOneBoardAgreeAndSharpenIt) {
  TargetTerms terms = TargetTerms::Zero();
  terms[0] = 5e-4;   // stretch
  terms[8] = -4e-4;  // bow
  const std::vector<TargetFit> fits = {recorded(terms, 1), recorded(terms, 2), recorded(terms, 3)};
  const JointTarget joint = joinTargets(fits, kPrior);
  const TargetTerms std = joint.shape.covariance->diagonal().cwiseSqrt();
  EXPECT_LT((joint.shape.terms - terms).cwiseQuotient(std).cwiseAbs().maxCoeff(), 4);
  for (const TargetFit& fit : fits) {
    EXPECT_LT(std[0], 0.8 * fit.std[0]);
  }
  for (const TargetMember& member : joint.members) EXPECT_TRUE(member.agrees()) << member.chi2;
}

TEST(JointTarget, ASessionWhoseBoardWasBentIsNamed) {
  TargetTerms terms = TargetTerms::Zero();
  TargetTerms bent = terms;
  bent[8] = 6e-4;
  const JointTarget joint =
      joinTargets({recorded(terms, 1), recorded(terms, 2), recorded(bent, 3)}, kPrior);
  EXPECT_FALSE(joint.members[2].agrees());
  EXPECT_EQ(joint.members[2].worst, "z_xx");
  EXPECT_GT(joint.members[2].chi2, joint.members[0].chi2);
}

}  // namespace
}  // namespace plumbline

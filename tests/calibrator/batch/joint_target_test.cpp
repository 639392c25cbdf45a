// SPDX-License-Identifier: BSD-3-Clause
// One board from several recordings.
#include "calibrator/batch/board/joint_target.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/batch/board/board_system.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

/// A session that knows the twelve terms to `std` each, and nothing of the higher ones.
BoardSystem saying(const TargetTerms& terms, double std) {
  BoardSystem out;
  out.A = Eigen::MatrixXd::Identity(kTargetTerms, kBoardUnknowns) / std;
  out.b = terms / std;
  return out;
}

/// The same but for one direction of the terms.
BoardSystem silentOn(const TargetTerms& direction, const TargetTerms& terms, double std) {
  BoardSystem out = saying(terms, std);
  const TargetCovariance others =
      TargetCovariance::Identity() - direction * direction.transpose() / direction.squaredNorm();
  out.A.leftCols<kTargetTerms>() = others / std;
  out.b = others * terms / std;
  return out;
}

constexpr JointTargetOptions kTwelve{.degree = 2, .prior_std = 1};

TEST(JointTarget, IsTheMeanWeightedByInformation) {
  const TargetTerms one = TargetTerms::Constant(1e-3);
  const JointTarget joint = joinTargets({saying(one, 1e-4), saying(2 * one, 2e-4)}, kTwelve);
  EXPECT_NEAR(joint.shape.terms[3], (4 * 1e-3 + 2e-3) / 5, 1e-9);
  // 1 mm apart with 0.22 mm: 11 times 20.
  EXPECT_NEAR(joint.dispersion, 20, 1e-5);
  EXPECT_NEAR((*joint.shape.covariance)(3, 3), 20 * 1e-8 * 4 / 5, 1e-12);
  EXPECT_NEAR(joint.members[0].chi2, 11 * 20, 1e-3);
  EXPECT_NEAR(joint.members[1].chi2, 11 * 20, 1e-3);
  EXPECT_FALSE(joint.members[0].agrees());
  EXPECT_NEAR(joint.members[0].limit, 24.725, 1e-3);
}

TEST(JointTarget, WithoutTheDispersionAllDeviationsAreThoseOfTheEquations) {
  JointTarget joint;
  joint.dispersion = 4;
  joint.shape.covariance = TargetCovariance::Identity();
  joint.shape.higher_std = HigherTerms::Constant(1);
  EXPECT_EQ((*joint.undispersed().covariance)(3, 3), 0.25);
  EXPECT_EQ((*joint.undispersed().higher_std)(3), 0.5);
}

TEST(JointTarget, TagEdgeIsOfEachSession) {
  TargetTerms one = TargetTerms::Zero();
  TargetTerms other = one;
  other[kTargetTerms - 1] = 1e-3;
  const JointTarget joint = joinTargets({saying(one, 1e-5), saying(other, 1e-4)}, kTwelve);
  EXPECT_NEAR(joint.shape.terms[kTargetTerms - 1], 5e-4, 1e-9);  // the mean, not by weight
  EXPECT_TRUE(joint.members[0].agrees());
  EXPECT_EQ(joint.dispersion, 1);
}

TEST(JointTarget, SessionsThatAgreeAreNotTrustedMoreThanTheirDeviations) {
  const TargetTerms one = TargetTerms::Constant(1e-3);
  const JointTarget joint = joinTargets({saying(one, 1e-4), saying(one, 1e-4)}, kTwelve);
  EXPECT_EQ(joint.dispersion, 1);
  EXPECT_NEAR((*joint.shape.covariance)(3, 3), 0.5e-8, 1e-13);
}

TEST(JointTarget, OneSessionIsItself) {
  const JointTarget joint = joinTargets({saying(TargetTerms::Constant(1e-3), 1e-4)});
  EXPECT_NEAR(joint.shape.terms[0], 1e-3 / (1 + 1 / 2500.), 1e-9);  // drawn to 0 +- 5 mm
  EXPECT_TRUE(joint.members[0].agrees());
  EXPECT_EQ(joint.members[0].terms, 0);
  EXPECT_THROW(joinTargets({}), InputError);
  EXPECT_THROW(joinTargets({saying(TargetTerms::Zero(), 1)}, {.degree = 3}), InputError);
  EXPECT_THROW(joinTargets({saying(TargetTerms::Zero(), 1)}, {.prior_std = 0}), InputError);
}

TEST(JointTarget, NamesTheDirectionThatNoSessionDetermines) {
  TargetTerms bow = TargetTerms::Zero();
  bow[8] = bow[10] = 1 / std::sqrt(2);  // z_xx and z_yy alike
  const TargetTerms terms = TargetTerms::Constant(1e-3);
  const BoardSystem silent = silentOn(bow, terms, 1e-4);
  const JointTarget joint = joinTargets({silent, silent}, {.degree = 2});
  ASSERT_EQ(joint.undetermined.size(), 1U);
  EXPECT_NEAR(std::abs(joint.undetermined[0].dot(bow.head<kTargetTerms - 1>())), 1, 1e-6);
  const double variance = bow.dot(*joint.shape.covariance * bow);
  EXPECT_NEAR(std::sqrt(variance), TargetModel::prior_std, 1e-6);
  EXPECT_TRUE(joint.members[0].agrees());
}

TEST(JointTarget, ADirectionThatOneSessionDeterminesIsDetermined) {
  TargetTerms bow = TargetTerms::Zero(), stretch = bow;
  bow[8] = 1;
  stretch[0] = 1;
  const TargetTerms terms = TargetTerms::Constant(1e-3);
  const JointTarget joint =
      joinTargets({silentOn(bow, terms, 1e-4), silentOn(stretch, terms, 1e-4)}, kTwelve);
  EXPECT_TRUE(joint.undetermined.empty());
  EXPECT_NEAR(joint.shape.terms[8], 1e-3, 1e-8);
  EXPECT_NEAR(joint.shape.terms[0], 1e-3, 1e-8);
}

TEST(JointTarget, NamesOfTermsAreThoseOfTheirPolynomials) {
  EXPECT_EQ(targetTermName(0), "stretch");
  EXPECT_EQ(targetTermName(10), "z_yy");
  EXPECT_EQ(targetTermName(11), "x_xxx");
  EXPECT_EQ(targetTermName(14), "x_yyy");
  EXPECT_EQ(targetTermName(15), "x_xxxx");
  EXPECT_EQ(targetTermName(37), "z_yyyy");
}

/// A recording of a board of this shape, and what its camera stage says of it.
BoardSystem recorded(const TargetShape& shape, std::uint64_t seed, double pixel_sigma = 1,
                     bool perfect = false) {
  SimulationOptions options;
  options.target.shape = shape;
  options.seed = options.trajectory.seed = seed;
  options.duration_s = 20;
  options.camera_rate_hz = 5;
  SimulatedSession s = simulateSession(simulatedRig("euroc"), options);
  s.session.target.shape = {};
  CameraStageOptions stage;
  stage.target = TargetMode::kEstimate;
  stage.cauchy_px = 0;
  stage.pixel_sigma = pixel_sigma;
  const auto calibrated = calibrateCameras(s.session, stage);
  EXPECT_TRUE(calibrated.ok());
  CameraStageResult result = *calibrated;
  if (perfect) result.summary.reprojection.rmse_px = 0;
  return *boardSystem(s.session, result, stage);
}

TargetShape bent() {
  TargetShape shape;
  shape.terms[0] = 5e-4;   // stretch
  shape.terms[8] = -4e-4;  // bow
  return shape;
}

TEST(BoardSystem, DoesNotDependOnTheNoiseStated) {
  const BoardSystem one = recorded(bent(), 1, 1), other = recorded(bent(), 1, 0.2);
  const Eigen::MatrixXd I = one.A.transpose() * one.A;
  EXPECT_LT((I - other.A.transpose() * other.A).norm(), 1e-2 * I.norm());
}

TEST(BoardSystem, OfCornersWithoutErrorIsFinite) {
  EXPECT_TRUE(recorded(bent(), 1, 1, true).A.allFinite());
}

TEST(JointTarget, RecordingsOfOneBoardAgreeAndSharpenIt) {
  const TargetShape shape = bent();
  const std::vector<BoardSystem> systems = {recorded(shape, 1), recorded(shape, 2),
                                            recorded(shape, 3)};
  const JointTarget joint = joinTargets(systems);
  const TargetTerms std = joint.shape.covariance->diagonal().cwiseSqrt();
  const TargetTerms error = joint.shape.terms - shape.terms;
  EXPECT_LT(error.cwiseQuotient(std).cwiseAbs().maxCoeff(), 4);
  for (const BoardSystem& one : systems) {
    const JointTarget own = joinTargets({one});
    EXPECT_LT(std[0], 0.8 * std::sqrt((*own.shape.covariance)(0, 0)));
  }
  for (const TargetMember& member : joint.members) EXPECT_TRUE(member.agrees()) << member.chi2;
  EXPECT_TRUE(joint.undetermined.empty());
  EXPECT_LT(joint.higher_chi2, joint.higher_limit);
  EXPECT_FALSE(joint.shape.higher);
  // In any order of the sessions.
  const JointTarget turned = joinTargets({systems[2], systems[0], systems[1]});
  EXPECT_LT((turned.shape.terms - joint.shape.terms).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(JointTarget, FindsTermsOfHigherDegreesThatTheSessionsShare) {
  TargetShape shape = bent();
  shape.higher = HigherTerms::Zero();
  (*shape.higher)[0] = 2e-4;                          // x_xxx
  (*shape.higher)[2 * kHigherFunctions + 3] = -3e-4;  // z_yyy
  const JointTarget joint =
      joinTargets({recorded(shape, 1), recorded(shape, 2), recorded(shape, 3)});
  EXPECT_GT(joint.higher_chi2, joint.higher_limit);
  ASSERT_TRUE(joint.shape.higher);
  EXPECT_LT((*joint.shape.higher - *shape.higher).norm(), 0.15 * shape.higher->norm());
  for (const TargetMember& member : joint.members) EXPECT_TRUE(member.agrees()) << member.chi2;
}

TEST(JointTarget, ASessionWhoseBoardWasBentIsNamed) {
  const TargetShape flat;
  TargetShape bow;
  bow.terms[8] = 6e-4;
  const JointTarget joint =
      joinTargets({recorded(flat, 1), recorded(flat, 2), recorded(bow, 3)}, {.degree = 2});
  EXPECT_FALSE(joint.members[2].agrees());
  EXPECT_EQ(joint.members[2].worst, "z_xx");
  EXPECT_GT(joint.members[2].chi2, joint.members[0].chi2);
}

}  // namespace
}  // namespace plumbline

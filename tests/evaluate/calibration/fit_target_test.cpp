// SPDX-License-Identifier: BSD-3-Clause
// What a person reads of a board that several sessions show.
#include "evaluate/calibration/fit_target.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

SessionsTarget oneSession() {
  SessionsTarget fit;
  fit.names = {"monday"};
  fit.agreement = {BoardAgreement::kSame};
  fit.joint.shape.covariance = TargetCovariance::Identity() * 1e-10;
  fit.joint.members.resize(1);
  fit.joint.higher_chi2 = fit.joint.higher_limit = std::numeric_limits<double>::quiet_NaN();
  return fit;
}

TEST(JointTargetText, NamesWhatIsNotDetermined) {
  SessionsTarget fit = oneSession();
  EXPECT_THAT(jointTargetText(fit), HasSubstr("Target from 1 session:"));
  EXPECT_THAT(jointTargetText(fit), Not(HasSubstr("do not determine")));
  TargetDirection bow = TargetDirection::Zero(kTargetTerms - 1);
  bow[8] = 0.6;
  bow[10] = -0.8;
  fit.joint.undetermined = {bow};
  EXPECT_THAT(jointTargetText(fit),
              HasSubstr("do not determine +0.60 z_xx -0.80 z_yy (no better than to 5 mm)"));
}

TEST(JointTargetText, TellsWhetherHigherDegreesAreCalledFor) {
  SessionsTarget fit = oneSession();
  EXPECT_THAT(jointTargetText(fit), Not(HasSubstr("degrees 3 and 4")));
  fit.joint.higher_chi2 = 30;
  fit.joint.higher_limit = 47;
  EXPECT_THAT(jointTargetText(fit), HasSubstr("No terms of degrees 3 and 4 (chi-square 30.0"));
  fit.joint.higher_chi2 = 60;
  fit.joint.shape.higher = HigherTerms::Zero();
  (*fit.joint.shape.higher)[3] = 2e-4;
  EXPECT_THAT(jointTargetText(fit), HasSubstr("Terms of degrees 3 and 4: 0.200 mm RMS"));
}

TEST(JointTargetText, SaysOfEverySessionWhetherItShowsThatBoard) {
  SessionsTarget fit = oneSession();
  EXPECT_THAT(jointTargetText(fit), Not(HasSubstr("monday:"))) << "alone it agrees with nobody";
  fit.names = {"monday", "tuesday", "friday"};
  fit.agreement = {BoardAgreement::kSame, BoardAgreement::kSamePredicted, BoardAgreement::kOther};
  TargetMember member;
  member.terms = 11;
  member.chi2 = 12.5;
  member.limit = 24.7;
  member.rms = 2e-4;
  member.worst = "z_xx";
  member.difference = -3e-4;
  member.std = 5e-5;
  fit.joint.members.assign(3, member);
  const std::string text = jointTargetText(fit);
  EXPECT_THAT(text, HasSubstr("Target from 3 sessions:"));
  EXPECT_THAT(text, HasSubstr("  monday: shows the same board (chi-square 12.5 for 11 terms, 99 % "
                              "bound 24.7; 0.200 mm RMS, largest: z_xx by -0.3000 +- 0.0500 mm)"));
  EXPECT_THAT(text, HasSubstr("  tuesday: differs significantly, but its own shape predicts"));
  EXPECT_THAT(text,
              HasSubstr("  friday: differs, and its own shape predicts held-out frames better"));
}

TEST(JointTargetText, TermsAreInMillimetresWithTheirDeviations) {
  SessionsTarget fit = oneSession();
  fit.joint.shape.terms[0] = 1.25e-4;
  EXPECT_THAT(jointTargetText(fit), HasSubstr("  stretch    +0.1250 +- 0.0100 mm\n"));
  EXPECT_THAT(jointTargetText(fit), HasSubstr("0.125 mm RMS deviation from the even grid"));
  EXPECT_THAT(jointTargetText(fit), Not(HasSubstr("are scaled by")));
  fit.joint.dispersion = 4;  // of variances
  EXPECT_THAT(jointTargetText(fit), HasSubstr("Standard deviations are scaled by 2.00,"));
}

}  // namespace
}  // namespace plumbline

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

}  // namespace
}  // namespace plumbline

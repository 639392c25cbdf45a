// SPDX-License-Identifier: BSD-3-Clause
// What a night says of itself, by nights made up by hand.
#include "evaluate/study/night.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Night, WithoutAnyCalibrationIsBadAndBlamesNoNameOfAnEndpoint) {
  const TemporaryFolder folder;
  PreparedNight night;
  night.folder = folder.path();
  night.number = 1;
  night.study.name = "s";
  night.study.file = "STUDY.yaml";
  night.study.methods = {"free"};
  night.study.endpoints = {"held_out_rmse_px"};
  SessionEntry session;
  session.row.name = "a";
  session.row.participant = "p1";
  session.row.method = "free";
  night.study.sessions = {session};
  const NightOutcome outcome = finishNight(night, {}, 1);
  EXPECT_EQ(outcome.level, VerdictLevel::kBad);
  EXPECT_THAT(outcome.document, HasSubstr("0 of 1 sessions have a calibration"));
  EXPECT_THAT(outcome.document, HasSubstr("No session has a calibration, which figures come from"));
  EXPECT_THAT(outcome.document, Not(HasSubstr("Correct endpoints")));
  // The first night of all: there is nothing that it could be worse than.
  EXPECT_THAT(outcome.document, HasSubstr("no night before has figures to compare with"));
}

}  // namespace
}  // namespace plumbline

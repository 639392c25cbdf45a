// SPDX-License-Identifier: BSD-3-Clause
// The design of a simulated study: orders are balanced, skills spread, two give up, practice helps.
#include <algorithm>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/simulation/simulate_study.h"

namespace plumbline {
namespace {

TEST(SimulatedParticipants, AreCounterbalancedAndOfAllSkills) {
  const auto people = simulatedParticipants({});
  ASSERT_EQ(people.size(), 16U);
  int guided_first = 0, give_up_free = 0, give_up_guided = 0;
  std::set<double> skills;
  for (const auto& p : people) {
    ASSERT_EQ(p.visits.size(), 2U);
    EXPECT_EQ(p.visits[0].period, 1);
    EXPECT_NE(p.visits[0].method, p.visits[1].method);
    guided_first += p.visits[0].method == "guided" ? 1 : 0;
    skills.insert(p.clumsiness);
    for (const auto& v : p.visits) {
      (v.method == "free" ? give_up_free : give_up_guided) += v.gives_up ? 1 : 0;
    }
  }
  EXPECT_EQ(guided_first, 8);
  EXPECT_EQ(skills.size(), 16U);
  EXPECT_EQ(give_up_free, 1);
  EXPECT_EQ(give_up_guided, 1);
}

TEST(SimulatedParticipants, LearnFromTheirFirstSession) {
  for (const auto& p : simulatedParticipants({})) {
    const OperatorSkill &first = p.visits[0].skill, &second = p.visits[1].skill;
    EXPECT_NEAR(second.reaction_s, 0.85 * first.reaction_s, 1e-12);
    EXPECT_NEAR(second.position_error_m, 0.85 * first.position_error_m, 1e-12);
    EXPECT_NEAR(second.speed_m_s, first.speed_m_s / 0.85, 1e-12);
  }
}

// Whatever is learned, there are limits to how fast one turns and how far one reaches.
TEST(SimulatedParticipants, LearnNoMoreThanAnybodyCan) {
  StudySimulationOptions o;
  for (const double learning : {0.6, 0.1}) {
    o.learning = learning;
    for (const auto& p : simulatedParticipants(o)) {
      for (const SimulatedVisit& visit : p.visits) {
        EXPECT_NO_THROW(visit.skill.check());
        const SimulatedVisit other = inOtherPeriod(p, visit, o);
        EXPECT_NO_THROW(other.skill.check());
        EXPECT_EQ(inOtherPeriod(p, other, o).skill.reach_rad, visit.skill.reach_rad);
      }
    }
  }
}

TEST(SimulatedParticipants, AreTheSameInTheOtherPeriodButForPractice) {
  for (const auto& p : simulatedParticipants({})) {
    for (const SimulatedVisit& visit : p.visits) {
      const SimulatedVisit other = inOtherPeriod(p, visit, {});
      const double practice = visit.period == 1 ? 0.85 : 1 / 0.85;
      EXPECT_EQ(other.period, 3 - visit.period);
      EXPECT_EQ(other.seed, visit.seed);
      EXPECT_NEAR(other.skill.reaction_s, practice * visit.skill.reaction_s, 1e-12);
      EXPECT_NEAR(other.duration_s,
                  visit.method == "free" ? practice * visit.duration_s : visit.duration_s, 1e-9);
      const SimulatedVisit back = inOtherPeriod(p, other, {});
      EXPECT_NEAR(back.skill.turn_rad_s, visit.skill.turn_rad_s, 1e-12);
      EXPECT_NEAR(back.skill.patience_s, visit.skill.patience_s, 1e-9);
    }
  }
}

TEST(SimulatedParticipants, DependOnTheSeedAlone) {
  StudySimulationOptions o;
  o.threads = 7;
  EXPECT_EQ(simulatedParticipants({})[3].visits[1].seed,
            simulatedParticipants(o)[3].visits[1].seed);
  o.seed = 2;
  EXPECT_NE(simulatedParticipants({})[3].visits[1].seed,
            simulatedParticipants(o)[3].visits[1].seed);
  o.participants = 0;
  EXPECT_THROW(simulatedParticipants(o), InputError);
}

// A trajectory takes some twelve seconds; nobody is sent home before two minutes.
TEST(StudySimulationOptions, LimitAndTrajectoriesFollowTheDuration) {
  StudySimulationOptions o;
  for (const auto& [duration_s, limit_s, trajectories] :
       {std::tuple{10.0, 120.0, 2}, {20.0, 120.0, 2}, {30.0, 180.0, 3}, {60.0, 360.0, 5}}) {
    o.duration_s = duration_s;
    EXPECT_EQ(o.limitS(), limit_s);
    EXPECT_EQ(o.trajectories(), trajectories);
  }
}

TEST(SimulatedParticipants, GiveUpAfterTwoFifthsOfTheShorterDuration) {
  const StudySimulationOptions o;
  for (const auto& p : simulatedParticipants(o)) {
    for (const SimulatedVisit& v : p.visits) {
      const double practice = v.period == 2 ? o.learning : 1;
      if (v.method == "guided") {
        EXPECT_EQ(v.duration_s, o.limitS());
      } else {
        EXPECT_GE(v.duration_s, 0.85 * practice * o.duration_s);
        EXPECT_LE(v.duration_s, 1.15 * practice * o.duration_s);
      }
      const double shorter = std::min(v.duration_s, o.duration_s);
      EXPECT_NEAR(v.skill.patience_s, v.gives_up ? 0.4 * shorter : o.limitS(), 1e-9) << v.name;
    }
  }
}

TEST(SimulatedParticipants, ThreeAreTooFewForSomebodyToGiveUp) {
  StudySimulationOptions o;
  o.participants = 3;
  const auto people = simulatedParticipants(o);
  int guided_first = 0;
  for (const auto& p : people) {
    guided_first += p.visits[0].method == "guided" ? 1 : 0;
    EXPECT_EQ(p.visits[0].name, p.name + "_" + p.visits[0].method);
    for (const SimulatedVisit& v : p.visits) EXPECT_FALSE(v.gives_up);
  }
  EXPECT_EQ(guided_first, 1) << "rounded down";
  EXPECT_EQ(people[2].name, "p03");
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/simulate/random_stream.h"
#include "evaluate/simulation/simulate_study.h"

namespace plumbline {
namespace {

constexpr double kGivesUpAfter = 0.4;  // of the duration

/// A person's skill in the first or the second session.
OperatorSkill skillIn(int period, double clumsiness, double learning) {
  OperatorSkill skill = handSkill(clumsiness);
  if (period == 1) return skill;
  for (double* smaller :
       {&skill.reaction_s, &skill.position_error_m, &skill.angle_error_rad, &skill.correction_s}) {
    *smaller *= learning;
  }
  skill.speed_m_s /= learning;
  // Reach grows as speeds do, up to what is possible.
  skill.turn_rad_s = std::min(skill.turn_rad_s / learning, OperatorSkill::kFastestTurn_rad_s);
  skill.reach_rad = std::min(skill.reach_rad / learning, OperatorSkill::kFarthestReach_rad);
  return skill;
}

/// Fisher and Yates with numbers of our own: those that std::shuffle draws are not fixed by the
/// standard.
std::vector<std::size_t> shuffled(int count, RandomStream& random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = order.size(); i > 1; --i) {
    const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(i));
    std::swap(order[i - 1], order[other]);
  }
  return order;
}

void limitPatience(SimulatedVisit& visit, const StudySimulationOptions& o) {
  visit.skill.patience_s =
      // Of the shorter one: a guided session has its limit for a duration, long after anybody would
      // give up.
      visit.gives_up ? kGivesUpAfter * std::min(visit.duration_s, o.duration_s) : o.limitS();
}

SimulatedVisit visitOf(const SimulatedParticipant& person, bool guided, int period,
                       const StudySimulationOptions& o, RandomStream& random) {
  SimulatedVisit visit;
  visit.method = guided ? "guided" : "free";
  visit.name = person.name + "_" + visit.method;
  visit.period = period;
  visit.skill = skillIn(period, person.clumsiness, o.learning);
  // Drawn for guided sessions as well, which do not use it, so that no order of methods shifts what
  // follows.
  const double own = random.uniform(0.85, 1.15) * (period > 1 ? o.learning : 1);
  visit.duration_s = guided ? o.limitS() : own * o.duration_s;
  limitPatience(visit, o);
  visit.seed = random.bits() >> 12U;  // a double of a document holds it
  return visit;
}

}  // namespace

double StudySimulationOptions::limitS() const { return std::max(120.0, 6 * duration_s); }

int StudySimulationOptions::trajectories() const {
  return std::max(2, static_cast<int>(std::lround(duration_s / 12)));
}

void StudySimulationOptions::check() const {
  requireWithin(1, 1000, "participants", participants);
  requireWithin(5, 600, "duration_s", duration_s);
  requireWithin(0, 20, "board_bend_mm", board_bend_mm);
  requireWithin(0.1, 1, "learning", learning);
  requireWithin(0, 100, "corner_sigma_px", corner_sigma_px);
  requireWithin(0, 100, "held_out", held_out);
  requireWithin(0, 100, "sequences", sequences);
  requireWithin(0, 1024, "threads", threads);
}

std::vector<SimulatedParticipant> simulatedParticipants(const StudySimulationOptions& o) {
  o.check();
  RandomStream random(o.seed, RandomPurpose::kTrajectory, {2});
  const std::vector<std::size_t> skills = shuffled(o.participants, random);
  const std::vector<std::size_t> orders = shuffled(o.participants, random);
  const std::vector<std::size_t> weary = shuffled(o.participants, random);
  std::vector<SimulatedParticipant> people;
  for (std::size_t i = 0; i < skills.size(); ++i) {
    SimulatedParticipant person{fmt::format("p{:02}", i + 1), 0, {}};
    // The middle of one of as many equal parts of [0, 1]: no sample is all experts by chance.
    person.clumsiness = (static_cast<double>(skills[i]) + 0.5) / o.participants;
    // Of a permutation every other number is odd: both orders are as frequent, up to one.
    const bool guided_first = orders[i] % 2 == 1;
    for (const int period : {1, 2}) {
      const bool guided = guided_first == (period == 1);
      person.visits.push_back(visitOf(person, guided, period, o, random));
    }
    people.push_back(std::move(person));
  }
  for (std::size_t k = 0; k < 2 && people.size() >= 4; ++k) {
    for (SimulatedVisit& visit : people[weary[k]].visits) {
      if (visit.method != (k == 0 ? "free" : "guided")) continue;
      visit.gives_up = true;
      limitPatience(visit, o);
    }
  }
  return people;
}

SimulatedVisit inOtherPeriod(const SimulatedParticipant& person, const SimulatedVisit& visit,
                             const StudySimulationOptions& o) {
  const bool to_second = visit.period == 1;
  SimulatedVisit other = visit;
  other.period = to_second ? 2 : 1;
  other.skill = skillIn(other.period, person.clumsiness, o.learning);
  // A guided session's is the limit, which practice does not move.
  if (visit.method == "free") other.duration_s *= to_second ? o.learning : 1 / o.learning;
  limitPatience(other, o);
  return other;
}

}  // namespace plumbline

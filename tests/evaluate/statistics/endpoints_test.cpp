// SPDX-License-Identifier: BSD-3-Clause
// Which figure of a participant is compared, and on which scale (docs/study_statistics.md).
#include <cmath>

#include <gtest/gtest.h>

#include "evaluate/statistics/study_statistics.h"

namespace plumbline {
namespace {

StudySession sessionOf(const std::string& participant, const std::string& method, int period) {
  StudySession s;
  s.participant = participant;
  s.method = method;
  s.name = participant + "_" + method + std::to_string(period);
  s.period = period;
  return s;
}

StudyRecord recordOf(std::vector<StudySession> sessions) {
  StudyRecord record;
  record.methods = {"free", "guided"};
  record.limit_s = 300;
  record.sessions = std::move(sessions);
  return record;
}

StudyRecord oneParticipant() {
  return recordOf({sessionOf("p", "free", 1), sessionOf("p", "guided", 2)});
}

PairedValues pairOf(const StudyRecord& record, const std::string& endpoint) {
  return pairsOf(record, endpointOf(record, endpoint).value(), "free", "guided").pairs.at(0);
}

// Lengths, times and pixels change by factors; entropies, shares and what has a sign by
// differences, and so does a size with a value that has no logarithm.
TEST(Endpoints, HaveTheScaleOfTheirUnit) {
  const struct {
    const char* name;
    std::optional<double> StudySession::*figure;
    double value;
    bool ratio;
  } cases[] = {{"held_out_rmse_px", &StudySession::held_out_rmse_px, 0.3, true},
               {"held_out_rmse_px", &StudySession::held_out_rmse_px, 0, false},
               {"capture_s", &StudySession::capture_s, 40, true},
               {"time_offset_std_s", &StudySession::time_offset_std_s, 1e-5, true},
               {"time_offset_s", &StudySession::time_offset_s, 1e-3, false},
               {"camera_entropy_nats", &StudySession::camera_entropy_nats, 20, false},
               {"compliance", &StudySession::compliance, 0.8, false}};
  for (const auto& c : cases) {
    StudyRecord record = oneParticipant();
    for (StudySession& s : record.sessions) s.*c.figure = 0.5;
    record.sessions[1].*c.figure = c.value;
    EXPECT_EQ(endpointOf(record, c.name).value().ratio, c.ratio) << c.name << " " << c.value;
    const double last = pairOf(record, c.name).method;
    EXPECT_DOUBLE_EQ(last, c.ratio ? std::log(c.value) : c.value) << c.name;
  }
}

// Of a parameter that both stages state it is the last one's that a user reads.
TEST(Endpoints, AnEstimateIsThatOfTheLastStage) {
  StudyRecord record = oneParticipant();
  for (StudySession& s : record.sessions) {
    s.estimates = {{"cam0.fu", 450, 1, "px", {}, {}, {}}, {"cam0.fu", 451, 1, "px", {}, {}, {}}};
  }
  EXPECT_EQ(figureOf(record, record.sessions[0], "estimates.cam0.fu"), 451);
}

TEST(Endpoints, AParticipantsOrderIsThatOfTheFirstSessionsOfTheMethods) {
  const StudyRecord record = recordOf({sessionOf("p", "free", 4), sessionOf("p", "guided", 2),
                                       sessionOf("p", "free", 1), sessionOf("p", "guided", 3)});
  EXPECT_EQ(periodOf(record, "p", "free"), 1);
  EXPECT_EQ(periodOf(record, "p", "guided"), 2);
  EXPECT_FALSE(periodOf(record, "p", "other"));
}

// Who has sessions of one method is left out, and counted; who has none of either was not asked.
TEST(Endpoints, WhoHasNoFigureUnderBothIsCounted) {
  StudyRecord record = oneParticipant();
  for (const char* name : {"q", "r"}) {
    record.sessions.push_back(sessionOf(name, "guided", 1));
  }
  record.sessions.push_back(sessionOf("s", "other", 1));
  for (StudySession& s : record.sessions) s.held_out_rmse_px = 0.3;
  const EndpointPairs found =
      pairsOf(record, endpointOf(record, "held_out_rmse_px").value(), "free", "guided");
  EXPECT_EQ(found.pairs.size(), 1U);
  EXPECT_EQ(found.left_out, 2);
}

// free: ATE of 1 and 4 m over two runs of "easy", a geometric mean of 2, and 8 m of "hard": 4 in
// all, however often "easy" was run. guided: 2 and 2.
TEST(Endpoints, TheAteOfASequenceIsTheMeanOverItsRuns) {
  StudyRecord record = oneParticipant();
  const std::string free = record.sessions[0].name, guided = record.sessions[1].name;
  record.trajectories = {{free, "easy", "0", 1.0, ""},
                         {free, "easy", "1", 4.0, ""},
                         {free, "hard", "0", 8.0, ""},
                         {guided, "easy", "0", 2.0, ""},
                         {guided, "hard", "0", 2.0, ""}};
  const PairedValues pair = pairOf(record, "ate_m");
  EXPECT_DOUBLE_EQ(pair.baseline, std::log(4));
  EXPECT_DOUBLE_EQ(pair.method, std::log(2));
  EXPECT_FALSE(pair.method_first);
}

// An error of exactly 0 has no logarithm: the run counts as one without an error.
TEST(Endpoints, AnAteOfZeroIsNone) {
  StudyRecord record = oneParticipant();
  for (const StudySession& s : record.sessions) {
    record.trajectories.push_back({s.name, "easy", "0", 0.5, ""});
    record.trajectories.push_back({s.name, "easy", "1", 0.0, ""});
  }
  EXPECT_DOUBLE_EQ(pairOf(record, "ate_m").method, std::log(0.5));
}

}  // namespace
}  // namespace plumbline

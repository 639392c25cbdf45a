// SPDX-License-Identifier: BSD-3-Clause
// decisions.jsonl: one JSON object a line, with every number that drove the decision.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "evaluate/replay/replay_session.h"

namespace plumbline {
namespace {

using nlohmann::json;
using ::testing::EndsWith;

Decision decided() {
  Decision d;
  d.t = 1'400'000'000'123'456'789;
  d.frame = 17;
  d.mode = GuideMode::kCollecting;
  d.reason = GuideReason::kInformative;
  d.accepted = true;
  d.mi_nats = std::log(2.0);
  d.entropy_nats = -2 * std::log(2.0);
  d.threshold_nats = 0.2 * std::log(2.0);
  return d;
}

TEST(DecisionLog, ScoresStandInNatsAndBits) {
  const std::string line = decisionLine(decided());
  EXPECT_THAT(line, EndsWith("\n"));
  const json read = json::parse(line);
  EXPECT_EQ(read["t_ns"], 1'400'000'000'123'456'789);
  EXPECT_EQ(read["stage"], "camera");
  EXPECT_EQ(read["mode"], "collecting");
  EXPECT_EQ(read["reason"], "informative");
  EXPECT_EQ(read["frame"], 17);
  EXPECT_EQ(read["accepted"], true);
  EXPECT_DOUBLE_EQ(read["mi_bits"].get<double>(), 1);
  EXPECT_DOUBLE_EQ(read["mi_nats"].get<double>(), std::log(2.0));
  EXPECT_DOUBLE_EQ(read["entropy_bits"].get<double>(), -2);
  EXPECT_EQ(read["threshold_bits"], 0.2);
  EXPECT_TRUE(read["suggestion"].is_null());
  EXPECT_TRUE(read["distance_px"].is_null());
}

TEST(DecisionLog, WhatLeftTheEstimateStandsWithTheFrameThatDroveItOut) {
  Decision d = decided();
  EXPECT_EQ(json::parse(decisionLine(d))["withdrawn"], json::array());
  d.withdrawn = {3, 11};
  d.event = SuggestionEvent::kWithdrawn;
  const json read = json::parse(decisionLine(d));
  EXPECT_EQ(read["withdrawn"], json({3, 11}));
  EXPECT_EQ(read["event"], "withdrawn");
  EXPECT_EQ(read["reached"], false);
}

TEST(DecisionLog, AnUnboundedGainIsSaidInWords) {
  Decision d = decided();
  d.mi_nats = std::numeric_limits<double>::infinity();
  const json read = json::parse(decisionLine(d));
  EXPECT_TRUE(read["mi_bits"].is_null());
  EXPECT_EQ(read["mi_unbounded"], true);
}

TEST(DecisionLog, SuggestionsAndRoundsComeWithTheirFrame) {
  Decision d = decided();
  d.event = SuggestionEvent::kOpened;
  d.suggestion = 3;
  d.opened = Suggestion{3, GuideStage::kCamera, d.t, "cam0 centre", 0, {}, {}, {}, 0.5, 0.25, 2.5};
  d.opened->T_FC0.t = {1, 2, 3};
  d.round = CandidateRound{d.t,
                           d.t + 40'000'000,
                           {"a", "b"},
                           {{}, {}},
                           {0.5, std::nan("")},
                           {0.25, std::nan("")},
                           {2.5, 4},
                           0};
  const json read = json::parse(decisionLine(d));
  EXPECT_EQ(read["event"], "opened");
  EXPECT_EQ(read["opened"]["T_FC0"][0], json({1.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(read["opened"]["T_FC0"][2], json({0.0, 0.0, 1.0, 3.0}));
  EXPECT_EQ(read["round"]["answered_ns"].get<TimeNs>() - read["round"]["asked_ns"].get<TimeNs>(),
            40'000'000);
  EXPECT_TRUE(read["round"]["mi_bits"][1].is_null());
  EXPECT_EQ(read["round"]["error_px"][0], 0.25);
  EXPECT_TRUE(read["round"]["error_px"][1].is_null());
  EXPECT_EQ(read["opened"]["error_px"], 0.25);
  EXPECT_TRUE(read["error_px"].is_null());
  EXPECT_EQ(read["opened"]["reach_s"], 2.5);
  EXPECT_EQ(read["round"]["reach_s"], json({2.5, 4.0}));
  d.round->reach_s.clear();
  EXPECT_FALSE(json::parse(decisionLine(d))["round"].contains("reach_s")) << "does not count";
}

TEST(ReplaySummary, TimesCountFromWhereTheGuidesTimeBegan) {
  ReplayRecord record;
  record.frames = {{0, {}, {}}, {toNanoseconds(1000), {}, {}}};
  record.stages.resize(2);
  record.stages[0].finished = record.stages[1].ended = toNanoseconds(1012);
  record.begin = toNanoseconds(1000);
  EXPECT_THAT(replaySummary(record), ::testing::HasSubstr("finished at 12.0 s"));
  EXPECT_THAT(replaySummary(record), ::testing::HasSubstr("ended at 12.0 s"));
}

// No time to reach any is stated where none was.
TEST(ReplaySummary, OfSuggestionsThatWereNotReachedHasNoTime) {
  ReplayRecord record;
  record.compliance.emplace();
  EXPECT_THAT(replaySummary(record), ::testing::HasSubstr("operator: no suggestion was shown\n"));
  record.compliance->suggestions.resize(6);
  for (std::size_t i = 0; i < 5; ++i) {
    record.compliance->suggestions[i].end = SuggestionEvent::kExpired;
  }
  EXPECT_THAT(replaySummary(record),
              ::testing::HasSubstr("reached 0 of 5 suggestions; 1 open at the end\n"));
  record.compliance->reached = 2;
  record.compliance->median_seconds_to_reach = 3;
  EXPECT_THAT(replaySummary(record),
              ::testing::HasSubstr("reached 2 of 5 suggestions, median 3.0 s; 1 open at"));
}

// Of several seeds some may get there, and an order may end before the pool does.
TEST(ReplaySummary, OfAnErrorThatIsNotReachedSaysByWhomAndWithinHowManyViews) {
  ReplayRecord record;
  record.counterfactuals.emplace();
  CounterfactualBand random;
  random.strategy = "random";
  random.seeds = 5;
  random.views = {5, 200};
  CounterfactualBand online;
  online.strategy = "predicted-error";
  online.seeds = 1;
  online.views = {5, 40};
  record.counterfactuals->bands = {random, online};
  EXPECT_THAT(replaySummary(record),
              ::testing::HasSubstr(" random not by every seed within 200 views; predicted-error "
                                   "not within 40 views;"));
}

}  // namespace
}  // namespace plumbline

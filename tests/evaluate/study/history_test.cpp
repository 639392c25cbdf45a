// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/history.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/study/night.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

/// A history in the making: figures by night, spans as the store keeps them.
class History {
 public:
  void add(const std::string& session, const std::string& name, double value,
           const std::string& version, const std::string& inputs = "k") {
    const StudyFigure figure{session, name, "px", inputs, version, value, "plumbline " + name};
    if (!spans_.empty() && spans_.back().figure == figure &&
        spans_.back().last_night == night_ - 1) {
      spans_.back().last_night = night_;
    } else {
      spans_.push_back({figure, night_, night_});
    }
  }
  void nextNight() { ++night_; }
  int night() const { return night_; }

  std::vector<StudyAlarm> judge(const std::vector<StudyAcceptance>& accepted = {}) {
    std::stable_sort(spans_.begin(), spans_.end(), [](const FigureSpan& a, const FigureSpan& b) {
      return std::tie(a.figure.session, a.figure.name) < std::tie(b.figure.session, b.figure.name);
    });
    return judgeNight(night_, spans_, accepted, {});
  }

 private:
  int night_ = 1;
  std::vector<FigureSpan> spans_;
};

bool isOfStudy(const StudyAlarm& a) { return a.kind == "cusum"; }

TEST(HistoryTest, EqualNightsRaiseNoAlarm) {
  History history;
  for (int night = 0; night < 20; ++night) {
    if (night > 0) history.nextNight();
    history.add("a", "camera_rmse_px", 0.28, "1");
  }
  EXPECT_TRUE(history.judge().empty());
}

TEST(HistoryTest, SameInputsAndVersionMustBeEqual) {
  History history;
  history.add("a", "estimates/cam0.fu", 458.1, "1");
  history.nextNight();
  history.add("a", "estimates/cam0.fu", std::nextafter(458.1, 459), "1");
  const auto alarms = history.judge();
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_EQ(alarms[0].kind, "deterministic");
  EXPECT_EQ(alarms[0].night, 2);
  EXPECT_EQ(alarms[0].session, "a");
  EXPECT_EQ(alarms[0].command, "plumbline estimates/cam0.fu");
  EXPECT_TRUE(history.judge({{2, "a", "estimates", "", ""}}).empty());
}

TEST(HistoryTest, DurationsAreNotExpectedToBeEqual) {
  History history;
  history.add("a", "calibration_s", 1.0, "1");
  history.nextNight();
  history.add("a", "calibration_s", 1.7, "1");
  EXPECT_TRUE(history.judge().empty());
}

TEST(HistoryTest, AnotherVersionMayDifferALittle) {
  History history;
  history.add("a", "held_out_rmse_px/e", 0.300, "1");
  history.nextNight();
  history.add("a", "held_out_rmse_px/e", 0.3003, "2");
  EXPECT_TRUE(history.judge().empty());
}

TEST(HistoryTest, NamesTheFirstBadNightOfAStepUntilItIsMended) {
  History history;
  const double values[] = {0.30, 0.3001, 0.2999, 0.36, 0.36, 0.361};
  for (int i = 0; i < 6; ++i) {
    if (i > 0) history.nextNight();
    history.add("a", "held_out_rmse_px/e", values[i], std::to_string(i));
  }
  const auto alarms = history.judge();
  const auto of_session = std::find_if(alarms.begin(), alarms.end(),
                                       [](const StudyAlarm& a) { return a.session == "a"; });
  ASSERT_NE(of_session, alarms.end());
  EXPECT_EQ(of_session->kind, "median");
  EXPECT_EQ(of_session->night, 4);
  EXPECT_NEAR(of_session->was, 0.30, 1e-3);
  EXPECT_EQ(of_session->is, 0.361);
  history.nextNight();
  history.add("a", "held_out_rmse_px/e", 0.30, "mended");
  for (const StudyAlarm& a : history.judge()) EXPECT_NE(a.kind, "median");
}

/// Alarms of the last of these nights, each of another version.
std::vector<StudyAlarm> judgedLast(const std::string& name, const std::vector<double>& values,
                                   const std::vector<StudyAcceptance>& accepted = {}) {
  History history;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) history.nextNight();
    history.add("a", name, values[i], std::to_string(i));
  }
  std::vector<StudyAlarm> alarms = history.judge(accepted);
  std::erase_if(alarms, [](const StudyAlarm& alarm) { return alarm.kind != "median"; });
  return alarms;
}

// Bad nights are not what later ones are compared with, however many they are.
TEST(HistoryTest, AStepDoesNotBecomeTheNormal) {
  std::vector<double> values{0.30, 0.30, 0.30};
  values.insert(values.end(), 12, 0.36);
  const auto alarms = judgedLast("ate_m/s", values);
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0].night, 4);
  EXPECT_EQ(alarms[0].was, 0.30);
}

// What became better is to stay so: fourteen nights later those before it are forgotten.
TEST(HistoryTest, TheMedianIsOfTheLastNightsAlone) {
  std::vector<double> values(20, 0.30);
  values.insert(values.end(), 14, 0.20);
  EXPECT_TRUE(judgedLast("ate_m/s", values).empty());
  values.push_back(0.25);
  EXPECT_EQ(judgedLast("ate_m/s", values).size(), 1U);
}

// Four deviations, each half a per cent of the figure's size at least, whatever its sign, and of
// entropies near 0 a hundredth of a nat.
TEST(HistoryTest, ADeviationIsAShareOfTheSizeOrTheLeastOfItsKind) {
  const struct {
    const char* name;
    double before, now;
    bool alarm;
  } cases[] = {{"ate_m/s", 0.300, 0.305, false},
               {"ate_m/s", 0.300, 0.307, true},
               {"camera_entropy_nats", -200, -196.5, false},
               {"camera_entropy_nats", -200, -195.5, true},
               {"camera_entropy_nats", 0, 0.039, false},
               {"camera_entropy_nats", 0, 0.041, true}};
  for (const auto& c : cases) {
    const std::vector<double> values{c.before, c.before, c.before, c.now};
    EXPECT_EQ(!judgedLast(c.name, values).empty(), c.alarm) << c.name << " " << c.now;
  }
}

// Nights that scatter by 0.01 either side of 0.30: a median absolute deviation of 0.01, of which a
// normal distribution's sigma is 1.4826 times as much.
TEST(HistoryTest, ScatterIsMeasuredAsASigma) {
  std::vector<double> values{0.31, 0.29, 0.31, 0.29, 0.31, 0.29, 0.30};
  values.push_back(0.30 + 0.0585);
  EXPECT_TRUE(judgedLast("ate_m/s", values).empty());
  values.back() = 0.30 + 0.0601;
  EXPECT_EQ(judgedLast("ate_m/s", values).size(), 1U);
}

// The night that was accepted is the first one of the new normal, of that session alone.
TEST(HistoryTest, AnAcceptanceIsOfItsSessionAndFromItsNightOn) {
  EXPECT_TRUE(judgedLast("ate_m/s", {0.1, 0.3}, {{2, "a", "", "", ""}}).empty());
  EXPECT_TRUE(judgedLast("ate_m/s", {0.1, 0.3}, {{2, "a", "ate_m/s", "", ""}}).empty());
  EXPECT_EQ(judgedLast("ate_m/s", {0.1, 0.3}, {{2, "b", "", "", ""}}).size(), 1U);
  EXPECT_EQ(judgedLast("ate_m/s", {0.1, 0.3}, {{2, "a", "ate_m/other", "", ""}}).size(), 1U);
  const auto worse = judgedLast("ate_m/s", {0.1, 0.3, 0.4}, {{2, "a", "", "", ""}});
  ASSERT_EQ(worse.size(), 1U);
  EXPECT_EQ(worse[0].night, 3);
  EXPECT_EQ(worse[0].was, 0.3);
}

// One session of five is worse for good, by as much as one likes: it has its alarm, and the study
// none. A figure that the last night has not is not judged.
TEST(HistoryTest, TheStudysAlarmIsOfMostOfItsSessions) {
  History history;
  for (int night = 1; night <= 12; ++night) {
    if (night > 1) history.nextNight();
    for (int s = 0; s < 5; ++s) {
      history.add("s" + std::to_string(s), "ate_m/x", s == 0 && night > 4 ? 0.5 : 0.1,
                  night > 4 ? "2" : "1");
    }
  }
  const auto alarms = history.judge();
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0].session, "s0");
  EXPECT_EQ(alarms[0].kind, "median");
  history.nextNight();
  EXPECT_TRUE(history.judge().empty());
}

TEST(HistoryTest, BetterIsNoRegression) {
  History history;
  history.add("a", "ate_m/s", 0.30, "1");
  history.nextNight();
  history.add("a", "ate_m/s", 0.10, "2");
  EXPECT_TRUE(history.judge().empty());
}

TEST(HistoryTest, NewDataStartAnew) {
  History history;
  history.add("a", "ate_m/s", 0.10, "1", "old data");
  history.nextNight();
  history.add("a", "ate_m/s", 0.30, "1", "new data");
  EXPECT_TRUE(history.judge().empty());
}

// A recording that was damaged is another one: no regression, but its session is named.
TEST(HistoryTest, ASessionThatFailsWithNewDataIsNamed) {
  std::vector<FigureSpan> spans;
  const auto add = [&](const std::string& session, int night, const std::string& inputs,
                       double value) {
    spans.push_back({{session, "failed", "1", inputs, "1", value, ""}, night, night});
  };
  add("damaged", 1, "old", 0);
  add("damaged", 2, "new", 1);
  add("never", 1, "old", 1);
  add("never", 2, "new", 1);
  add("mended", 1, "old", 1);
  add("mended", 2, "new", 0);
  add("gone", 1, "new", 1);
  add("gone", 0, "old", 0);
  add("regression", 1, "old", 0);
  add("regression", 2, "old", 1);
  EXPECT_THAT(calibratedFromOtherInputs(2, spans), testing::ElementsAre("damaged"));
  NightOutcome outcome;
  outcome.calibrated_before = {"damaged"};
  EXPECT_THAT(nightSummary(outcome, ""), testing::HasSubstr("other data or options: damaged\n"));
}

TEST(HistoryTest, ASessionThatFailsIsARegression) {
  History history;
  history.add("a", "failed", 0, "1");
  history.nextNight();
  history.add("a", "failed", 1, "2");
  const auto alarms = history.judge();
  ASSERT_FALSE(alarms.empty());
  EXPECT_EQ(alarms[0].metric, "failed");
}

// However often it failed before it was done.
TEST(HistoryTest, WhatWasDoneOnceIsNotToFail) {
  History history;
  const double values[] = {1, 1, 0, 1};
  for (int i = 0; i < 4; ++i) {
    if (i > 0) history.nextNight();
    history.add("a", "failed/perturb", values[i], std::to_string(i));
    EXPECT_EQ(history.judge().empty(), i < 3) << "night " << i + 1;
  }
  EXPECT_EQ(history.judge()[0].night, 4);
}

// By --redo-failed, after a lack of memory or a missing program: inputs and version stay.
TEST(HistoryTest, AStepThatIsMendedIsNoRegression) {
  for (const char* name : {"failed", "failed/estimate_s"}) {
    History history;
    history.add("a", name, 1, "1");
    history.nextNight();
    history.add("a", name, 0, "1");
    EXPECT_TRUE(history.judge().empty()) << name;
    history.nextNight();
    history.add("a", name, 1, "1");
    const auto alarms = history.judge();
    ASSERT_EQ(alarms.size(), 1u) << name;
    EXPECT_EQ(alarms[0].kind, "deterministic");
    EXPECT_EQ(alarms[0].night, 3);
    EXPECT_EQ(alarms[0].was, 0);
  }
}

TEST(HistoryTest, WhatWasAcceptedIsTheNewNormal) {
  History history;
  history.add("a", "ate_m/s", 0.10, "1");
  history.nextNight();
  history.add("a", "ate_m/s", 0.30, "2");
  EXPECT_FALSE(history.judge().empty());
  const std::vector<StudyAcceptance> accepted{{2, "", "ate_m", "a new estimator", ""}};
  EXPECT_TRUE(history.judge(accepted).empty());
  history.nextNight();
  history.add("a", "ate_m/s", 0.30, "3");
  EXPECT_TRUE(history.judge(accepted).empty());
  history.nextNight();
  history.add("a", "ate_m/s", 0.40, "4");
  const auto alarms = history.judge(accepted);
  ASSERT_FALSE(alarms.empty());
  EXPECT_EQ(alarms[0].night, 4);
}

// A drift of 0.1 % a night is below every night's deviation; cumulated over sessions it shows. A
// session that joins late is compared with its own first night only.
TEST(HistoryTest, AcceptingASessionLeavesTheAlarmsOfTheStudy) {
  const TemporaryFolder folder;
  folder.write(kStudyMarkFile, "{}");
  StudyStore store(folder.path(kHistoryFile));
  store.addNight({1, "", "1", 2, 0, 0, {}, {}}, {});
  store.addAlarms(1,
                  {{"ate_m", "", 1, "cusum", 0, 0.1, ""}, {"ate_m", "b", 1, "median", 1, 2, ""}});
  store.save();
  EXPECT_THROW(acceptChanges(folder.path(), "a", "", ""), InputError);
  EXPECT_EQ(acceptChanges(folder.path(), "b", "", "").size(), 1u);
  EXPECT_EQ(acceptChanges(folder.path(), "", "", "").size(), 2u);
}

TEST(HistoryTest, ADriftIsAShareOnlyOfWhatHasOne) {
  NightOutcome outcome;
  outcome.alarms = {{"ate_m", "", 1, "cusum", 0, 0.1, ""}};
  EXPECT_THAT(nightSummary(outcome, ""), testing::HasSubstr("worse by 10 % than"));
  for (const char* name : {"failed", "camera_entropy_nats"}) {
    outcome.alarms[0].metric = name;
    EXPECT_THAT(nightSummary(outcome, ""), testing::HasSubstr("worse than")) << name;
  }
}

TEST(HistoryTest, CusumFindsADriftThatNoNightShows) {
  History history;
  std::vector<StudyAlarm> alarms;
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 1e-4);
  for (int night = 1; night <= 30; ++night) {
    if (night > 1) history.nextNight();
    const double drift = night <= 10 ? 0 : 1e-3 * (night - 10);
    for (int s = 0; s < 9; ++s) {
      if (s == 8 && night < 20) continue;
      history.add("s" + std::to_string(s), "held_out_rmse_px/e",
                  (0.25 + 0.01 * s) * (1 + drift + noise(random)), std::to_string(night));
    }
    alarms = history.judge();
    if (night <= 12) {
      EXPECT_TRUE(alarms.empty()) << "night " << night;
    }
  }
  const auto cusum = std::find_if(alarms.begin(), alarms.end(), isOfStudy);
  ASSERT_NE(cusum, alarms.end());
  EXPECT_EQ(cusum->session, "");
  EXPECT_EQ(cusum->metric, "held_out_rmse_px");
  EXPECT_EQ(cusum->command, "plumbline held_out_rmse_px/e");
  EXPECT_GE(cusum->night, 11);
  EXPECT_LE(cusum->night, 15);
}

TEST(HistoryTest, ANightThatWasMendedRaisesNoAlarmAfterwards) {
  History history;
  for (int night = 1; night <= 6; ++night) {
    if (night > 1) history.nextNight();
    for (int s = 0; s < 3; ++s) {
      history.add("s" + std::to_string(s), "ate_m/x", night == 4 ? 0.15 : 0.1,
                  std::to_string(night));
    }
    EXPECT_EQ(history.judge().empty(), night != 4) << "night " << night;
  }
}

TEST(HistoryTest, AJumpInOneNightIsNoDriftAsWell) {
  History history;
  for (int night = 1; night <= 12; ++night) {
    if (night > 1) history.nextNight();
    for (int s = 0; s < 4; ++s) {
      history.add("s" + std::to_string(s), "held_out_rmse_px/e", night <= 3 ? 0.27 : 0.281,
                  std::to_string(night));
      history.add("s" + std::to_string(s), "failed", night <= 3 ? 0 : 1, std::to_string(night));
    }
    const auto alarms = history.judge();
    EXPECT_EQ(alarms.size(), night <= 3 ? 0u : 8u) << "night " << night;
    EXPECT_EQ(std::count_if(alarms.begin(), alarms.end(), isOfStudy), 0) << "night " << night;
  }
}

// So far that the nights' own medians call it worse besides.
TEST(HistoryTest, ADriftStaysOneWhereItHasBecomeLarge) {
  History history;
  for (int night = 1; night <= 20; ++night) {
    if (night > 1) history.nextNight();
    for (int s = 0; s < 4; ++s) {
      history.add("s" + std::to_string(s), "ate_m/x", 0.1 * (1 + 0.005 * (night - 1)),
                  std::to_string(night));
    }
    const auto alarms = history.judge();
    const auto drift = std::find_if(alarms.begin(), alarms.end(), isOfStudy);
    EXPECT_EQ(drift != alarms.end(), night > 4) << "night " << night;
    if (drift != alarms.end()) EXPECT_NEAR(drift->is, 0.005 * (night - 1), 1e-9);
  }
}

// Even nights before it: their median lags behind the drift, which then counts as a jump every
// night.
TEST(HistoryTest, ADriftAfterEvenNightsStaysOneWhereItHasBecomeLarge) {
  for (const double each : {0.003, 0.005, 0.01}) {
    History history;
    bool alarmed = false;
    for (int night = 1; night <= 30; ++night) {
      if (night > 1) history.nextNight();
      for (int s = 0; s < 4; ++s) {
        history.add("s" + std::to_string(s), "ate_m/x", 0.1 * (1 + each * std::max(0, night - 10)),
                    std::to_string(night));
      }
      const auto alarms = history.judge();
      const bool drift = std::any_of(alarms.begin(), alarms.end(), isOfStudy);
      EXPECT_TRUE(drift || !alarmed) << each << ", night " << night;
      alarmed = drift;
    }
    EXPECT_TRUE(alarmed) << each;
  }
}

// Where nights after the shift are as many as those before, their spread is that of the shift.
TEST(HistoryTest, AShiftThatStaysKeepsItsAlarm) {
  History history;
  for (int night = 1; night <= 20; ++night) {
    if (night > 1) history.nextNight();
    for (int s = 0; s < 3; ++s) {
      history.add("s" + std::to_string(s), "held_out_rmse_px/e", night <= 4 ? 0.2 : 0.2028,
                  night <= 4 ? "1" : "2");
    }
    EXPECT_EQ(history.judge().empty(), night < 7) << "night " << night;
  }
}

// Nights that differ by noise of half the floor: how often is one called worse?
TEST(HistoryTest, NoiseRaisesFewAlarms) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, 0.0025);
  int false_alarms = 0;
  for (int trial = 0; trial < 20; ++trial) {
    History history;
    for (int night = 1; night <= 25; ++night) {
      if (night > 1) history.nextNight();
      for (int s = 0; s < 6; ++s) {
        history.add("s" + std::to_string(s), "ate_m/x", 0.1 * (1 + noise(random)),
                    std::to_string(night));
      }
    }
    false_alarms += static_cast<int>(history.judge().size());
  }
  EXPECT_LE(false_alarms, 1);  // of 120 figures at 8 deviations
}

}  // namespace
}  // namespace plumbline

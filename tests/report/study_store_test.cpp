// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/study_store.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

class StudyStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("plumbline_study_store_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file() const { return folder_ / "study.sqlite"; }

  static StudyNight night(int number) {
    StudyNight n;
    n.night = number;
    n.date = "2026-01-01T00:00:00Z";
    n.version = "0.1.0";
    n.seconds = 1.5;
    return n;
  }
  static StudyFigure figure(double value, const std::string& version = "1") {
    return {"a", "ate_m/s", "m", "k", version, value, "plumbline evaluate"};
  }

  std::filesystem::path folder_;
};

TEST_F(StudyStoreTest, KeepsNightsAndProlongsFiguresThatStay) {
  {
    StudyStore store(file());
    store.addNight(night(1), {figure(0.1)});
    store.addNight(night(2), {figure(0.1)});
    store.addNight(night(3), {figure(0.2)});
    store.addNight(night(4), {figure(0.2, "2")});
    store.save();
  }
  const StudyStore store(file());
  EXPECT_EQ(store.nights().size(), 4u);
  EXPECT_EQ(store.nights()[2].seconds, 1.5);
  EXPECT_FALSE(store.nights()[2].held_out_rmse_px.has_value());
  const auto spans = store.figures();
  ASSERT_EQ(spans.size(), 3u);
  EXPECT_EQ(spans[0].first_night, 1);
  EXPECT_EQ(spans[0].last_night, 2);
  EXPECT_EQ(spans[0].figure.value, 0.1);
  EXPECT_EQ(spans[1].last_night, 3);
  EXPECT_EQ(spans[2].figure.version, "2");
}

TEST_F(StudyStoreTest, AFigureThatStaysHasTheCommandOfItsLastNight) {
  StudyStore store(file());
  StudyFigure moved = figure(0.1);
  moved.command = "plumbline evaluate elsewhere";
  store.addNight(night(1), {figure(0.1)});
  store.addNight(night(2), {moved});
  ASSERT_EQ(store.figures().size(), 1u);
  EXPECT_EQ(store.figures()[0].figure.command, moved.command);
}

TEST_F(StudyStoreTest, AFigureThatPausesBeginsAnew) {
  StudyStore store(file());
  store.addNight(night(1), {figure(0.1)});
  store.addNight(night(2), {});
  store.addNight(night(3), {figure(0.1)});
  EXPECT_EQ(store.figures().size(), 2u);
}

TEST_F(StudyStoreTest, KeepsNumbersToTheLastBitAndUnknownOnes) {
  StudyStore store(file());
  const double value = std::nextafter(1.0 / 3, 1);
  store.addNight(night(1), {figure(value), {"b", "ate_m/s", "m", "k", "1", std::nan(""), ""}});
  store.save();
  const StudyStore read(file());
  EXPECT_EQ(read.figures()[0].figure.value, value);
  EXPECT_TRUE(std::isnan(read.figures()[1].figure.value));
}

TEST_F(StudyStoreTest, KeepsAlarmsStepsAndAcceptances) {
  StudyStore store(file());
  store.addNight(night(1), {});
  store.addAlarms(1, {{"ate_m/s", "a", 1, "median", 0.1, 0.2, "plumbline x"}});
  store.setSteps(1, {{"sessions/a/calibrate", "key", "done", "", "plumbline", 1, 2}});
  store.setSteps(1, {{"sessions/b/calibrate", "key", "failed", "why", "plumbline", 1, 2}});
  store.accept({1, "a", "ate_m", "note", "date"});
  EXPECT_EQ(store.nights()[0].alarms, 1);
  EXPECT_EQ(store.alarms(1).at(0).is, 0.2);
  EXPECT_TRUE(store.alarms(2).empty());
  ASSERT_EQ(store.steps().size(), 1u);
  EXPECT_EQ(store.steps()[0].message, "why");
  EXPECT_EQ(store.accepted().at(0).note, "note");
}

TEST_F(StudyStoreTest, NothingIsWrittenBeforeItIsSaved) {
  StudyStore store(file());
  store.addNight(night(1), {});
  EXPECT_FALSE(std::filesystem::exists(file()));
}

TEST_F(StudyStoreTest, RefusesAnEmptyFileAsDamaged) {
  std::ofstream(file()).close();
  EXPECT_THROW(StudyStore{file()}, InputError);
}

TEST_F(StudyStoreTest, RefusesADamagedFileAndNamesIt) {
  std::ofstream(file()) << "nothing of ours, but more than a hundred bytes long, so that it could "
                           "have a header such as SQLite's files have one at their beginning";
  try {
    const StudyStore store(file());
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("study.sqlite"));
  }
}

// Pages behind the first one hold the figures, which only a later question reads.
TEST_F(StudyStoreTest, RefusesDamageInALaterPage) {
  {
    StudyStore store(file());
    std::vector<StudyFigure> figures;
    for (int i = 0; i < 400; ++i) figures.push_back(figure(i, std::to_string(i)));
    store.addNight(night(1), figures);
    store.save();
  }
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(file()));
  {
    std::fstream bytes(file(), std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(size / 2);
    bytes << std::string(static_cast<std::size_t>(size / 4), '\xff');
  }
  try {
    (void)StudyStore(file()).figures();
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("study.sqlite"));
    EXPECT_THAT(error.what(), testing::HasSubstr("damaged"));
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// The history of the nights, and whose it is.
#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudyNightHistory : public StudyNights {};

TEST_F(StudyNightHistory, AnotherValueFromTheSameInputsIsARegressionUntilAccepted) {
  const fs::path night = doneNight();
  const fs::path step = night / "sessions/p1_free/evaluate_eval/step.json";
  auto json = nlohmann::ordered_json::parse(read(step));
  auto& rmse = json.at("part").at("held_out")[0].at("rmse_px");
  rmse = rmse.get<double>() * 1.001;
  write(step, json.dump());
  const Outcome bad = study(root_ / "data", night);
  EXPECT_EQ(bad.exit_code, 3) << bad.text;
  EXPECT_THAT(bad.text, HasSubstr("held_out_rmse_px/eval of p1_free"));
  EXPECT_THAT(bad.text, HasSubstr("since night 2"));
  // The folder is a copy: the command is of the copy's calibration.
  EXPECT_THAT(bad.text,
              HasSubstr("plumbline evaluate calibration " +
                        (night / "sessions/p1_free/calibrate/calibration.json").string()));
  EXPECT_EQ(study(root_ / "data", night).exit_code, 3) << "until somebody looks at it";
  EXPECT_EQ(plumbline("study accept " + night.string() + " --session p2_free").exit_code, 2);
  const Outcome accepted =
      plumbline("study accept " + night.string() + " --figure held_out_rmse_px --note 'a test'");
  EXPECT_EQ(accepted.exit_code, 0) << accepted.text;
  EXPECT_EQ(study(root_ / "data", night).exit_code, 0);
  // Done again it is what it was at first: the same inputs, another value than was accepted.
  const auto before = times(night);
  EXPECT_EQ(study(root_ / "data", night, "--recheck 12").exit_code, 3);
  EXPECT_EQ(doneAgain(before, night).size(), 12u);
}

TEST_F(StudyNightHistory, ANewerOrForeignStoreIsLeftAlone) {
  const fs::path night = doneNight();
  {
    SQLite::Database db((night / "study.sqlite").string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA user_version = 99");
  }
  const std::string newer = read(night / "study.sqlite");
  const Outcome outcome = study(root_ / "data", night);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("has store version 99, this program knows 1"));
  EXPECT_EQ(read(night / "study.sqlite"), newer);
  write(night / "study.sqlite", "not a database, but long enough to look like some other file");
  EXPECT_THAT(study(root_ / "data", night).text, HasSubstr("damaged"));
}

TEST_F(StudyNightHistory, FoldersOfOthersAreLeftAlone) {
  write(scratch_ / "letters.txt", "mine");
  const Outcome foreign = study(root_ / "data", scratch_);
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.text, HasSubstr("letters.txt"));
  const Outcome inside = study(root_ / "data", root_ / "data/eval/night");
  EXPECT_EQ(inside.exit_code, 2);
  EXPECT_FALSE(fs::exists(root_ / "data/eval/night"));
  fs::create_directories(scratch_ / "other");
  write(scratch_ / "other/STUDY.yaml", replaced(read(root_ / "data/STUDY.yaml"), "small", "other"));
  for (const auto& entry : fs::directory_iterator(root_ / "data")) {
    if (entry.is_directory()) {
      fs::create_directory_symlink(entry.path(), scratch_ / "other" / entry.path().filename());
    }
  }
  const Outcome other = study(scratch_ / "other", root_ / "undisturbed");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.text, HasSubstr("belongs to the study 'small'"));
}

}  // namespace
}  // namespace plumbline

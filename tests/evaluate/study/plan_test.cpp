// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/plan.h"

#include <chrono>
#include <map>
#include <thread>

#include <gmock/gmock.h>

#include "calibrator/base/error.h"
#include "evaluate/study/engine/engines.h"
#include "tests/evaluate/study/study_files.h"

namespace plumbline {
namespace {

const StudyOptionChecks kAnyOption{[](const StudyCommandOptions&) {},
                                   [](const StudyCommandOptions&) {}};

class PlanTest : public StudyFiles {
 protected:
  std::map<std::string, Step> plan(const std::string& further = "",
                                   const std::string& version = "1") const {
    const StudyDefinition definition =
        readStudy(study("perturbations: {offsets_ms: [10]}\n" + further), kAnyOption);
    InputHashes hashes(root_ / "hashes.txt");
    std::map<std::string, Step> steps;
    for (const Step& step : planStudy(definition, hashes, {version, "program"}))
      steps[step.name] = step;
    return steps;
  }

  // Names of the steps whose keys differ.
  static std::vector<std::string> changed(const std::map<std::string, Step>& a,
                                          const std::map<std::string, Step>& b) {
    std::vector<std::string> names;
    for (const auto& [name, step] : b) {
      if (a.count(name) == 0 || a.at(name).key != step.key) names.push_back(name);
    }
    return names;
  }
};

using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(PlanTest, HasTheStepsOfEverySession) {
  const auto steps = plan();
  EXPECT_EQ(steps.size(), 12u);  // calibrate, perturb and evaluate each
  const Step& evaluate = steps.at("sessions/a/evaluate_eval");
  EXPECT_EQ(evaluate.needs.at(0).name, "sessions/a/calibrate");
  EXPECT_EQ(evaluate.needs.at(0).key, steps.at("sessions/a/calibrate").key);
}

const std::string kCommand =
    "sequences: [{name: s, path: eval, truth: target.yaml}]\n"
    "trajectories: {command: 'vio {calibration} \"{sequence}\" $HOME/${out} {out}'}\n";

TEST_F(PlanTest, KeysAreOfContentsAndNotOfPlaces) {
  const auto before = plan(kCommand);
  EXPECT_THAT(changed(before, plan(kCommand)), IsEmpty());
  const auto moved = root_.string() + "_moved";
  std::filesystem::remove_all(moved);
  std::filesystem::copy(root_, moved, std::filesystem::copy_options::recursive);
  const StudyDefinition there = readStudy(moved + "/STUDY.yaml", kAnyOption);
  InputHashes hashes(moved + "/hashes_there.txt");
  for (const Step& step : planStudy(there, hashes, {"1", "program"})) {
    EXPECT_EQ(step.key, before.at(step.name).key) << step.name;
  }
  std::filesystem::remove_all(moved);
}

TEST_F(PlanTest, ACommandHasItsPlacesQuotedAndKeepsWhatIsTheShells) {
  EXPECT_EQ(plan(kCommand).at("sessions/a/estimate_s").words.back(),
            "vio '{result:sessions/a/calibrate}/calibration.json' \"" +
                std::filesystem::weakly_canonical(root_ / "eval").string() +
                "\" $HOME/${out} '{out}/trajectory.txt'");
}

TEST_F(PlanTest, EscapedQuotesOfACommandEndNoQuotes) {
  const std::string command =
      "sequences: [{name: s, path: eval, truth: target.yaml}]\n"
      "trajectories: {command: 'bash -c \"vio \\\"{calibration}\\\" {out}\"'}\n";
  EXPECT_EQ(plan(command).at("sessions/a/estimate_s").words.back(),
            "bash -c \"vio \\\"{result:sessions/a/calibrate}/calibration.json\\\" "
            "{out}/trajectory.txt\"");
}

TEST_F(PlanTest, AChangedRecordingChangesItsSessionAlone) {
  const auto before = plan();
  write("p1_guided/mav0/cam0/corners.csv", "p1_guideD");  // of the same length
  EXPECT_THAT(
      changed(before, plan()),
      ElementsAre("sessions/b/calibrate", "sessions/b/evaluate_eval", "sessions/b/perturb"));
}

TEST_F(PlanTest, AChangedHeldOutRecordingChangesEvaluationsAlone) {
  const auto before = plan();
  write("eval/mav0/cam0/corners.csv", "other");
  EXPECT_THAT(changed(before, plan()),
              ElementsAre("sessions/a/evaluate_eval", "sessions/b/evaluate_eval",
                          "sessions/c/evaluate_eval", "sessions/d/evaluate_eval"));
}

TEST_F(PlanTest, OptionsChangeWhatTheyGoInto) {
  const auto before = plan();
  EXPECT_EQ(changed(before, plan("calibrate: {loss: none}\n")).size(), 12u);
  EXPECT_EQ(changed(before, plan("", "2")).size(), 12u);
  EXPECT_THAT(changed(before, plan("thresholds: {regression_sigma: 7}\nlimit_s: 10\n")), IsEmpty());
}

TEST_F(PlanTest, EveryStepGetsTheOptionsThatItTakes) {
  write("imu.yaml", "");
  write("kalibr.json", "");
  const std::string session =
      "  - {name: a, participant: p1, method: free, period: 1, path: p1_free, other: [{tool: k, "
      "path: kalibr.json}]}\n";
  const StudyDefinition definition = readStudy(
      study("replay: true\ncalibrate: {imu: imu.yaml, models: pinhole-radtan, resolution: 9x9, "
            "sync-tolerance-ms: 1, loss: none, pixel-sigma: 2, min-corners: 5, gravity: 9.8}\n",
            session),
      kAnyOption);
  InputHashes hashes(root_ / "hashes.txt");
  int checked = 0;
  for (const Step& step : planStudy(definition, hashes, {"1", "program"})) {
    const bool replay = step.name == "sessions/a/replay";
    if (!replay && step.name != "sessions/a/compare_k") continue;
    ++checked;
    for (const char* option : {"--imu", "--resolution", "--sync-tolerance-ms", "--loss",
                               "--pixel-sigma", "--min-corners", "--gravity"}) {
      EXPECT_THAT(step.words, testing::Contains(option)) << step.name;
    }
    if (replay) {
      EXPECT_THAT(step.words, testing::Contains("--models"));
    }
  }
  EXPECT_EQ(checked, 2);
}

// plumbline calibrate refuses both together; other steps have no use for the cameras.
TEST_F(PlanTest, GivenCamerasNeedNoModels) {
  write("cameras.yaml", "");
  const auto own = plan("calibrate: {models: pinhole-radtan}\n");
  EXPECT_THAT(own.at("sessions/a/calibrate").words, testing::Contains("--models"));
  const auto given = plan("calibrate: {models: pinhole-radtan, cameras: cameras.yaml}\n");
  EXPECT_THAT(given.at("sessions/a/calibrate").words, testing::Contains("--cameras"));
  EXPECT_THAT(given.at("sessions/a/calibrate").words, testing::Not(testing::Contains("--models")));
}

TEST_F(PlanTest, InputKeysOutliveVersions) {
  const auto one = plan("", "1"), two = plan("", "2");
  for (const auto& [name, step] : one) EXPECT_EQ(step.inputs_key, two.at(name).inputs_key) << name;
}

TEST_F(PlanTest, RecordingsOfImagesAreDetectedFirst) {
  std::filesystem::remove(root_ / "p1_free/mav0/cam0/corners.csv");
  write("p1_free/mav0/cam0/data.csv", "");
  const auto steps = plan();
  EXPECT_EQ(steps.at("sessions/a/calibrate").needs.at(0).name, "sessions/a/detect");
  EXPECT_EQ(steps.at("sessions/a/calibrate").words.at(1), "{result:sessions/a/detect}");
  EXPECT_EQ(steps.count("sessions/b/detect"), 0u);
}

TEST_F(PlanTest, ItsTextIsReadBack) {
  std::vector<Step> steps;
  for (const auto& [name, step] : plan()) steps.push_back(step);
  write("plan.jsonl", planText(steps));
  for (const auto& [name, planned] : plan()) {
    const Step step = readPlannedStep(root_ / "plan.jsonl", name);
    EXPECT_EQ(step.key, planned.key);
    EXPECT_EQ(step.words, planned.words);
  }
  EXPECT_THROW(readPlannedStep(root_ / "plan.jsonl", "sessions/c"), InputError);
}

TEST_F(PlanTest, StagesHoldNoStepBeforeWhatItNeeds) {
  std::vector<Step> steps;
  for (const auto& [name, step] : plan()) steps.push_back(step);
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.needs.size() < b.needs.size(); });
  const auto stages = unsettledStages(root_ / "night", steps);
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0].size(), 4u);
  EXPECT_EQ(stages[1].size(), 8u);
}

TEST_F(PlanTest, EveryKindOfStepHasAGuessOfItsTime) {
  std::vector<Step> steps;
  for (const char* word : enumWords(StepKind())) {
    Step& step = steps.emplace_back();
    step.name = word;
    step.kind = *enumFrom<StepKind>(word);
  }
  const auto seconds = estimateSeconds(root_ / "night", steps);
  EXPECT_EQ(seconds.size(), steps.size());
  for (const auto& [name, guess] : seconds) EXPECT_GT(guess, 0) << name;
}

TEST_F(PlanTest, HashesOfUnchangedFilesAreKept) {
  InputHashes first(root_ / "kept.txt");
  write("old/file", "content");
  const auto past = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(root_ / "old/file", past);
  const auto hashed = first.of(root_ / "old");
  first.save();
  // What the file holds is not looked at again: its stamp is the same.
  std::string kept =
      "0123456789abcdef" + std::string(" ") + hashed.stamp + " " + (root_ / "old").string() + "\n";
  write("kept.txt", kept);
  InputHashes second(root_ / "kept.txt");
  EXPECT_EQ(second.of(root_ / "old").content, "0123456789abcdef");
  // Written in place and given its earlier time. The clock of a file system ticks in milliseconds.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  write("old/file", "Content");
  std::filesystem::last_write_time(root_ / "old/file", past);
  InputHashes third(root_ / "kept.txt");
  EXPECT_NE(third.of(root_ / "old").content, "0123456789abcdef");
  EXPECT_NE(third.of(root_ / "old").content, hashed.content);
}

TEST(SlurmOptions, AreRefusedOutOfRange) {
  EXPECT_NO_THROW(SlurmOptions().check());
  EXPECT_THROW(SlurmOptions{.throttle = -1}.check(), InputError);
  EXPECT_THROW(SlurmOptions{.pack_s = 0}.check(), InputError);
  EXPECT_THROW(SlurmOptions{.rounds = 0}.check(), InputError);
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/definition/definition.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "datasets/files/bad_input.h"
#include "tests/evaluate/study/study_files.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

void refuseColour(const StudyCommandOptions& options) {
  for (const auto& [option, words] : options) {
    if (option == "colour") throw InputError("no option --colour");
  }
  if (options.size() > 2) throw InputError("too many options together");
}

const std::string kSequence = "sequences: [{name: s, path: eval, truth: target.yaml}]\n";

class DefinitionTest : public StudyFiles {
 protected:
  std::string refusal(const std::string& path) const {
    try {
      readStudy(path, {refuseColour, refuseColour});
      return "accepted";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

TEST_F(DefinitionTest, ReadsWhatItSays) {
  const StudyDefinition study =
      readStudy(this->study("rig: d435i-1\ntarget: target.yaml\ntarget_shape: one\nlimit_s: 300\n"
                            "calibrate: {pixel_sigma: 0.5}\nthresholds: {regression_sigma: 6}\n"
                            "perturbations: {offsets_ms: [100, -1]}\n"),
                {refuseColour, refuseColour});
  EXPECT_EQ(study.name, "trial");
  EXPECT_EQ(study.rig, "d435i-1");
  EXPECT_EQ(study.methods, (std::vector<std::string>{"free", "guided"}));
  ASSERT_EQ(study.sessions.size(), 4u);
  EXPECT_EQ(study.sessions[0].row.capture_s, 60);
  EXPECT_EQ(study.sessions[0].row.stages[1].name, "camera_imu");
  EXPECT_EQ(study.sessions[0].path, std::filesystem::weakly_canonical(root_ / "p1_free"));
  EXPECT_TRUE(study.sessions[0].row.finished);
  EXPECT_FALSE(study.sessions[2].row.finished);
  EXPECT_EQ(study.offsets_ms, (std::vector<double>{100, -1}));
  EXPECT_EQ(study.calibrate.at(0), (std::pair<std::string, std::string>("pixel-sigma", "0.5")));
  EXPECT_EQ(study.thresholds.sigma, 6);
  EXPECT_EQ(study.target_shape, StudyTargetShape::kOne);
  EXPECT_TRUE(study.target.has_value());
  EXPECT_EQ(study.limit_s, 300);
}

TEST_F(DefinitionTest, RefusesWithFileAndLine) {
  struct Case {
    std::string further;
    const char* line;
    const char* words;
  };
  const Case cases[] = {
      {"colour: red\n", ":10:", "unknown key 'colour'"},
      {"target: missing.yaml\n", ":10:", "is not a file"},
      {"target_shape: bent\n", ":10:", "is not a file"},
      {"limit_s: -1\n", ":10:", "seconds, 0 to 86400"},
      {"limit_s: 600000\n", ":10:", "limit_s is 600000"},
      {"limit_s: 0\n", ":10:", "seconds above 0"},
      {"calibrate: {colour: red}\n", ":10:", "no option --colour"},
      {"calibrate:\n  loss: none\n  seed: 2\n  colour: red\n", ":13:", "no option --colour"},
      {"calibrate:\n  loss: none\n  seed: 2\n  joint: true\n", ":11:", "too many options"},
      {"perturbations: {offsets_ms: [100, 1e9]}\n", ":10:", "milliseconds up to"},
      {"perturbations: {offsets_s: [1]}\n", ":10:", "unknown key 'offsets_s'"},
      {"calibrate: {no-imu: true}\nperturbations: {offsets_ms: [1]}\n", ":11:", "no-imu"},
      {"thresholds: {regression_sigma: 0}\n", ":10:", "above 0"},
      {"limits: {step_mb: 1}\n", ":10:", "256 or more"},
      {"cross: perhaps\n", ":10:", "true or false"},
      {"sequences: [{name: s, path: eval, truth: t.csv}]\n", ":10:", "t.csv is not a file"},
      {"trajectories: {pattern: 'x/{calibration}.txt'}\n", ":10:", "no sequences"},
      {kSequence + "trajectories: {command: a, odometry: builtin}\n", ":11:", "one of pattern"},
      {kSequence + "trajectories: {odometry: mine}\n", ":11:", "is not a file"},
      {kSequence + "trajectories: {odometry: builtin, runs: 3}\n", ":11:", "built-in odometry"},
      {kSequence + "trajectories: {command: a, runs: 3}\n", ":11:", "applies to an odometry"},
      {kSequence + "trajectories: {odometry: openvins, runs: 0}\n", ":11:", "runs of each"},
      {kSequence + "trajectories: {odometry: builtin, metrics: {colour: red}}\n",
       ":11:", "no option"},
      {kSequence + "trajectories: {odometry: builtin, metrics: {estimate-w-first: true}}\n",
       ":11:", "--estimate-w-first is of what an external system writes"},
      {kSequence + "trajectories: {odometry: builtin, metrics: {estimate_inverted: true}}\n",
       ":11:", "--estimate-inverted"},
      {"study: again\n", ":10:", "given twice"},
      {"endpoints: [a, a]\n", ":10:", "'a' is given twice"},
      {"endpoints: [held_out_rmse]\n", ":10:", "no figure is named 'held_out_rmse'"},
  };
  for (const Case& c : cases) {
    EXPECT_THAT(refusal(study(c.further)), AllOf(HasSubstr(c.line), HasSubstr(c.words)))
        << c.further;
  }
}

TEST_F(DefinitionTest, RefusesSessionsWithFileAndLine) {
  struct Case {
    const char* session;
    const char* words;
  };
  const Case cases[] = {
      {"{name: a, participant: p1, method: free, period: 1, path: nowhere}", "nowhere"},
      {"{name: b, participant: p1, method: free, period: 1, path: p1_free}", "'b' is given twice"},
      {"{name: a, participant: p1, method: free, period: 1, path: p1_guided}",
       "that of session a, too"},
      {"{name: a, participant: p1, method: free, period: 1, path: eval}",
       "that of session a, whose calibration would be scored on its own corners"},
      {"{name: a/b, participant: p1, method: free, period: 1, path: p1_free}", "cannot name"},
      {"{name: .., participant: p1, method: free, period: 1, path: p1_free}", "cannot name"},
      {"{name: a, participant: p1, method: best, period: 1, path: p1_free}", "one of free, guided"},
      {"{name: a, participant: p3, method: free, period: 1, path: p1_free}",
       "participant p3 has no session with the method 'guided'"},
      {"{name: a, participant: p1, method: free, period: 2, path: p1_free}",
       "two sessions in period 2"},
      {"{name: a, participant: p1, method: free, period: 0, path: p1_free}", "period is 0"},
      {"{name: a, participant: p1, method: free, period: 1, path: p1_free, capture_s: 90000}",
       "a day"},
      {"{name: a, participant: p1, method: free, period: 1, path: p1_free, capture_s: 73200}",
       "122 times limit_s (600 s)"},
      {"{name: a, participant: p1, method: free, period: 1, path: p1_free, capture_s: 10, "
       "stages_s: {camera: 20}}",
       "the stages take 20 s together"},
      {"{name: a, participant: p1, method: free, period: 1, path: p1_free, other: [{tool: kalibr, "
       "path: p1_free}]}",
       "camchain"},
      {"{name: a, participant: p1, method: free, period: 1, path: p1_free, speed: 1}",
       "unknown key 'speed'"},
  };
  for (const Case& c : cases) {
    const std::string said = refusal(study("", std::string("  - ") + c.session + "\n"));
    EXPECT_THAT(said, AllOf(HasSubstr("STUDY.yaml:"), HasSubstr(c.words))) << c.session;
  }
}

TEST_F(DefinitionTest, SaysAllThatIsWrongAtOnceInTheOrderOfTheLines) {
  const std::string path =
      study("colour: red\nlimit_s: -1\ncross: perhaps\nspeed: 3\ntarget: missing.yaml\n",
            "  - {name: a/b, participant: p1, method: best, period: 0, path: nowhere}\n");
  try {
    readStudy(path, {refuseColour, refuseColour});
    FAIL() << "accepted";
  } catch (const InputErrors& errors) {
    std::vector<std::pair<int, std::string>> found;
    for (const InputError& error : errors.all()) {
      EXPECT_EQ(error.path(), path);
      found.emplace_back(error.line(), error.what());
    }
    ASSERT_EQ(found.size(), 9u) << errors.what();
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                               [](const auto& a, const auto& b) { return a.first < b.first; }));
    const std::vector<std::pair<int, std::string>> expected = {
        {4, "cannot name a folder"},  {4, "unknown method 'best'"},
        {4, "period is 0"},           {4, "nowhere"},
        {10, "unknown key 'colour'"}, {11, "seconds, 0 to 86400"},
        {12, "true or false"},        {13, "unknown key 'speed'"},
        {14, "is not a file"}};
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(found[i].first, expected[i].first) << found[i].second;
      EXPECT_THAT(found[i].second, HasSubstr(expected[i].second));
    }
  }
}

TEST_F(DefinitionTest, SaysOfEachParticipantOnceThatASessionIsMissing) {
  const std::string said = refusal(
      study("", "  - {name: a, participant: p3, method: free, period: 1, path: p1_free}\n"));
  EXPECT_THAT(said, AllOf(HasSubstr("participant p3 has no session with the method 'guided'"),
                          HasSubstr("participant p1 has no session with the method 'free'")));
}

TEST_F(DefinitionTest, TakesTheChainWithTheImuOfAKalibrFolder) {
  write("kalibr/run-camchain.yaml", "");
  write("kalibr/run-camchain-imucam.yaml", "");
  const auto read = readStudy(
      study("",
            "  - {name: a, participant: p1, method: free, period: 1, path: p1_free, other: "
            "[{tool: kalibr, path: kalibr}]}\n"),
      {refuseColour, refuseColour});
  EXPECT_THAT(read.sessions[0].others.at(0).second, HasSubstr("run-camchain-imucam.yaml"));
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// plumbline target as a user runs it.
#include <string>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CommandTarget : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() / ("plumbline_target_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  void simulate(const char* seed, const std::string& shape,
                const std::string& options = "--camera-rate 5") const {
    const std::string command = "simulate --rig euroc --duration 12 --target-shape " + shape;
    ASSERT_EQ(
        plumbline(command + " --seed " + seed + " --out " + at(seed) + " " + options).exit_code, 0);
  }

  std::string at(const char* name) const { return (root_ / name).string(); }

  fs::path root_;
};

TEST_F(CommandTarget, PrintsASheetAndItsTargetYaml) {
  const std::string what = "target print --rows 4 --cols 5 --tag-size 3cm --paper A3 --out ";
  const Outcome outcome = plumbline(what + at("april.pdf"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_TRUE(fs::exists(at("april.pdf")));
  EXPECT_THAT(contents(root_).at("april.yaml"),
              AllOf(HasSubstr("tagCols: 5"), HasSubstr("tagSize: 0.03 ")));
  EXPECT_EQ(plumbline(what + at("april.pdf")).exit_code, 2) << "an earlier sheet stays";
  EXPECT_EQ(plumbline(what + at("april.pdf") + " --force").exit_code, 0);
}

TEST_F(CommandTarget, RefusesWhatCannotBePrinted) {
  for (const char* wrong : {"--tag-size 88", "--tag-size 88mm --paper A9", "--tag-size 500mm"}) {
    const Outcome outcome =
        plumbline(std::string("target print ") + wrong + " --out " + at("x.pdf"));
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_FALSE(fs::exists(at("x.pdf"))) << wrong;
  }
  const Outcome yaml = plumbline("target print --tag-size 88mm --out " + at("x.yaml"));
  EXPECT_EQ(yaml.exit_code, 2);
  EXPECT_THAT(yaml.text, HasSubstr("x.yaml: expected a name that ends in .pdf"));
  EXPECT_FALSE(fs::exists(at("x.yaml")));
}

TEST_F(CommandTarget, FitsOneBoardToSeveralSessions) {
  simulate("1", "bow=1mm");
  simulate("2", "bow=1mm");
  const Outcome outcome = plumbline("target fit " + at("1") + " " + at("2") +
                                    " --models pinhole-radtan --out " + at("shape.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("from 2 sessions"), HasSubstr("the same board")));
  EXPECT_THAT(contents(root_).at("shape.yaml"), HasSubstr("terms_mm"));
  EXPECT_EQ(plumbline("target fit " + at("1") + " " + at("2") + " --threads 1" +
                      " --models pinhole-radtan --out " + at("alone.yaml"))
                .exit_code,
            0);
  EXPECT_EQ(contents(root_).at("alone.yaml"), contents(root_).at("shape.yaml"))
      << "sessions are calibrated one after the other, or at the same time";
  EXPECT_EQ(plumbline("target fit " + at("nowhere") + " --out " + at("y.yaml")).exit_code, 2);
  const Outcome twice =
      plumbline("target fit " + at("1") + " " + at("1") + " --out " + at("z.yaml"));
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.text, HasSubstr("is the same recording as"));
}

// The first session chooses the lens models of its rig, whatever the threads.
TEST_F(CommandTarget, FitsWithLensModelsThatTheFirstSessionChose) {
  simulate("1", "bow=1mm");
  simulate("2", "bow=1mm");
  const auto fit = [&](const std::string& words, const char* file) {
    const Outcome outcome = plumbline("target fit " + words + " --force --out " + at(file));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  };
  fit(at("1") + " " + at("2") + " --threads 1", "one.yaml");
  fit(at("1") + " " + at("2") + " --threads 2", "two.yaml");
  EXPECT_EQ(contents(root_).at("one.yaml"), contents(root_).at("two.yaml"));
}

// A radtan and a fisheye rig whose sensor.yaml read alike.
TEST_F(CommandTarget, ARigThatLooksLikeAnotherChoosesItsOwnModels) {
  simulate("1", "bow=1mm");
  ASSERT_EQ(plumbline("simulate --rig tumvi --duration 12 --camera-rate 5 --target-shape bow=1mm "
                      "--seed 2 --out " +
                      at("2"))
                .exit_code,
            0);
  for (const char* session : {"1", "2"}) {
    for (const char* camera : {"cam0", "cam1"}) {
      write(fs::path(at(session)) / "mav0" / camera / "sensor.yaml", "resolution: [752, 512]\n");
    }
  }
  const Outcome outcome =
      plumbline("target fit " + at("1") + " " + at("2") + " --out " + at("shape.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("1: shows the same"), HasSubstr("2: shows the same")));
}

// Deviations are those of the corners' own noise of 0.2 px: at the stated pixel sigma of 1 px the
// tenth of a millimetre of session 3 would pass for chance.
TEST_F(CommandTarget, NamesSessionsWhoseBoardBent) {
  const std::string all_frames;  // a tenth of a millimetre needs them
  simulate("1", "bow=1mm", all_frames);
  simulate("2", "bow=1mm", all_frames);
  simulate("3", "bow=1.1mm", all_frames);
  simulate("4", "bow=2mm", all_frames);
  const auto fit = [&](const std::string& others) {
    const Outcome outcome = plumbline("target fit " + at("1") + " " + at("2") + others +
                                      " --models pinhole-radtan --force --out " + at("shape.yaml"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return outcome.text;
  };
  EXPECT_THAT(fit(" " + at("3")), HasSubstr("3: differs significantly, but its own"));
  EXPECT_THAT(fit(" " + at("4")), HasSubstr("4: differs, and its own shape predicts held-out"));
}

}  // namespace
}  // namespace plumbline

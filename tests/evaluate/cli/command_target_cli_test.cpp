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
}

TEST_F(CommandTarget, FitsOneBoardToSeveralSessions) {
  for (const char* seed : {"1", "2"}) {
    ASSERT_EQ(plumbline(std::string("simulate --rig euroc --duration 12 --target-shape bow=1mm "
                                    "--seed ") +
                        seed + " --out " + at(seed))
                  .exit_code,
              0);
  }
  const Outcome outcome = plumbline("target fit " + at("1") + " " + at("2") +
                                    " --models pinhole-radtan --out " + at("shape.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("from 2 sessions"), HasSubstr("the same board")));
  EXPECT_THAT(contents(root_).at("shape.yaml"), HasSubstr("terms_mm"));
  EXPECT_EQ(plumbline("target fit " + at("nowhere") + " --out " + at("y.yaml")).exit_code, 2);
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// A study's definition as a file.
#include "datasets/session/study_reader.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/datasets/refusal.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

const std::vector<std::string> kKnown{"offsets-ms", "corner-noise-px", "seed"};

std::string fileWith(const std::string& text) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "study_reader_test.yaml";
  std::ofstream(path) << text;
  return path.string();
}

TEST(StudyDefinition, ValuesAndListsBecomeText) {
  const auto definition = readStudyDefinition(
      fileWith("# a study\noffsets-ms: [100, -3.21]\ncorner-noise-px: 0.1:0.1:0.5\nseed: 7\n"),
      kKnown);
  EXPECT_THAT(definition, ElementsAre(Pair("offsets-ms", "100,-3.21"),
                                      Pair("corner-noise-px", "0.1:0.1:0.5"), Pair("seed", "7")));
}

TEST(StudyDefinition, FaultsNameTheirLine) {
  struct Case {
    const char* text;
    int line;
    InputFault code;
  };
  for (const auto& [text, line, code] :
       {Case{"seed: 1\noffset-ms: 1\n", 2, InputFault::kUnknownWord},
        Case{"seed: 1\noffsets-ms:\n", 1, InputFault::kBadNumber},
        Case{"offsets-ms: {from: 1}\n", 1, InputFault::kBadNumber},
        Case{"offsets-ms: [[1, 2]]\n", 1, InputFault::kBadNumber},
        Case{"offsets-ms: [1\n", 2, InputFault::kSyntax}}) {
    const std::string path = fileWith(text);
    const auto refusal = refusalOf([&] { (void)readStudyDefinition(path, kKnown); });
    ASSERT_TRUE(refusal) << text;
    EXPECT_EQ(refusal->path(), path);
    EXPECT_EQ(refusal->line(), line) << refusal->what();
    EXPECT_EQ(refusal->code(), code) << refusal->what();
  }
  EXPECT_EQ(faultOf([] { (void)readStudyDefinition("no/such/file.yaml", kKnown); }),
            InputFault::kMissingFile);
}

}  // namespace
}  // namespace plumbline

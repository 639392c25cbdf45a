// SPDX-License-Identifier: BSD-3-Clause
// A study's definition as a file.
#include "datasets/session/study_reader.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
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
  for (const auto& [text, words] : std::initializer_list<std::pair<const char*, const char*>>{
           {"seed: 1\noffset-ms: 1\n", ":2: unknown name 'offset-ms'"},
           {"seed: 1\noffsets-ms:\n", "offsets-ms has no value"},
           {"offsets-ms: {from: 1}\n", ":1: offsets-ms has no value"},
           {"offsets-ms: [[1, 2]]\n", ":1: offsets-ms has no value"},
           {"offsets-ms: [1\n", "study_reader_test.yaml"}}) {
    const std::string path = fileWith(text);
    try {
      (void)readStudyDefinition(path, kKnown);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr(path), HasSubstr(words))) << text;
    }
  }
  EXPECT_THROW((void)readStudyDefinition("no/such/file.yaml", kKnown), InputError);
}

}  // namespace
}  // namespace plumbline

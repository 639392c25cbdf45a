// SPDX-License-Identifier: BSD-3-Clause
// The one rule of all lists on the command line.
#include "evaluate/cli/options/option_lists.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The entries of a list option of a program with these arguments, or what it says of them.
std::vector<std::string> parsed(std::vector<std::string> arguments, ListOf of = ListOf::kWords) {
  CLI::App app;
  std::vector<std::string> entries{"default"};
  std::string out;
  addList(app, "--list", entries, "help", of);
  app.add_option("--out", out)->required();
  arguments.insert(arguments.end(), {"--out", "x"});
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(arguments);
  } catch (const std::exception& error) {
    return {error.what()};
  }
  return entries;
}

TEST(OptionList, HasCommasBetweenEntriesAndMayBeRepeated) {
  EXPECT_THAT(parsed({}), ElementsAre("default"));
  EXPECT_THAT(parsed({"--list", "a,b"}), ElementsAre("a", "b"));
  EXPECT_THAT(parsed({"--list", " a, b "}), ElementsAre("a", "b"));
  EXPECT_THAT(parsed({"--list", "a,b", "--list", "c"}), ElementsAre("a", "b", "c"));
}

TEST(OptionList, RefusesEmptyEntriesByName) {
  for (const char* list : {"", ",", "a,", ",a", "a,,b", "a, ,b"}) {
    EXPECT_THAT(parsed({"--list", list}),
                ElementsAre(AllOf(HasSubstr("--list"), HasSubstr("empty entry"))))
        << list;
  }
}

TEST(OptionList, RefusesARepeatedEntry) {
  const auto refused = ElementsAre(AllOf(HasSubstr("--list"), HasSubstr("a is given twice")));
  EXPECT_THAT(parsed({"--list", "a,b,a"}), refused);
  EXPECT_THAT(parsed({"--list", "a", "--list", "a"}), refused);
  EXPECT_THROW(refuseRepeated("--x", std::vector<double>{1, 2, 1.0}), InputError);
  EXPECT_THROW(refuseRepeated("--x", std::vector<double>{0.0, -0.0}), InputError);
  EXPECT_NO_THROW(refuseRepeated("--x", std::vector<double>{1, 2}));
}

TEST(OptionList, OfPathsTakesAWordThatExistsAsOne) {
  const fs::path root = fs::path(::testing::TempDir()) / "option_lists_test";
  fs::create_directories(root / "a,b");
  fs::create_directories(root / "c");
  const std::string both = (root / "a,b").string(), other = (root / "c").string();
  EXPECT_THAT(parsed({"--list", both}, ListOf::kPaths), ElementsAre(both));
  EXPECT_THAT(parsed({"--list", other + "," + root.string()}, ListOf::kPaths),
              ElementsAre(other, root.string()));
  EXPECT_THAT(parsed({"--list", both, "--list", other}, ListOf::kPaths), ElementsAre(both, other));
  EXPECT_THAT(parsed({"--list", both}), testing::SizeIs(2)) << "of words";
  EXPECT_THAT(parsed({"--list", other + "," + (root / "c/../c").string()}, ListOf::kPaths),
              ElementsAre(HasSubstr("c/../c is given twice")));
  fs::remove_all(root);
}

}  // namespace
}  // namespace plumbline

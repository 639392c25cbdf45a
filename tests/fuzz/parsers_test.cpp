// SPDX-License-Identifier: BSD-3-Clause
// What the fuzzers run on (scripts/fuzz.sh), once each in every build: good files are accepted,
// their halves do no harm, and no file that ever made a parser fail does so again.
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path kRegressions = fs::path(PLUMBLINE_SOURCE_DIR) / "tests/fuzz/regressions";

class EveryParser : public ::testing::TestWithParam<NamedParser> {
 protected:
  const Parser& parser() const { return GetParam().parser; }
  Scratch scratch_;
};

TEST_P(EveryParser, AcceptsItsSeeds) {
  const std::vector<std::string> seeds = parser().seeds();
  EXPECT_FALSE(seeds.empty());
  for (const std::string& seed : seeds) EXPECT_TRUE(accepts(parser(), scratch_, seed)) << seed;
}

TEST_P(EveryParser, CutSeedsAreReadOrRefused) {
  for (const std::string& seed : parser().seeds()) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, seed.size() / 2}) {
      EXPECT_NO_THROW(accepts(parser(), scratch_, seed.substr(0, size))) << seed.substr(0, size);
    }
  }
}

TEST_P(EveryParser, NoOldFaultComesBack) {
  const fs::path folder = kRegressions / GetParam().name;
  if (!fs::exists(folder)) return;
  for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
    EXPECT_NO_THROW(accepts(parser(), scratch_, readBytes(file.path()))) << file.path();
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, EveryParser, ::testing::ValuesIn(allParsers()),
                         [](const auto& info) { return info.param.name; });

TEST(Regressions, BelongToParsers) {
  std::set<std::string> names;
  for (const NamedParser& parser : allParsers()) names.insert(parser.name);
  for (const fs::directory_entry& folder : fs::directory_iterator(kRegressions)) {
    EXPECT_TRUE(names.contains(folder.path().filename())) << folder.path();
  }
}

}  // namespace
}  // namespace plumbline::fuzz

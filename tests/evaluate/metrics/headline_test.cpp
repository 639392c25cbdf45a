// SPDX-License-Identifier: BSD-3-Clause
// The sentence that a reader sees first.
#include "evaluate/metrics/headline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

Finding findingOf(const std::string& rule, VerdictLevel level) {
  Finding f;
  f.rule = rule;
  f.level = level;
  f.evidence = "evidence of " + rule;
  f.advice = level == VerdictLevel::kGood ? "" : "cure of " + rule;
  return f;
}

TEST(Headline, OfAGoodResultIsItsOwnSentence) {
  const Verdict verdict = makeVerdict({findingOf("a", VerdictLevel::kGood)});
  EXPECT_EQ(headlineOf(verdict, "cameras to 0.3 px"), "Cameras to 0.3 px.");
}

TEST(Headline, LeadsWithTheGravestFinding) {
  const Verdict verdict =
      makeVerdict({findingOf("a", VerdictLevel::kGood), findingOf("b", VerdictLevel::kCaution),
                   findingOf("c", VerdictLevel::kBad), findingOf("d", VerdictLevel::kBad)});
  EXPECT_EQ(headlineOf(verdict, "unused"), "C: evidence of c. Cure of c. 2 more findings below.");
}

TEST(Headline, TheWorstFindingStandsAlone) {
  const Verdict verdict =
      makeVerdict({findingOf("a", VerdictLevel::kCaution), findingOf("b", VerdictLevel::kBad),
                   findingOf("c", VerdictLevel::kBad)});
  EXPECT_EQ(worstFinding(verdict), "B: evidence of b. Cure of b.");
  EXPECT_EQ(gravest(verdict)->rule, "b");
  const Verdict good = makeVerdict({findingOf("a", VerdictLevel::kGood)});
  EXPECT_EQ(worstFinding(good), "");
  EXPECT_EQ(gravest(good), nullptr);
}

TEST(Headline, OneMoreFindingIsOne) {
  const Verdict verdict =
      makeVerdict({findingOf("a", VerdictLevel::kCaution), findingOf("b", VerdictLevel::kCaution)});
  EXPECT_THAT(headlineOf(verdict, ""), HasSubstr("1 more finding below."));
}

TEST(VerdictText, ListsWhatIsNotGood) {
  Verdict verdict =
      makeVerdict({findingOf("a", VerdictLevel::kGood), findingOf("b", VerdictLevel::kCaution)});
  verdict.headline = "B: so and so.";
  EXPECT_EQ(verdictText(verdict),
            "Verdict: CAUTION\nB: so and so.\n  caution - b: evidence of b\n      Cure of b.\n");
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// A replay comes back from the store as it was saved, down to the log's lines and the page's text.
#include <gtest/gtest.h>

#include "report/html/replay/page.h"
#include "report/store/store.h"
#include "tests/datasets/temporary_folder.h"
#include "tests/report/synthetic_replay.h"

namespace plumbline {
namespace {

ReplayRecord loaded(const ReplayRecord& saved) {
  const TemporaryFolder folder;
  Store(folder.path("runs.sqlite")).save(saved);
  return Store(folder.path("runs.sqlite")).loadReplay();
}

TEST(ReplayStore, KeepsWhatWasWithdrawn) {
  const ReplayRecord saved = test::syntheticReplay();
  const ReplayRecord read = loaded(saved);
  ASSERT_EQ(read.decisions.size(), saved.decisions.size());
  std::size_t frames = 0, suggestions = 0;
  for (std::size_t i = 0; i < saved.decisions.size(); ++i) {
    EXPECT_EQ(read.decisions[i].withdrawn, saved.decisions[i].withdrawn);
    EXPECT_EQ(read.decisions[i].event, saved.decisions[i].event);
    frames += read.decisions[i].withdrawn.size();
    suggestions += read.decisions[i].event == SuggestionEvent::kWithdrawn ? 1 : 0;
  }
  EXPECT_EQ(frames, 2U);
  EXPECT_GE(suggestions, 1U);
}

TEST(ReplayStore, ThePageOfWhatComesBackIsTheSame) {
  const ReplayRecord saved = test::syntheticReplay();
  EXPECT_TRUE(renderReplayPage(loaded(saved)) == renderReplayPage(saved));
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// A replay comes back from the store as it was saved, down to the log's lines and the page's text.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "report/html/replay_page.h"
#include "report/store/store.h"
#include "tests/report/synthetic_replay.h"

namespace plumbline {
namespace {

class ReplayStoreTest : public ::testing::Test {
 protected:
  ReplayStoreTest() { std::filesystem::remove(file_); }
  ~ReplayStoreTest() override { std::filesystem::remove(file_); }
  ReplayStoreTest(const ReplayStoreTest&) = delete;
  ReplayStoreTest& operator=(const ReplayStoreTest&) = delete;

  ReplayRecord loaded(const ReplayRecord& saved) const {
    Store(file_).save(saved);
    return Store(file_).loadReplay();
  }

  std::filesystem::path file_ = std::filesystem::temp_directory_path() /
                                ("plumbline_replay_store_" + std::to_string(getpid()) + ".sqlite");
};

TEST_F(ReplayStoreTest, KeepsWhatWasWithdrawn) {
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

TEST_F(ReplayStoreTest, ThePageOfWhatComesBackIsTheSame) {
  const ReplayRecord saved = test::syntheticReplay();
  EXPECT_TRUE(renderReplayPage(loaded(saved)) == renderReplayPage(saved));
}

}  // namespace
}  // namespace plumbline

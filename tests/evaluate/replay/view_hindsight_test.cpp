// SPDX-License-Identifier: BSD-3-Clause
// Which views were worth it, once all are known: on information matrices whose answer is plain.
#include <cmath>

#include <gtest/gtest.h>

#include "evaluate/replay/stage_summary.h"

namespace plumbline {
namespace {

Eigen::MatrixXd share(double a, double b) { return Eigen::Vector2d(a, b).asDiagonal(); }

constexpr double kThreshold = 0.1;  // [nats]

TEST(ViewHindsight, AViewThatRepeatsTheOthersIsRedundant) {
  // Taking away the third leaves half log(2 / 2.1) = 0.024 nats of the first direction.
  const auto h = viewHindsight({share(2, 0), share(0, 2), share(0.1, 0)},
                               std::vector<FrameUse>(3, FrameUse::kKept), kThreshold);
  EXPECT_EQ(h.redundant, 1);
  EXPECT_EQ(h.missed, 0);
}

TEST(ViewHindsight, OfTwoAlikeOnlyOneCanGo) {
  // Either of the first two is worth 0.5 log 2 = 0.35 nats; of four alike two can go before what
  // remains is worth more than 0.25 nats.
  EXPECT_EQ(
      viewHindsight({share(1, 1), share(1, 1)}, std::vector<FrameUse>(2, FrameUse::kKept), 0.3)
          .redundant,
      0);
  EXPECT_EQ(viewHindsight(std::vector<Eigen::MatrixXd>(4, share(1, 0) + share(0, 1e-3)),
                          std::vector<FrameUse>(4, FrameUse::kKept), 0.5)
                .redundant,
            2);
}

TEST(ViewHindsight, AViewPassedByThatTellsMuchWasMissed) {
  const std::vector<FrameUse> uses{FrameUse::kKept, FrameUse::kPassedBy, FrameUse::kPassedBy};
  // The first one passed by doubles the information; after it the second one tells little.
  const auto h = viewHindsight({share(1, 1), share(1, 1), share(0.1, 0.1)}, uses, kThreshold);
  EXPECT_EQ(h.missed, 1);
}

TEST(ViewHindsight, WhatCameAfterTheFinishIsTheInformationItAdds) {
  const auto h = viewHindsight({share(1, 1), share(3, 0)},
                               {FrameUse::kKept, FrameUse::kAfterFinish}, kThreshold);
  EXPECT_DOUBLE_EQ(h.after_finish_nats, 0.5 * std::log(4.0));
}

TEST(ViewHindsight, UndeterminedCamerasHaveNoHindsight) {
  const auto h = viewHindsight({share(1, 0), share(0, 1)},
                               {FrameUse::kKept, FrameUse::kAfterFinish}, kThreshold);
  EXPECT_EQ(h.redundant, 0);
  EXPECT_TRUE(std::isinf(h.after_finish_nats));
  EXPECT_EQ(viewHindsight({}, {}, kThreshold).missed, 0);
}

}  // namespace
}  // namespace plumbline

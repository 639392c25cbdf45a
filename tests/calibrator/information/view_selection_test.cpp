// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/view_selection.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "calibrator/information/covariance.h"
#include "tests/calibrator/information/random_information.h"

namespace plumbline {
namespace {

using test::randomInformation;

constexpr int kViewParameters = 6;

// Views of rank 3: one alone does not determine the parameters.
std::vector<Eigen::MatrixXd> someViews(int count) {
  std::vector<Eigen::MatrixXd> views;
  for (int i = 0; i < count; ++i) {
    views.push_back(randomInformation(kViewParameters, 3, static_cast<std::uint64_t>(100 + i)));
  }
  return views;
}

Eigen::VectorXd typicalOf(const std::vector<Eigen::MatrixXd>& views) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(kViewParameters, kViewParameters);
  for (const Eigen::MatrixXd& view : views) sum += view;
  return sum.diagonal();
}

TEST(ViewSelector, IncrementalGainEqualsTheOneFromScratch) {
  const auto views = someViews(30);
  ViewSelector selector(0.0, typicalOf(views));
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(kViewParameters, kViewParameters);
  int compared = 0;
  for (const Eigen::MatrixXd& view : views) {
    const auto nats = mutualInformationNats(sum, sum + view);
    const auto gain = selector.gainBits(view);
    ASSERT_EQ(gain.has_value(), nats.has_value());
    if (gain) {
      EXPECT_NEAR(*gain, bitsFromNats(*nats), 1e-9);
      ++compared;
    }
    ASSERT_TRUE(selector.offer(view));  // every view tells more than nothing
    sum += view;
  }
  EXPECT_GE(compared, 27);
  EXPECT_TRUE(selector.information().isApprox(sum, 1e-15));
}

TEST(ViewSelector, GainOfARepeatedViewFalls) {
  const auto views = someViews(10);
  ViewSelector selector(0.0, typicalOf(views));
  for (const auto& view : views) selector.offer(view);
  double last = 1e9;
  for (int i = 0; i < 5; ++i) {
    const double gain = *selector.gainBits(views[0]);
    EXPECT_LT(gain, last);
    last = gain;
    selector.offer(views[0]);
  }
}

TEST(SelectViews, KeepsFewerViewsAtAHigherThreshold) {
  const auto views = someViews(200);
  const auto all = selectViews(views, 0.0, 1);
  const auto some = selectViews(views, 0.2, 1);
  const auto few = selectViews(views, 1.0, 1);
  EXPECT_EQ(all.size(), views.size());
  EXPECT_LT(some.size(), all.size());
  EXPECT_LT(few.size(), some.size());
  EXPECT_GE(few.size(), 2u);  // what it takes to determine the parameters
}

TEST(SelectViews, EveryViewKeptPassedAndEveryViewLeftOutFails) {
  const auto views = someViews(100);
  const double threshold = 0.3;
  const auto kept = selectViews(views, threshold, 7);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(kViewParameters, kViewParameters);
  for (const int i : kept) sum += views[static_cast<std::size_t>(i)];
  for (int i = 0; i < 100; ++i) {
    if (std::binary_search(kept.begin(), kept.end(), i)) continue;
    // Gains only fall as more is known, so one that failed when offered fails at the end.
    const auto nats = mutualInformationNats(sum, sum + views[static_cast<std::size_t>(i)]);
    EXPECT_LT(bitsFromNats(*nats), threshold);
  }
}

TEST(SelectViews, TheSeedDecidesTheOrderAndNothingElse) {
  const auto views = someViews(100);
  EXPECT_EQ(selectViews(views, 0.3, 5), selectViews(views, 0.3, 5));
  std::set<std::vector<int>> different;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) different.insert(selectViews(views, 0.3, seed));
  EXPECT_GT(different.size(), 1u);
}

TEST(SelectViews, ParametersThatNoViewTouchesKeepAllViews) {
  std::vector<Eigen::MatrixXd> views(5, Eigen::MatrixXd::Zero(2, 2));
  for (auto& view : views) view(0, 0) = 1;
  EXPECT_EQ(selectViews(views, 0.2, 1).size(), views.size());
  EXPECT_TRUE(selectViews({}, 0.2, 1).empty());
}

}  // namespace
}  // namespace plumbline

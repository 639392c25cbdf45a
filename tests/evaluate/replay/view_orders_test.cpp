// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/view_orders.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/information/view_selection.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<int> identity(int count) {
  std::vector<int> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<int> sorted(std::vector<int> order) {
  std::sort(order.begin(), order.end());
  return order;
}

/// Views of random directions and strengths, each of rank `rank`, in units that differ by 1e6.
std::vector<Eigen::MatrixXd> randomShares(int views, int parameters, int rank) {
  RandomStream random(17, RandomPurpose::kCornerNoise);
  Eigen::VectorXd unit(parameters);
  for (int i = 0; i < parameters; ++i) unit[i] = std::pow(10.0, random.uniform(-3, 3));
  std::vector<Eigen::MatrixXd> shares;
  for (int v = 0; v < views; ++v) {
    Eigen::MatrixXd rows(rank, parameters);
    const double strength = random.uniform(0.2, 3);
    for (int r = 0; r < rank; ++r) {
      for (int c = 0; c < parameters; ++c) rows(r, c) = strength * random.normal() * unit[c];
    }
    shares.emplace_back(rows.transpose() * rows);
  }
  return shares;
}

/// log |M| from eigenvalues of the matrix in units that make it well scaled.
double logDetByEigenvalues(const Eigen::MatrixXd& M, const Eigen::VectorXd& unit) {
  const Eigen::MatrixXd scaled = unit.asDiagonal() * M * unit.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().array().log().sum();
}

/// The definition, without queue or bounds: at each step every view that is left is scored.
std::vector<int> naiveGreedy(const std::vector<Eigen::MatrixXd>& shares) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(shares[0].rows(), shares[0].cols());
  for (const auto& share : shares) all += share;
  const Eigen::VectorXd std = all.inverse().diagonal().cwiseSqrt();
  Eigen::MatrixXd information = (1e-6 * std.cwiseAbs2().cwiseInverse()).asDiagonal();
  std::vector<int> left = identity(static_cast<int>(shares.size()));
  std::vector<int> order;
  while (!left.empty()) {
    const auto score = [&](int v) {
      return logDetByEigenvalues(information + shares[static_cast<std::size_t>(v)], std);
    };
    const auto best = std::max_element(left.begin(), left.end(),
                                       [&](int a, int b) { return score(a) < score(b); });
    information += shares[static_cast<std::size_t>(*best)];
    order.push_back(*best);
    left.erase(best);
  }
  return order;
}

TEST(GreedyInformationOrder, LazyEvaluationFindsTheOrderOfTheDefinition) {
  // Rank 2 of 7 parameters: the first three views do not determine them.
  const auto shares = randomShares(40, 7, 2);
  const auto order = greedyInformationOrder(shares);
  EXPECT_EQ(order, naiveGreedy(shares));
  EXPECT_NE(order, identity(40));
}

TEST(GreedyInformationOrder, GainsNeverGrow) {
  const auto shares = randomShares(60, 6, 3);
  const auto order = greedyInformationOrder(shares);
  ASSERT_EQ(sorted(order), identity(60));
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6, 6);
  for (const auto& share : shares) all += share;
  const Eigen::VectorXd std = all.inverse().diagonal().cwiseSqrt();
  Eigen::MatrixXd information = shares[static_cast<std::size_t>(order[0])];
  information += shares[static_cast<std::size_t>(order[1])];
  double before = logDetByEigenvalues(information, std);
  double last_gain = std::numeric_limits<double>::infinity();
  for (std::size_t i = 2; i < order.size(); ++i) {
    information += shares[static_cast<std::size_t>(order[i])];
    const double after = logDetByEigenvalues(information, std);
    EXPECT_LE(after - before, last_gain * (1 + 1e-9)) << i;
    last_gain = after - before;
    before = after;
  }
}

TEST(GreedyInformationOrder, TakesWhatIsNewBeforeWhatIsStrong) {
  const auto about = [](double a, double b) {
    return Eigen::MatrixXd(Eigen::Vector2d(a, b).asDiagonal());
  };
  // A strong view, its twin, and a weak one that alone tells of the second parameter.
  EXPECT_THAT(greedyInformationOrder({about(100, 0), about(100, 0), about(0, 1)}),
              ElementsAre(2, 0, 1));
  // Alike in everything: in their order.
  EXPECT_THAT(greedyInformationOrder({about(4, 4), about(4, 4), about(4, 4)}),
              ElementsAre(0, 1, 2));
}

TEST(GreedyInformationOrder, NothingWhereAllViewsTogetherLeaveAParameterFree) {
  EXPECT_THAT(greedyInformationOrder({}), IsEmpty());
  EXPECT_THAT(greedyInformationOrder({Eigen::MatrixXd(Eigen::Vector2d(5, 0).asDiagonal())}),
              IsEmpty());
}

TEST(RandomOrder, APermutationThatTheSeedDecides) {
  const auto order = randomOrder(500, 3);
  EXPECT_EQ(sorted(order), identity(500));
  EXPECT_EQ(order, randomOrder(500, 3));
  EXPECT_NE(order, randomOrder(500, 4));
  // Not merely stirred in place: half of the first hundred come from the upper three fifths.
  const auto high =
      std::count_if(order.begin(), order.begin() + 100, [](int i) { return i > 199; });
  EXPECT_GT(high, 45);
  EXPECT_LT(high, 75);
}

TEST(CoverageOrder, MostNewCellsFirstAndAnewOnceAllAreCovered) {
  const std::vector<std::vector<int>> cells = {{0, 1}, {1, 2, 3}, {0, 2}, {4}, {3, 1, 2}};
  // 1 (three cells); of what is new 0 and 2 add one each, 3 as well: 0, then 3. All covered; anew:
  // 4 (three cells), 2 (cell 0).
  EXPECT_THAT(coverageOrder(cells), ElementsAre(1, 0, 3, 4, 2));
  EXPECT_THAT(coverageOrder({{}, {7}, {}}), ElementsAre(1, 0, 2));
  EXPECT_THAT(coverageOrder({}), IsEmpty());
}

TEST(CellsSeen, CountsOverAllCamerasWithTheLastRowAndColumn) {
  Session session;
  session.cameras.resize(2);
  for (CameraStream& camera : session.cameras) camera.resolution = {80, 60};
  session.cameras[0].views.push_back({0, {{0, {-0.5, -0.5}}, {1, {9.4, 9.4}}, {2, {79.4, 59.4}}}});
  session.cameras[1].views.push_back({0, {{0, {9.6, 0}}, {1, {80.5, 0}}}});
  const auto cells = cellsSeen(session, {{0, {0, 0}}, {0, {-1, 0}}});
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_THAT(cells[0], ElementsAre(0, 47, 49, 55));
  EXPECT_THAT(cells[1], ElementsAre(49, 55));
}

}  // namespace
}  // namespace plumbline

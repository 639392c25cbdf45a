// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/corner_refiner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

constexpr double kBlur_px = 0.9;

/// Two lines through p, along the columns of `axes`; sectors dark, light, dark, light. Each edge is
/// a Gaussian's integral, the grey of a blurred checkerboard corner (exactly so for a right angle).
GrayImage saddle(const Eigen::Vector2d& p, const Eigen::Matrix2d& axes) {
  const Eigen::Matrix2d inverse = axes.inverse();
  const auto edge = [&](const Eigen::Vector2d& at, int axis) {
    const Eigen::RowVector2d normal = inverse.row(axis).normalized();
    return std::erf(normal.dot(at - p) / (kBlur_px * std::sqrt(2.0)));
  };
  GrayImage image(60, 50);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Eigen::Vector2d at(x, y);
      image.at(x, y) = static_cast<std::uint8_t>(std::lround(120 - 80 * edge(at, 0) * edge(at, 1)));
    }
  }
  return image;
}

Eigen::Matrix2d axesOf(double angle, double between, double length_a, double length_b) {
  Eigen::Matrix2d axes;
  axes << length_a * std::cos(angle), length_b * std::cos(angle + between),
      length_a * std::sin(angle), length_b * std::sin(angle + between);
  return axes;
}

TEST(CornerRefiner, FindsASaddleWhereItIsInAnyPositionAndDirection) {
  CornerRefiner refiner;
  for (double angle = 0; angle < 6.28; angle += 0.37) {
    const Eigen::Vector2d truth(30 + 0.5 * std::sin(9 * angle), 25 + 0.5 * std::cos(5 * angle));
    const Eigen::Matrix2d axes = axesOf(angle, 1.57 + 0.3 * std::sin(3 * angle), 7, 6);
    const Eigen::Vector2d start = truth + Eigen::Vector2d(std::cos(angle), std::sin(2 * angle));
    const auto found = refiner.refine(saddle(truth, axes).view(), {start, axes, 3});
    ASSERT_TRUE(found.has_value()) << "angle " << angle;
    EXPECT_LT((*found - truth).norm(), 0.02) << "angle " << angle;  // grey levels are integers
  }
}

TEST(CornerRefiner, DoesNotDependOnTheGuess) {
  CornerRefiner refiner;
  const Eigen::Vector2d truth(30.3, 24.6);
  const Eigen::Matrix2d axes = axesOf(0.5, 1.4, 8, 6);
  const GrayImage image = saddle(truth, axes);
  const auto reference = refiner.refine(image.view(), {truth, axes, 3});
  ASSERT_TRUE(reference.has_value());
  for (const Eigen::Vector2d& offset :
       {Eigen::Vector2d(1.5, 1), Eigen::Vector2d(-1.5, 1), Eigen::Vector2d(0.3, -1.8)}) {
    const auto found = refiner.refine(image.view(), {truth + offset, axes, 3});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - *reference).norm(), 0.01);
  }
}

TEST(CornerRefiner, RefusesWhatIsNoCorner) {
  CornerRefiner refiner;
  const Eigen::Vector2d at(30, 25);
  const Eigen::Matrix2d axes = axesOf(0.2, 1.57, 7, 7);
  EXPECT_FALSE(refiner.refine(GrayImage(60, 50, 90).view(), {at, axes, 3}).has_value()) << "flat";

  GrayImage edge(60, 50, 200);
  for (int y = 0; y < 50; ++y) std::fill(edge.row(y), edge.row(y) + 30, std::uint8_t{40});
  EXPECT_FALSE(refiner.refine(edge.view(), {at, axes, 3}).has_value()) << "edge";

  GrayImage lone(60, 50, 200);  // a tag whose small square is covered
  for (int y = 0; y < 25; ++y) std::fill(lone.row(y), lone.row(y) + 30, std::uint8_t{40});
  EXPECT_FALSE(refiner.refine(lone.view(), {at, axesOf(0, 1.57, 7, 7), 3}).has_value()) << "lone";
}

TEST(CornerRefiner, RefusesASaddleWithDarkAndLightExchanged) {
  CornerRefiner refiner;
  const Eigen::Vector2d truth(30.3, 24.6);
  const Eigen::Matrix2d axes = axesOf(0.5, 1.57, 7, 7);
  const GrayImage image = saddle(truth, axes);
  Eigen::Matrix2d turned = axes;
  turned.col(0) = -axes.col(0);
  EXPECT_FALSE(refiner.refine(image.view(), {truth, turned, 3}).has_value());
}

TEST(CornerRefiner, RefusesACornerFurtherAwayThanAllowed) {
  CornerRefiner refiner;
  const Eigen::Vector2d truth(30.3, 24.6);
  const Eigen::Matrix2d axes = axesOf(0.5, 1.57, 7, 7);
  const GrayImage image = saddle(truth, axes);
  const Eigen::Vector2d start = truth + Eigen::Vector2d(2, 0);
  EXPECT_TRUE(refiner.refine(image.view(), {start, axes, 3}).has_value());
  EXPECT_FALSE(refiner.refine(image.view(), {start, axes, 1}).has_value());
}

// In noise the weights, which move along, may have no rest: such a point is nowhere in particular.
TEST(CornerRefiner, RefusesWhatStillMoves) {
  CornerRefiner refiner;
  const Eigen::Matrix2d axes = axesOf(0, 1.5707963, 3, 3);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-10, 10);
  int count = 0;
  for (int k = 0; k < 100; ++k) {
    GrayImage image = saddle({30, 25}, axes);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const double dim = 120 + 0.15 * (image.at(x, y) - 120) + noise(random);
        image.at(x, y) = static_cast<std::uint8_t>(std::lround(dim));
      }
    }
    const auto found = refiner.refine(image.view(), {{30, 25}, axes, 3});
    if (!found) continue;
    ++count;
    const auto again = refiner.refine(image.view(), {*found, axes, 3});
    ASSERT_TRUE(again.has_value()) << k;
    EXPECT_LT((*again - *found).norm(), 0.01) << k;
  }
  EXPECT_GT(count, 50);
}

TEST(CornerRefiner, RefusesAxesThatAreNotFinite) {
  CornerRefiner refiner;
  const Eigen::Vector2d truth(30.3, 24.6);
  Eigen::Matrix2d axes = axesOf(0.5, 1.57, 7, 7);
  const GrayImage image = saddle(truth, axes);
  EXPECT_TRUE(refiner.refine(image.view(), {truth, 1e200 * axes, 3}).has_value());
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    axes(0, 1) = bad;
    EXPECT_FALSE(refiner.refine(image.view(), {truth, axes, 3}).has_value());
  }
}

TEST(CornerRefiner, WindowsAtAndBeyondTheEdgeOfTheImageAreSafe) {
  CornerRefiner refiner;
  const Eigen::Matrix2d axes = axesOf(0.5, 1.57, 7, 7);
  const GrayImage image = saddle({1, 1}, axes);
  for (const Eigen::Vector2d& start : {Eigen::Vector2d(1, 1), Eigen::Vector2d(-40, 20),
                                       Eigen::Vector2d(59, 49), Eigen::Vector2d(1e6, -1e6)}) {
    const auto found = refiner.refine(image.view(), {start, axes, 2});
    EXPECT_TRUE(!found || (*found - start).norm() < 2.01);
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/corner_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/target/corner_refiner.h"
#include "tests/calibrator/target/drawn_corner.h"

namespace plumbline {
namespace {

using test::CornerLook;
using test::drawCorner;

constexpr int kWidth = test::kDrawnWidth, kHeight = test::kDrawnHeight;

Eigen::Matrix2d axesOf(double angle, double between, double length) {
  Eigen::Matrix2d axes;
  axes << std::cos(angle), std::cos(angle + between), std::sin(angle), std::sin(angle + between);
  return length * axes;
}

/// Twenty places in the pixel, directions and angles between the edges; the start a tenth away.
struct Case {
  Eigen::Vector2d truth, start;
  Eigen::Matrix2d axes;
};

std::vector<Case> cases(double length = 7) {
  std::vector<Case> all;
  for (int i = 0; i < 20; ++i) {
    const double a = 0.37 * i;
    const Eigen::Vector2d truth(24 + 0.5 * std::sin(9 * a), 21 + 0.5 * std::cos(5 * a));
    const double between = (i % 2 == 0 ? 1 : -1) * (1.57 + 0.4 * std::sin(3 * a));
    all.push_back({truth, truth + 0.1 * Eigen::Vector2d(std::cos(a), std::sin(2 * a)),
                   axesOf(a, between, length)});
  }
  return all;
}

struct Errors {
  double rms = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
};

template <typename Method>
Errors errorsOf(const CornerLook& look, double length, const Method& method) {
  Errors errors;
  for (const Case& c : cases(length)) {
    const GrayImage image = drawCorner(c.truth, c.axes, look);
    const std::optional<Eigen::Vector2d> found = method(image.view(), c);
    EXPECT_TRUE(found.has_value());
    if (!found) continue;
    errors.rms += (*found - c.truth).squaredNorm();
    errors.mean += *found - c.truth;
  }
  errors.rms = std::sqrt(errors.rms / 20);
  errors.mean /= 20;
  return errors;
}

Errors fitted(const CornerLook& look, double length = 7) {
  return errorsOf(look, length, [&](const GrayImageView& image, const Case& c) {
    return fitCorner(image, {c.start, c.axes, 1}, look.lens);
  });
}

TEST(CornerFit, FindsACornerInAnyPositionAndDirection) {
  for (const double blur : {0.5, 0.8, 1.6}) EXPECT_LT(fitted({.blur_px = blur}).rms, 0.012) << blur;
}

TEST(CornerFit, LightThatChangesAcrossDoesNotMoveIt) {
  // A third across a board that fills the image's height. Light of slope c before the lens moves a
  // corner of blur b by b^2 c, here 0.001 px.
  EXPECT_LT(fitted({.light = {0.0015, 0.001}}).mean.norm(), 0.003);
}

TEST(CornerFit, InkThatGrowsDoesNotMoveIt) { EXPECT_LT(fitted({.ink_px = 0.3}).rms, 0.015); }

TEST(CornerFit, RefusesACornerBesideWhichACoverLies) {
  for (const Case& c : cases()) {
    const GrayImage image = drawCorner(c.truth, c.axes, {.cover_px = 1});
    EXPECT_FALSE(fitCorner(image.view(), {c.truth, c.axes, 1}, {}).has_value());
  }
}

TEST(CornerFit, RefusesAxesThatAreNotFinite) {
  const Case c = cases().front();
  const GrayImage image = drawCorner(c.truth, c.axes, {});
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    Eigen::Matrix2d axes = c.axes;
    axes(0, 1) = bad;
    EXPECT_FALSE(fitCorner(image.view(), {c.truth, axes, 1}, {}).has_value());
  }
  EXPECT_TRUE(fitCorner(image.view(), {c.truth, 1e200 * c.axes, 1}, {}).has_value());
}

// Edges bent as by a wide lens: 0.9 of a pixel at 30 px beside the corner.
TEST(CornerFit, StraightensWhatTheLensBends) {
  const CornerLook bent{.lens = {{-180, 300}, 446, {-0.45, 0.1, 0}}};
  EXPECT_LT(fitted(bent).mean.norm(), 0.002);
  const Errors taken_for_straight =
      errorsOf(bent, 7, [](const GrayImageView& image, const Case& c) {
        return fitCorner(image, {c.start, c.axes, 1}, {});
      });
  EXPECT_GT(taken_for_straight.mean.norm(), 0.004);
}

TEST(CornerFit, HasAboutHalfTheNoiseOfTheRefiner) {
  const CornerLook noisy{.noise_gray = 5};
  CornerRefiner refiner;
  const Errors refined = errorsOf(noisy, 5, [&](const GrayImageView& image, const Case& c) {
    return refiner.refine(image, {c.start, c.axes, 1});
  });
  EXPECT_LT(fitted(noisy, 5).rms, 0.6 * refined.rms);
}

TEST(CornerFit, DoesNotDependOnTheStart) {
  const Case c = cases().front();
  const GrayImage image = drawCorner(c.truth, c.axes, {});
  const auto reference = fitCorner(image.view(), {c.truth, c.axes, 1}, {});
  ASSERT_TRUE(reference.has_value());
  for (const Eigen::Vector2d& offset : {Eigen::Vector2d(0.3, 0.2), Eigen::Vector2d(-0.4, 0)}) {
    const auto found = fitCorner(image.view(), {c.truth + offset, c.axes, 1}, {});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - *reference).norm(), 0.005);
  }
}

TEST(CornerFit, RefusesWhatIsNoCorner) {
  const Eigen::Vector2d at(24, 21);
  const Eigen::Matrix2d axes = axesOf(0.2, 1.57, 7);
  EXPECT_FALSE(fitCorner(GrayImage(kWidth, kHeight, 90).view(), {at, axes, 1}, {}).has_value());
  GrayImage edge(kWidth, kHeight, 200);
  for (int y = 0; y < kHeight; ++y) std::fill(edge.row(y), edge.row(y) + 24, std::uint8_t{40});
  EXPECT_FALSE(fitCorner(edge.view(), {at, axes, 1}, {}).has_value());
}

TEST(CornerFit, RefusesACornerFurtherAwayThanAllowed) {
  const Case c = cases().front();
  const GrayImage image = drawCorner(c.truth, c.axes, {});
  const Eigen::Vector2d start = c.truth + Eigen::Vector2d(0.8, 0);
  EXPECT_TRUE(fitCorner(image.view(), {start, c.axes, 1}, {}).has_value());
  EXPECT_FALSE(fitCorner(image.view(), {start, c.axes, 0.5}, {}).has_value());
}

TEST(CornerFit, WindowsAtAndBeyondTheEdgeOfTheImageAreSafe) {
  const Eigen::Matrix2d axes = axesOf(0.5, 1.57, 30);
  const GrayImage image = drawCorner({2, 2}, axes, {});
  for (const Eigen::Vector2d& start : {Eigen::Vector2d(2, 2), Eigen::Vector2d(-40, 20),
                                       Eigen::Vector2d(47, 43), Eigen::Vector2d(1e6, -1e6)}) {
    const auto found = fitCorner(image.view(), {start, axes, 1}, {});
    EXPECT_TRUE(!found || (*found - start).norm() < 1.01);
  }
}

}  // namespace
}  // namespace plumbline

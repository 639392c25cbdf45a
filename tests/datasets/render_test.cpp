// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/render.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/image_formation.h"
#include "calibrator/simulate/printed_board.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/target/tag_family.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Intrinsics cameraOf(const std::string& rig) {
  return simulatedRig(rig).calibration.cameras[0].intrinsics;
}

/// A quarter of EuRoC's camera, for tests that need few pixels.
Intrinsics smallCamera() {
  Intrinsics camera = cameraOf("euroc");
  camera.resolution = {188, 120};
  camera.projection *= 0.25;
  return camera;
}

/// A camera that looks at the target's centre from `distance`, tilted by `tilt` [rad].
Transform viewOf(const AprilGrid& target, double distance, const Vector3d& tilt) {
  const Eigen::Matrix3d facing = Vector3d(1, -1, -1).asDiagonal();
  const Eigen::Matrix3d R = facing * expSO3(tilt);
  const Vector3d centre(0.5 * target.width(), 0.5 * target.height(), 0);
  return {R, centre - distance * R * Vector3d::UnitZ()};
}

RenderOptions plainOptions() {
  RenderOptions o;
  o.noise_sigma = 0;
  o.shading = 0;
  o.vignetting = 0;
  return o;
}

/// A point of a tag's left border on the board in F, by the quadratic along y through three corners
/// of the tag's column: a board's displacement is one.
Vector3d onLeftBorder(const AprilGrid& target, const std::vector<Vector3d>& corners, int tag,
                      double s) {
  const double y = target.corner(4 * tag).y() + s * target.tag_size;
  Vector3d p = Vector3d::Zero();
  for (const int i : {0, 2, 5}) {
    const int id = 4 * (i * target.cols + tag % target.cols);
    double share = 1;
    for (const int k : {0, 2, 5}) {
      if (k != i) share *= (y - target.pitch() * k) / (target.pitch() * (i - k));
    }
    p += share * corners[static_cast<std::size_t>(id)];
  }
  return p;
}

/// Where the left border of a tag crosses an image row, according to project() [px]; `s` in (0, 1)
/// is found along the border by bisection.
std::optional<double> predictedCrossing(const Intrinsics& camera, const Transform& T_CF,
                                        const AprilGrid& target, int tag, int row) {
  const std::vector<Vector3d> corners = cornerPoints(target);
  const auto at = [&](double s) {
    return project(camera, T_CF * onLeftBorder(target, corners, tag, s));
  };
  double low = 0.15;  // well between the corner squares
  double high = 0.85;
  if (!at(low) || !at(high) || at(low)->y() < row || at(high)->y() > row) return std::nullopt;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (at(middle)->y() > row ? low : high) = middle;
  }
  return at(low)->x();
}

/// Length of a tag's bottom edge in the image [px]; 0 where it is not in view.
double tagWidth(const Intrinsics& camera, const Transform& T_CF, const AprilGrid& target, int tag) {
  const Vector2d a = target.corner(4 * tag);
  const Vector2d b = target.corner(4 * tag + 1);
  const auto u = project(camera, T_CF * Vector3d(a.x(), a.y(), 0));
  const auto v = project(camera, T_CF * Vector3d(b.x(), b.y(), 0));
  return u && v ? (*u - *v).norm() : 0;
}

/// Position of a step from white (left) to black (right) near x: the first moment of the profile.
/// Exact for a straight edge whatever the (symmetric) blur.
double measuredCrossing(const GrayImage& image, double x, int row) {
  constexpr int kReach = 5;
  const int centre = static_cast<int>(std::lround(x));
  const double white = image.at(centre - kReach, row);
  const double black = image.at(centre + kReach, row);
  double sum = 0;
  for (int i = -kReach; i <= kReach; ++i) {
    sum += (image.at(centre + i, row) - black) / (white - black);
  }
  return centre - kReach - 0.5 + sum;
}

// Sampling to 1/64 pixel and rounding to grey levels leave a few thousandths of a pixel.
void expectEdgesWhereProjectSays(const AprilGrid& target) {
  for (const auto& [rig, distance] : {std::pair{"euroc", 0.6}, {"d435i", 0.5}, {"tumvi", 0.25}}) {
    SCOPED_TRACE(rig);
    const Intrinsics camera = cameraOf(rig);
    const TargetRenderer renderer(camera, target, plainOptions());
    const Transform T_FC = viewOf(target, distance, {0.1, -0.15, 0.07});
    const GrayImage image = renderer.render(T_FC, 0);
    double sum = 0, sum2 = 0, worst = 0;
    int count = 0;
    for (int tag = 0; tag < target.tagCount(); ++tag) {
      if (tagWidth(camera, T_FC.inverse(), target, tag) < 45) continue;  // border of 9 px
      for (int row = 0; row < image.height(); ++row) {
        const auto x = predictedCrossing(camera, T_FC.inverse(), target, tag, row);
        if (!x || *x < 8 || *x > image.width() - 9) continue;
        const double error = measuredCrossing(image, *x, row) - *x;
        sum += error;
        sum2 += error * error;
        worst = std::max(worst, std::abs(error));
        ++count;
      }
    }
    ASSERT_GT(count, 300);
    EXPECT_LE(std::abs(sum / count), 0.001);
    EXPECT_LE(std::sqrt(sum2 / count), 0.01);
    EXPECT_LE(worst, 0.05);
  }
}

TEST(TargetRenderer, EdgesAreWhereProjectSays) { expectEdgesWhereProjectSays({}); }

// A flat renderer would be off by several pixels.
TEST(TargetRenderer, EdgesOfABentBoardAreWhereProjectSays) {
  AprilGrid bent;
  bent.shape.terms << 3e-3, -1e-3, 1e-3, -2e-3, 5e-4, 1e-3, 2e-3, -1e-3, 3e-3, -2e-3, 2e-3, 0;
  expectEdgesWhereProjectSays(bent);
}

TEST(BoardSurface, HasTheShapeAtTheCornersAndNoTagEdge) {
  AprilGrid bent;
  bent.shape.terms << 3e-3, -1e-3, 1e-3, -2e-3, 5e-4, 1e-3, 2e-3, -1e-3, 3e-3, -2e-3, 2e-3, 0;
  const std::vector<Vector3d> corners = cornerPoints(bent);
  bent.shape.terms[kTargetTerms - 1] = 1e-3;
  const BoardSurface surface(bent);
  for (int id = 0; id < bent.cornerCount(); ++id) {
    const Vector2d p = bent.corner(id);
    const Vector3d moved =
        Vector3d(p.x(), p.y(), 0) + surface.displacement(p.cast<float>()).cast<double>();
    EXPECT_LT((moved - corners[static_cast<std::size_t>(id)]).norm(), 1e-8);
  }
  bent.shape.terms.head<kTargetTerms - 1>().setZero();
  EXPECT_TRUE(BoardSurface(bent).isFlat());
}

TEST(TargetRenderer, CellsShowTheTagFamilyAndTheCornerSquares) {
  AprilGrid target;
  target.rows = 2;
  target.cols = 3;
  const Intrinsics camera = cameraOf("euroc");
  const Transform T_FC = viewOf(target, 0.4, {0.05, 0.1, 0.3});
  const GrayImage image = TargetRenderer(camera, target, plainOptions()).render(T_FC, 0);
  const double step = target.tag_size / tagCells(kKalibrBorderBits);
  const int first = -3;  // the corner squares are three cells wide
  int black = 0, compared = 0;
  for (int i = first; i < 3 * 13; ++i) {
    for (int j = first; j < 2 * 13; ++j) {
      const Vector2d p((i + 0.5) * step, (j + 0.5) * step);
      const auto uv = project(camera, T_FC.inverse() * Vector3d(p.x(), p.y(), 0));
      if (!uv || uv->minCoeff() < 0 || uv->x() > 751 || uv->y() > 479) continue;
      const int grey =
          image.at(static_cast<int>(std::lround(uv->x())), static_cast<int>(std::lround(uv->y())));
      ASSERT_EQ(grey < 120, gridIsBlack(target, p)) << "cell " << i << ", " << j;
      black += grey < 120;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(black, compared / 3);
}

TEST(TargetRenderer, WallSurroundsThePaper) {
  const AprilGrid target;
  const Transform T_FC = viewOf(target, 3.0, Vector3d::Zero());
  const TargetRenderer renderer(smallCamera(), target, plainOptions());
  const GrayImage image = renderer.render(T_FC, 0);
  EXPECT_EQ(image.at(2, 2), 105);
  EXPECT_EQ(image.at(185, 117), 105);
  EXPECT_LT(image.at(92, 62), 200);  // the target, too far away to resolve
  const GrayImage wall = renderer.render({T_FC.R, {0.3, 0.3, -1}}, 0);
  EXPECT_EQ(wall.at(94, 60), 105);
  // The lens darkens the wall's back as it does all else.
  RenderOptions dark_corners = plainOptions();
  dark_corners.vignetting = 0.4;
  const TargetRenderer vignetting(smallCamera(), target, dark_corners);
  const GrayImage back = vignetting.render({T_FC.R, {0.3, 0.3, -1}}, 0);
  EXPECT_LT(back.at(0, 0), 0.7 * back.at(94, 60));
}

TEST(TargetRenderer, SameNumberSameNoise) {
  const AprilGrid target;
  const Transform T_FC = viewOf(target, 0.8, Vector3d::Zero());
  const TargetRenderer renderer(smallCamera(), target);
  const auto bytes = [&](std::uint64_t number) {
    const GrayImage image = renderer.render(T_FC, number);
    return std::vector<std::uint8_t>(image.data(), image.data() + 188 * 120);
  };
  EXPECT_EQ(bytes(3), bytes(3));
  EXPECT_NE(bytes(3), bytes(4));
}

TEST(TargetRenderer, RefusesMoreTagsThanTheFamilyHas) {
  AprilGrid target;
  target.rows = target.cols = 25;
  EXPECT_THROW(TargetRenderer(smallCamera(), target), InputError);
  RenderOptions options;
  options.blur_sigma_px = -1;
  EXPECT_THROW(TargetRenderer(smallCamera(), AprilGrid{}, options), InputError);
}

TEST(RenderSensor, BlurSpreadsAPointByItsSigma) {
  constexpr int kSize = 41;
  std::vector<float> light(kSize * kSize, 0.0F);
  light[20 * kSize + 20] = 1000;
  const std::vector<float> out = gaussianBlur(light, kSize, kSize, 1.5);
  double sum = 0, xx = 0, yy = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double value = out[static_cast<std::size_t>(y * kSize + x)];
      sum += value;
      xx += value * (x - 20) * (x - 20);
      yy += value * (y - 20) * (y - 20);
    }
  }
  EXPECT_NEAR(sum, 1000, 1e-2);
  EXPECT_NEAR(xx / sum, 2.25, 0.01);  // a little less than sigma^2: the kernel ends at 4 sigma
  EXPECT_NEAR(yy / sum, 2.25, 0.01);
}

// Bounds: 5 standard errors; rounding adds 1/12 to the variance.
TEST(RenderSensor, NoiseHasTheStatedSigma) {
  constexpr int kSize = 300;
  const std::vector<float> light(kSize * kSize, 100.3F);
  const GrayImage image = exposeSensor(light, kSize, kSize, 3.0, 1, 0);
  double sum = 0, sum2 = 0;
  for (int i = 0; i < kSize * kSize; ++i) {
    const double value = image.data()[i];
    sum += value;
    sum2 += value * value;
  }
  const double n = kSize * kSize;
  const double variance = sum2 / n - sum * sum / n / n;
  EXPECT_NEAR(sum / n, 100.3, 5 * 3 / std::sqrt(n));
  EXPECT_NEAR(variance, 9 + 1.0 / 12, 5 * 9 * std::sqrt(2 / n));
}

}  // namespace
}  // namespace plumbline

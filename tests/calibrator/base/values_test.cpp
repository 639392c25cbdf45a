// SPDX-License-Identifier: BSD-3-Clause
// Small values: the target's geometry, times, names, errors.
#include <cmath>
#include <stdexcept>
#include <variant>

#include <gtest/gtest.h>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/image.h"
#include "calibrator/base/time.h"

namespace plumbline {
namespace {

TEST(AprilGrid, CornersGoRoundATagFromBottomLeft) {
  const AprilGrid grid;  // 6 x 6, 88 mm, spacing 0.3: 114.4 mm from tag to tag
  EXPECT_TRUE(grid.corner(0).isApprox(Eigen::Vector2d(0, 0)));
  EXPECT_TRUE(grid.corner(1).isApprox(Eigen::Vector2d(0.088, 0)));
  EXPECT_TRUE(grid.corner(2).isApprox(Eigen::Vector2d(0.088, 0.088)));
  EXPECT_TRUE(grid.corner(3).isApprox(Eigen::Vector2d(0, 0.088)));
}

TEST(AprilGrid, TagsRunAlongXFirst) {
  const AprilGrid grid{.rows = 3, .cols = 5, .tag_size = 0.1, .spacing = 0.2};
  EXPECT_EQ(grid.cornerCount(), 60);
  EXPECT_TRUE(grid.corner(4 * 4).isApprox(Eigen::Vector2d(0.48, 0)));
  EXPECT_TRUE(grid.corner(4 * 5).isApprox(Eigen::Vector2d(0, 0.12)));
  EXPECT_TRUE(grid.corner(4 * 14 + 2).isApprox(Eigen::Vector2d(grid.width(), grid.height())));
  EXPECT_NEAR(grid.width(), 0.58, 1e-15);
  EXPECT_NEAR(grid.height(), 0.34, 1e-15);
}

TEST(Time, DifferencesAreTakenOnIntegers) {
  const TimeNs epoch = 1'700'000'000'000'000'000;
  EXPECT_EQ(secondsBetween(epoch, epoch + 1), 1e-9);
  EXPECT_EQ(secondsBetween(epoch + 5'000'000, epoch), -5e-3);
  EXPECT_EQ(toNanoseconds(-0.00321), -3'210'000);
  EXPECT_EQ(toNanoseconds(1.4e-9), 1);
}

TEST(Names, OfModelsReadBackAndAcceptOtherTools) {
  for (auto model : {ProjectionModel::kPinhole, ProjectionModel::kOmni, ProjectionModel::kEucm,
                     ProjectionModel::kDs}) {
    EXPECT_EQ(projectionModelFrom(toString(model)), model);
  }
  for (auto model : {DistortionModel::kNone, DistortionModel::kRadtan,
                     DistortionModel::kEquidistant, DistortionModel::kFov}) {
    EXPECT_EQ(distortionModelFrom(toString(model)), model);
  }
  EXPECT_EQ(distortionModelFrom("radial-tangential"), DistortionModel::kRadtan);
  EXPECT_EQ(distortionModelFrom("equi"), DistortionModel::kEquidistant);
  EXPECT_EQ(distortionModelFrom("Radtan"), std::nullopt);
  EXPECT_EQ(projectionModelFrom(""), std::nullopt);
}

TEST(Intrinsics, StackProjectionBeforeDistortion) {
  Intrinsics camera;
  camera.projection = Eigen::Vector4d(1, 2, 3, 4);
  camera.distortion = Eigen::Vector4d(5, 6, 7, 8);
  Eigen::VectorXd all(8);
  all << 1, 2, 3, 4, 5, 6, 7, 8;
  EXPECT_EQ(camera.stacked(), all);
  camera.setStacked(2 * all);
  EXPECT_EQ(camera.projection, Eigen::Vector4d(2, 4, 6, 8));
  EXPECT_EQ(camera.distortion, Eigen::Vector4d(10, 12, 14, 16));
}

TEST(InputError, NamesFileAndLine) {
  const InputError at_line("imu0/data.csv", 17, "stamp goes back");
  EXPECT_STREQ(at_line.what(), "imu0/data.csv:17: stamp goes back");
  EXPECT_EQ(at_line.path(), "imu0/data.csv");
  EXPECT_EQ(at_line.line(), 17);
  EXPECT_STREQ(InputError("imu0/data.csv", 0, "is empty").what(), "imu0/data.csv: is empty");
  EXPECT_STREQ(InputError("unknown option").what(), "unknown option");
  EXPECT_EQ(InputError("unknown option").line(), 0);
}

TEST(Result, HoldsAValueOrAFailure) {
  const Result<int> good = 3;
  EXPECT_TRUE(good.ok());
  EXPECT_EQ(*good, 3);
  const Result<int> bad = Failure{FailureCode::kTooFewViews, {{"views", 2}, {"camera", "cam1"}}};
  EXPECT_FALSE(bad);
  EXPECT_EQ(bad.failure().code, FailureCode::kTooFewViews);
  EXPECT_EQ(bad.failure().reason(), FailureReason::kTooFewViews);
  EXPECT_EQ(bad.failure().number("views"), 2);
  EXPECT_TRUE(std::isnan(bad.failure().number("camera")));
  EXPECT_EQ(toString(bad.failure()), "TooFewViews (camera cam1, views 2)");
  EXPECT_THROW((void)bad.value(), std::bad_variant_access);
  EXPECT_THROW((void)good.failure(), std::bad_variant_access);
}

TEST(GrayImage, RowsFollowEachOther) {
  GrayImage image(3, 2, std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6});
  EXPECT_EQ(image.at(2, 1), 6);
  image.at(0, 1) = 40;
  const GrayImageView view = image.view();
  EXPECT_EQ(view.at(0, 1), 40);
  EXPECT_EQ(view.stride, 3);
  EXPECT_TRUE(view.contains(2, 1));
  EXPECT_FALSE(view.contains(3, 1));
  EXPECT_FALSE(view.contains(0, -1));
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/candidate_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

const AprilGrid kTarget;

std::vector<CameraCalibration> camerasOf(const std::string& rig) {
  return simulatedRig(rig).calibration.cameras;
}

Eigen::Vector3d centre() { return {0.5 * kTarget.width(), 0.5 * kTarget.height(), 0}; }

const CandidateView& named(const std::vector<CandidateView>& views, const std::string& name) {
  const auto at = std::find_if(views.begin(), views.end(),
                               [&](const CandidateView& v) { return v.name == name; });
  EXPECT_NE(at, views.end()) << name;
  return *at;
}

TEST(CandidateViews, AreAHundredPerCameraWithNamesOfTheirOwn) {
  const auto views = candidateViews(camerasOf("euroc"), kTarget);
  EXPECT_EQ(views.size(), 200u);
  std::set<std::string> names;
  for (const CandidateView& view : views) names.insert(view.name);
  EXPECT_EQ(names.size(), views.size());
  EXPECT_EQ(std::count_if(views.begin(), views.end(),
                          [](const CandidateView& v) { return v.camera == 0; }),
            100);
}

TEST(CandidateViews, LookAtTheCentreFromBeforeTheTarget) {
  for (const char* rig : {"euroc", "tumvi", "d435i"}) {
    const auto cameras = camerasOf(rig);
    for (const CandidateView& view : candidateViews(cameras, kTarget)) {
      const Transform T_FCi = view.T_FC0 * cameras[static_cast<std::size_t>(view.camera)].T_C0Ci;
      const Eigen::Vector3d p = T_FCi.inverse() * centre();
      EXPECT_LT(p.head<2>().norm(), 1e-12) << view.name;
      EXPECT_GT(p.z(), 0) << view.name;
      EXPECT_GT(T_FCi.t.z(), 0.1) << view.name;
      EXPECT_NEAR(T_FCi.R.determinant(), 1, 1e-12);
    }
  }
}

TEST(CandidateViews, TargetFillsItsShareOfTheImage) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const auto cameras = camerasOf(rig);
    CandidateViewOptions options;
    options.grid = 1;
    options.fill = 0.5;
    const auto views = candidateViews(cameras, kTarget, options);
    const Transform T_CF = named(views, "cam0 x +0.00 y +0.00").T_FC0.inverse();
    const Intrinsics& camera = cameras[0].intrinsics;
    const Eigen::Vector3d side = centre() + Eigen::Vector3d(0.5 * kTarget.width(), 0, 0);
    const auto uv = project(camera, T_CF * side);
    ASSERT_TRUE(uv.has_value());
    const Eigen::Vector2d from = *uv - camera.projection.tail<2>();
    EXPECT_NEAR(from.x(), 0.5 * 0.5 * camera.resolution.width, 1.5) << rig;  // x right, y up in F
    EXPECT_NEAR(from.y(), 0, 1.0) << rig;  // but for what the lens does sideways
  }
}

TEST(CandidateViews, ATallTargetFillsTheImageByItsHeight) {
  const auto cameras = camerasOf("euroc");
  const AprilGrid wide{.rows = 4, .cols = 7}, tall{.rows = 7, .cols = 4};
  EXPECT_DOUBLE_EQ(candidateViews(cameras, tall).front().T_FC0.t.z(),
                   candidateViews(cameras, wide).front().T_FC0.t.z());
}

TEST(CandidateViews, AreNotInTheTargetsPlane) {
  CandidateViewOptions options;
  options.tilts_deg = {90};
  EXPECT_THROW(candidateViews(camerasOf("euroc"), kTarget, options), InputError);
}

TEST(CandidateViews, AreWhereTheirNamesSay) {
  const auto views = candidateViews(camerasOf("euroc"), kTarget);
  const double half = 0.5 * kTarget.width();
  const Transform corner = named(views, "cam0 x -1.60 y +1.60").T_FC0;
  EXPECT_NEAR(corner.t.x(), centre().x() - 1.6 * half, 1e-12);
  EXPECT_NEAR(corner.t.y(), centre().y() + 1.6 * half, 1e-12);
  const double depth = corner.t.z();
  const Transform near = named(views, "cam0 x +0.00 y +0.00 depth 0.75").T_FC0;
  EXPECT_NEAR(near.t.z(), 0.75 * depth, 1e-12);
  const Transform tilted = named(views, "cam0 tilt-y +45").T_FC0;
  const Eigen::Vector3d sight = centre() - tilted.t;
  EXPECT_NEAR(sight.norm(), depth, 1e-12);
  EXPECT_NEAR(sight.x(), -depth * std::sin(std::numbers::pi / 4), 1e-12);
  const Transform rolled = named(views, "cam0 tilt-y +45 roll 90").T_FC0;
  EXPECT_LT((rolled.t - tilted.t).norm(), 1e-12);
  EXPECT_LT((rolled.R.col(0) - tilted.R.col(1)).norm(), 1e-12);
  EXPECT_LT((rolled.R.col(2) - tilted.R.col(2)).norm(), 1e-12);
}

TEST(CandidateViews, TheFirstAreNearAndTiltedToEachSide) {
  const CameraCalibration camera = camerasOf("euroc").front();
  const double depth = named(candidateViews({camera}, kTarget), "cam0 tilt-y +45").T_FC0.t.z() /
                       std::cos(std::numbers::pi / 4);
  const auto views = firstViews(camera, kTarget);
  ASSERT_EQ(views.size(), 4u);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CandidateView& view : views) {
    const Eigen::Vector3d offset = view.T_FC0.t - centre();
    EXPECT_NEAR(offset.norm(), 0.75 * depth, 1e-12) << view.name;
    EXPECT_NEAR(offset.z(), offset.norm() * std::cos(std::numbers::pi / 4), 1e-12) << view.name;
    EXPECT_GE(visibleCorners(camera.intrinsics, view.T_FC0, {}).size(), 40u) << view.name;
    sum += offset;
  }
  EXPECT_LT(sum.head<2>().norm(), 1e-12);
}

TEST(CandidateViews, ShowEnoughOfTheTarget) {
  for (const char* rig : {"euroc", "tumvi", "d435i"}) {
    const auto cameras = camerasOf(rig);
    const auto views = candidateViews(cameras, kTarget);
    const auto seen = std::count_if(views.begin(), views.end(), [&](const CandidateView& view) {
      const CameraCalibration& camera = cameras[static_cast<std::size_t>(view.camera)];
      return visibleCorners(camera.intrinsics, view.T_FC0 * camera.T_C0Ci, {}).size() >= 40;
    });
    EXPECT_GT(seen, 190) << rig;
  }
}

}  // namespace
}  // namespace plumbline

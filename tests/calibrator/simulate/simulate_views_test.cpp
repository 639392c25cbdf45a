// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulationOptions exactOptions() {
  SimulationOptions o;
  o.duration_s = 10;
  o.imu_rate_hz = 50;
  o.corner_sigma_px = 0;
  return o;
}

/// All corners of a session by (camera, stamp, id).
using CornerMap = std::map<std::tuple<int, TimeNs, int>, Eigen::Vector2d>;

CornerMap cornersOf(const SimulatedSession& s) {
  CornerMap all;
  for (int i = 0; i < static_cast<int>(s.session.cameras.size()); ++i) {
    for (const ImageView& view : s.session.cameras[static_cast<std::size_t>(i)].views) {
      for (const Corner& c : view.corners) all[{i, view.t, c.id}] = c.uv;
    }
  }
  return all;
}

TEST(SimulateViews, NoiseFreeCornersAreTheTruthProjected) {
  for (const std::string& name : simulatedRigNames()) {
    const SimulatedSession s = simulateSession(simulatedRig(name), exactOptions());
    const CornerMap corners = cornersOf(s);
    EXPECT_GT(corners.size(), 20000U) << name;
    for (const auto& [key, uv] : corners) {
      const auto& [camera, t, id] = key;
      const Eigen::Vector2d p = s.session.target.corner(id);
      const Transform T_CF = s.cameraPose(camera, t).inverse();
      const auto expected = project(s.truth.cameras[static_cast<std::size_t>(camera)].intrinsics,
                                    T_CF * Eigen::Vector3d(p.x(), p.y(), 0));
      ASSERT_TRUE(expected.has_value());
      ASSERT_LE((*expected - uv).norm(), 1e-10) << name;
    }
  }
}

// t_imu = t_cam + t_d: with the offset raised by dt, the same stamp shows what it showed dt later.
TEST(SimulateViews, TimeOffsetHasKalibrsSign) {
  SimulationOptions o = exactOptions();
  o.time_offset_s = 0;
  const CornerMap without = cornersOf(simulateSession(simulatedRig("euroc"), o));
  o.time_offset_s = 0.05;  // one frame at 20 Hz
  const CornerMap with = cornersOf(simulateSession(simulatedRig("euroc"), o));
  int compared = 0;
  for (const auto& [key, uv] : with) {
    const auto& [camera, t, id] = key;
    const auto later = without.find({camera, t + 50'000'000, id});
    if (later == without.end()) continue;
    ASSERT_LE((later->second - uv).norm(), 1e-9);
    ++compared;
  }
  EXPECT_GT(compared, 10000);
}

TEST(SimulateViews, WholeTagsInsideTheBorderAndOfReadableSize) {
  SimulationOptions o = exactOptions();
  o.border_px = 12;
  o.min_tag_px = 25;
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), o);
  for (const CameraStream& camera : s.session.cameras) {
    for (const ImageView& view : camera.views) {
      ASSERT_EQ(view.corners.size() % 4, 0U);
      for (std::size_t i = 0; i < view.corners.size(); ++i) {
        const Corner& c = view.corners[i];
        ASSERT_EQ(c.id % 4, static_cast<int>(i % 4));
        ASSERT_TRUE(i == 0 || view.corners[i - 1].id < c.id);
        ASSERT_TRUE(c.uv.x() >= 12 && c.uv.y() >= 12 && c.uv.x() <= 739 && c.uv.y() <= 467);
        const Corner& next = view.corners[i % 4 == 3 ? i - 3 : i + 1];
        ASSERT_GE((next.uv - c.uv).norm(), 25);
      }
    }
  }
}

TEST(SimulateViews, CameraBehindTheTargetSeesNothing) {
  const SimulationOptions o;
  const Intrinsics camera = simulatedRig("euroc").calibration.cameras[0].intrinsics;
  const Eigen::Vector3d centre(0.33, 0.33, 0);
  const Transform in_front(Eigen::Matrix3d(Eigen::Vector3d(1, -1, -1).asDiagonal()),
                           centre + Eigen::Vector3d(0, 0, 1));
  const Transform behind(Eigen::Matrix3d::Identity(), centre - Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(visibleCorners(camera, in_front, o).size(), 144U);
  EXPECT_TRUE(visibleCorners(camera, behind, o).empty());
}

// n squared standard normals sum up to n +- sqrt(2 n) (chi-square); the bounds are 4 of those.
TEST(SimulateViews, CornerNoiseHasTheStatedSigma) {
  SimulationOptions o = exactOptions();
  const CornerMap exact = cornersOf(simulateSession(simulatedRig("euroc"), o));
  o.corner_sigma_px = 0.3;
  const CornerMap noisy = cornersOf(simulateSession(simulatedRig("euroc"), o));
  ASSERT_EQ(exact.size(), noisy.size());
  double sum2 = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double cross = 0;
  for (const auto& [key, uv] : noisy) {
    const Eigen::Vector2d n = (uv - exact.at(key)) / 0.3;
    sum += n;
    sum2 += n.squaredNorm();
    cross += n.x() * n.y();
  }
  const auto count = static_cast<double>(noisy.size());
  EXPECT_NEAR(sum2, 2 * count, 4 * std::sqrt(4 * count));
  EXPECT_LE(sum.cwiseAbs().maxCoeff(), 4 * std::sqrt(count));
  EXPECT_LE(std::abs(cross), 4 * std::sqrt(count));
}

TEST(SimulateViews, OutliersAreAsManyAndAsFarAsStated) {
  SimulationOptions o = exactOptions();
  const CornerMap exact = cornersOf(simulateSession(simulatedRig("euroc"), o));
  o.outlier_fraction = 0.05;
  o.outlier_px = 8;
  const CornerMap disturbed = cornersOf(simulateSession(simulatedRig("euroc"), o));
  int outliers = 0;
  for (const auto& [key, uv] : disturbed) {
    const double distance = (uv - exact.at(key)).norm();
    if (distance == 0) continue;
    ++outliers;
    ASSERT_LE(distance, 12 + 1e-9);
    ASSERT_GE(distance, 2);  // 4 where the image's border, 5 px away, does not stop it
  }
  const auto n = static_cast<double>(disturbed.size());
  EXPECT_NEAR(outliers, 0.05 * n, 4 * std::sqrt(n * 0.05 * 0.95));
}

TEST(SimulateViews, NoCornerLiesOutsideTheImage) {
  SimulationOptions o = exactOptions();
  o.corner_sigma_px = 3;
  o.border_px = 0;
  o.outlier_fraction = 0.2;
  o.outlier_px = 60;
  for (const auto& [key, uv] : cornersOf(simulateSession(simulatedRig("euroc"), o))) {
    ASSERT_TRUE(uv.x() >= 0 && uv.y() >= 0 && uv.x() <= 751 && uv.y() <= 479) << uv.transpose();
  }
}

}  // namespace
}  // namespace plumbline

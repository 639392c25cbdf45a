// SPDX-License-Identifier: BSD-3-Clause
// Repeated views, tags out of place, false and grazing corners are found where they are, and what
// looks like them is not. Not proven here: what they do to a calibration.
#include "calibrator/initialise/view_screening.h"

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulatedSession recorded(double duration_s, const char* rig = "euroc") {
  SimulationOptions options;
  options.duration_s = duration_s;
  return simulateSession(simulatedRig(rig), options);
}

TEST(RepeatedViews, NeedAWitnessThatSomethingMoved) {
  Session session = recorded(2).session;
  EXPECT_TRUE(repeatedViews(session)[0].empty());
  session.cameras[0].views[11].corners = session.cameras[0].views[10].corners;
  EXPECT_EQ(repeatedViews(session)[0], std::vector<int>{11});
  EXPECT_TRUE(repeatedViews(session)[1].empty());
  Session without_imu = session;
  without_imu.imu.reset();
  EXPECT_EQ(repeatedViews(without_imu)[0], std::vector<int>{11});  // the other camera changed
  without_imu.cameras.resize(1);
  EXPECT_TRUE(repeatedViews(without_imu)[0].empty());
}

/// How often a single camera is said to have repeated a view, the gyroscope turning at a rate.
std::size_t repeatedUnder(Session session, double rate_rad_s) {
  session.cameras.resize(1);
  auto& views = session.cameras[0].views;
  views[11].corners = views[10].corners;
  for (ImuSample& s : session.imu->samples) s.gyro << 0, rate_rad_s, 0;
  return repeatedViews(session)[0].size();
}

TEST(RepeatedViews, TheGyroscopeIsAWitnessByTheAngleItTurned) {
  const Session session = recorded(2).session;
  const auto& views = session.cameras[0].views;
  const double interval = secondsBetween(views[10].t, views[11].t);
  EXPECT_EQ(repeatedUnder(session, 0.004 / interval), 0U);  // 5 mrad are needed
  EXPECT_EQ(repeatedUnder(session, 0.006 / interval), 1U);
}

TEST(RepeatedViews, AnotherCameraIsAWitnessWithin5Milliseconds) {
  Session session = recorded(2).session;
  session.imu.reset();
  session.cameras[0].views[11].corners = session.cameras[0].views[10].corners;
  for (const int shift_ms : {-8, -3, 3, 8}) {
    Session shifted = session;
    for (ImageView& view : shifted.cameras[1].views) view.t += shift_ms * 1'000'000;
    EXPECT_EQ(repeatedViews(shifted)[0].size(), std::abs(shift_ms) < 5 ? 1U : 0U) << shift_ms;
  }
}

TEST(RepeatedViews, ThreeCornersTellNothing) {
  Session session = recorded(2).session;
  for (const std::size_t count : {3U, 4U}) {
    auto& views = session.cameras[0].views;
    views[10].corners.resize(count);
    views[11].corners = views[10].corners;
    EXPECT_EQ(repeatedViews(session)[0].size(), count < 4 ? 0U : 1U);
    session = recorded(2).session;
  }
}

struct View {
  AprilGrid target;
  Intrinsics lens;
  Transform T_CF;
  std::vector<ImageView> views;
};

View viewOfBoard() {
  const SimulatedSession s = recorded(1);
  View v{s.session.target, s.truth.cameras[0].intrinsics, {}, {s.session.cameras[0].views[5]}};
  v.T_CF = s.cameraPose(0, v.views[0].t).inverse();
  return v;
}

TEST(MisplacedTags, AreFoundWithTheirPlace) {
  View v = viewOfBoard();
  const PackedCorners clean(v.target, v.views);
  EXPECT_TRUE(findMisplacedTags(v.target, v.lens, clean.view(0), v.T_CF).empty());
  std::vector<Corner>& corners = v.views[0].corners;
  const int a = corners.front().id / 4;
  const int b = corners.back().id / 4;
  ASSERT_NE(a, b);
  for (std::size_t k = 0; k < 4; ++k) {
    std::swap(corners[k].uv, corners[corners.size() - 4 + k].uv);
  }
  const PackedCorners swapped(v.target, v.views);
  const auto found = findMisplacedTags(v.target, v.lens, swapped.view(0), v.T_CF);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].tag, a);
  EXPECT_EQ(found[0].place, b);
  EXPECT_EQ(found[1].tag, b);
  EXPECT_EQ(found[1].place, a);
  // Under a pose that is wrong for the whole view nothing is said of single tags.
  Transform far = v.T_CF;
  far.t.x() += 0.3;
  EXPECT_TRUE(findMisplacedTags(v.target, v.lens, clean.view(0), far).empty());
}

// A tag that was put up crookedly stands in nobody's place.
TEST(MisplacedTags, StandInTheirNewPlaceToAQuarterOfASide) {
  for (const double way : {0.58, 0.9}) {  // to the next tag, which is 1.3 sides away
    View v = viewOfBoard();
    std::vector<Corner>& corners = v.views[0].corners;
    const int tag = corners[8].id / 4;
    ASSERT_NE(tag % v.target.cols, v.target.cols - 1);
    for (Corner& corner : corners) {
      if (corner.id / 4 != tag) continue;
      const Eigen::Vector2d next = v.target.corner(corner.id + 4);
      const auto uv = project(v.lens, v.T_CF * Eigen::Vector3d(next.x(), next.y(), 0));
      corner.uv += way * (uv.value() - corner.uv);
    }
    const PackedCorners packed(v.target, v.views);
    const auto found = findMisplacedTags(v.target, v.lens, packed.view(0), v.T_CF);
    ASSERT_EQ(found.size(), way < 0.75 ? 0U : 1U);
    if (!found.empty()) EXPECT_EQ(found[0].place, tag + 1);
  }
}

TEST(GrazingCorners, AreThoseBeyondTheAngle) {
  const View v = viewOfBoard();
  const PackedCorners packed(v.target, v.views);
  EXPECT_TRUE(beyondAngle(packed.view(0), v.T_CF, kGrazing).empty());
  Transform grazing;  // the board's plane through the camera, along the optical axis
  grazing.R << 0, 0, 1, 0, 1, 0, 1, 0, 0;
  grazing.t << 0.1, 0, -0.3;
  for (const int k : beyondAngle(packed.view(0), grazing, kGrazing)) {
    const Eigen::Vector3d p =
        grazing * Eigen::Vector3d(packed.view(0).x[k], packed.view(0).y[k], 0);
    EXPECT_LT(p.z() / p.norm(), std::cos(kGrazing));
  }
  EXPECT_FALSE(beyondAngle(packed.view(0), grazing, kGrazing).empty());
}

TEST(FalseCorners, AreFound) {
  View v = viewOfBoard();
  EXPECT_TRUE(falseCorners(v.lens, PackedCorners(v.target, v.views).view(0), v.T_CF).empty());
  v.views[0].corners[3].uv.x() += 5;
  v.views[0].corners[9].uv.y() -= 12;
  EXPECT_EQ(falseCorners(v.lens, PackedCorners(v.target, v.views).view(0), v.T_CF).size(), 2U);
}

/// A view whose corners are all off by so much that noise of `sigma` px on either axis would leave
/// the same median: sqrt(2 ln 2) sigma.
View viewWithNoise(double sigma) {
  View v = viewOfBoard();
  for (std::size_t k = 0; k < v.views[0].corners.size(); ++k) {
    Corner& corner = v.views[0].corners[k];
    const Eigen::Vector2d p = v.target.corner(corner.id);
    const auto angle = static_cast<double>(k);
    corner.uv =
        project(v.lens, v.T_CF * Eigen::Vector3d(p.x(), p.y(), 0)).value() +
        std::sqrt(2 * std::log(2)) * sigma * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return v;
}

/// Moves a corner to `px` from where it would be without noise.
void putOff(Corner& corner, const View& v, double px) {
  const Eigen::Vector2d p = v.target.corner(corner.id);
  corner.uv =
      project(v.lens, v.T_CF * Eigen::Vector3d(p.x(), p.y(), 0)).value() + Eigen::Vector2d(0, px);
}

TEST(FalseCorners, AreOffBy8DeviationsOfTheirViewAndBy3Pixels) {
  const struct {
    double sigma, off;
    std::size_t found;
  } kCases[] = {{1, 7.8, 0}, {1, 8.2, 1}, {2, 15.6, 0}, {2, 16.4, 1}, {0.1, 2.9, 0}, {0.1, 3.1, 1}};
  for (const auto& c : kCases) {
    View v = viewWithNoise(c.sigma);
    putOff(v.views[0].corners[5], v, c.off);
    const PackedCorners packed(v.target, v.views);
    EXPECT_EQ(falseCorners(v.lens, packed.view(0), v.T_CF).size(), c.found) << c.off;
  }
}

// However many have been, and however far off they are.
TEST(FalseCorners, ThoseThatAreRejectedAlreadyHaveNoSay) {
  View v = viewWithNoise(1);
  const auto count = static_cast<int>(v.views[0].corners.size());
  for (std::size_t k = 10; k < v.views[0].corners.size(); ++k) {
    putOff(v.views[0].corners[k], v, 100);
  }
  putOff(v.views[0].corners[5], v, 9);
  PackedCorners packed(v.target, v.views);
  for (int k = 10; k < count; ++k) packed.setWeight(0, k, 0);
  EXPECT_EQ(falseCorners(v.lens, packed.view(0), v.T_CF), std::vector<int>{5});
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Each fault of cameras, target and frames is found again in the corners by a formula of its own.
#include "calibrator/simulate/faults/view_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "tests/calibrator/simulate/fault_recordings.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::CornersById;
using test::cornersById;
using test::soundRecording;
using test::withFaults;
using enum FaultKind;

const SimulatedSession& cleanRecording() {
  static const SimulatedSession session = withFaults(soundRecording(), {});
  return session;
}

/// Where camera `camera` sees p_F at the trajectory's time t_s, by the nominal calibration.
Vector2d projectedAt(const SimulatedSession& s, int camera, const Vector3d& p_F, double t_s) {
  const CameraCalibration& c = s.truth.cameras[static_cast<std::size_t>(camera)];
  const Transform T_FC = s.trajectory.at(t_s).T_FB * s.truth.imu->T_SC0 * c.T_C0Ci;
  return project(c.intrinsics, T_FC.inverse() * p_F).value();
}

Vector3d nominalCorner(const SimulatedSession& s, int id) {
  const Vector2d p = s.session.target.corner(id);
  return {p.x(), p.y(), 0};
}

/// The trajectory's time of a camera stamp.
double timeOf(const SimulatedSession& s, TimeNs t_cam) {
  return secondsBetween(s.start_ns, t_cam) + s.truth.imu->timeOffset();
}

/// Calls expect(camera, t_s, id, uv) for every corner; the least number of them is demanded.
template <class Expect>
void forEachCorner(const SimulatedSession& s, const Expect& expect) {
  const CornersById corners = cornersById(s);
  ASSERT_GT(corners.size(), 5000U);
  for (const auto& [key, uv] : corners) {
    const auto& [camera, t, id] = key;
    expect(camera, timeOf(s, t), id, uv);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

// A bow of a nanometre is none, and takes the way of faults: tag_edge must mean the same on it.
TEST(ViewFaults, LeaveTheEdgesOfTagsAsTheyAre) {
  SimulationOptions o = soundRecording(1);
  o.target.shape.terms[kTargetTerms - 1] = 1e-3;
  const CornersById sound = cornersById(withFaults(o, {}));
  const CornersById bowed = cornersById(withFaults(o, {{.kind = kBow, .value = 1e-9}}));
  ASSERT_EQ(sound.size(), bowed.size());
  for (const auto& [key, uv] : sound) ASSERT_LE((bowed.at(key) - uv).norm(), 1e-4);
}

TEST(ViewFaults, BumpTurnsOneCameraFromItsInstantOn) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kBump, .value = 0.1 * kDegree, .at_s = 2, .axis = 1}});
  const Eigen::Matrix3d R_C1Bumped = expSO3(Vector3d(0, 0.1 * kDegree, 0));
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    CameraCalibration c = s.truth.cameras[static_cast<std::size_t>(camera)];
    Transform T_FC = s.trajectory.at(t_s).T_FB * s.truth.imu->T_SC0 * c.T_C0Ci;
    if (camera == 1 && t_s >= 2) T_FC.R *= R_C1Bumped;
    const auto expected = project(c.intrinsics, T_FC.inverse() * nominalCorner(s, id));
    ASSERT_LE((*expected - uv).norm(), 1e-9);
  });
}

TEST(ViewFaults, ExposureShiftShowsTheMotionOfAfterUnderTheSameStamps) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kExposureShift, .value = 0.0015}});
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    const double exposed_s = t_s + (camera == 1 ? 0.0015 : 0);
    ASSERT_LE((projectedAt(s, camera, nominalCorner(s, id), exposed_s) - uv).norm(), 1e-9);
  });
  EXPECT_EQ(s.session.cameras[0].views[7].t, s.session.cameras[1].views[7].t);
}

// The definition: the corner is where its own row's time puts it.
TEST(ViewFaults, RollingShutterCornersAreProjectionsAtTheirRowsTimes) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kRollingShutter, .value = 0.01}});
  double largest = 0;
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    const double row_s = t_s + 0.01 * ((uv.y() + 0.5) / 480 - 0.5);
    ASSERT_LE((projectedAt(s, camera, nominalCorner(s, id), row_s) - uv).norm(), 1e-9);
    largest = std::max(largest, (projectedAt(s, camera, nominalCorner(s, id), t_s) - uv).norm());
  });
  EXPECT_GT(largest, 1);  // it matters
}

TEST(ViewFaults, AColumnShutterGoesByTheColumn) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kColumnShutter, .value = 0.01}});
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    const double column_s = t_s + 0.01 * ((uv.x() + 0.5) / 752 - 0.5);
    ASSERT_LE((projectedAt(s, camera, nominalCorner(s, id), column_s) - uv).norm(), 1e-9);
  });
}

// The definition: on the IMU the cameras turn by v n x (f - mean f); on the whole not at all.
TEST(ViewFaults, ASoftMountTurnsTheCamerasWithTheForce) {
  const double v = 2e-3;
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kSoftMount, .value = v, .axis = 0}});
  Vector3d mean = Vector3d::Zero();
  const auto force = [&](double t_s) -> Vector3d {
    const MotionState motion = s.trajectory.at(t_s);
    return motion.T_FB.R.transpose() * (motion.a_F - s.gravity_F);
  };
  for (const TimeNs stamp : s.frame_stamps) {
    mean += force(secondsBetween(s.start_ns, stamp)) / static_cast<double>(s.frame_stamps.size());
  }
  const CameraStream& camera = s.session.cameras[1];
  for (std::size_t i = 0; i < camera.views.size(); ++i) {
    const double t_s = secondsBetween(s.start_ns, camera.views[i].t) + s.truth.imu->timeOffset();
    const Transform& T_SC0 = s.truth.imu->T_SC0;
    const Transform T_SC = T_SC0 * s.truth.cameras[1].T_C0Ci;
    const Vector3d turn = v * Vector3d::UnitX().cross(force(t_s) - mean);
    Transform T_FS = s.trajectory.at(t_s).T_FB;
    T_FS.R *= expSO3(turn);
    const Vector6d off = boxminus(s.view_poses[1][i], T_FS * T_SC);
    ASSERT_LE(off.norm(), 1e-12) << i;
  }
}

// u is uniform: mean 0 and variance 1/12 of the exposure, found as the shift along the motion.
TEST(ViewFaults, BlurDisplacesCornersAlongTheirMotionOnly) {
  const double exposure = 0.01;
  const SimulatedSession s = withFaults(soundRecording(), {{.kind = kBlur, .value = exposure}});
  double sum = 0;
  double sum2 = 0;
  double count = 0;
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    const Vector3d p = nominalCorner(s, id);
    const Vector2d middle = projectedAt(s, camera, p, t_s);
    const Vector2d path = projectedAt(s, camera, p, t_s + exposure / 2) -
                          projectedAt(s, camera, p, t_s - exposure / 2);
    if (path.norm() < 1) return;
    const double u = (uv - middle).dot(path) / path.squaredNorm();
    ASSERT_LE(std::abs(u), 0.55);  // 0.5 where the motion is uniform
    ASSERT_LE((uv - middle - u * path).norm(), 0.05 * path.norm());  // its path is nearly straight
    sum += u;
    sum2 += u * u;
    ++count;
  });
  EXPECT_LE(std::abs(sum), 4 * std::sqrt(count / 12));
  EXPECT_NEAR(sum2 / count, 1.0 / 12, 0.003);
}

TEST(ViewFaults, BowAndStretchShapeTheBoardNotTheStatedTarget) {
  const SimulatedSession s = withFaults(
      soundRecording(), {{.kind = kStretch, .value = 0.003}, {.kind = kBow, .value = 0.001}});
  EXPECT_EQ(s.session.target.tag_size, AprilGrid{}.tag_size);
  const AprilGrid grid;
  const Vector2d centre(grid.width() / 2, grid.height() / 2);
  double highest = 0;
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    Vector3d p = nominalCorner(s, id);
    p.z() = 0.001 * (1 - std::pow((p.head<2>() - centre).norm() / centre.norm(), 2));
    if (id == 0) ASSERT_NEAR(p.z(), 0, 1e-15);  // the board's outermost corner
    highest = std::max(highest, p.z());
    p.x() *= 1.003;
    ASSERT_LE((projectedAt(s, camera, p, t_s) - uv).norm(), 1e-9);
  });
  EXPECT_GT(highest, 0.00099);
}

TEST(ViewFaults, MovedAndSwayingTargetTakeTheirCornersAlong) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kSway, .value = 0.01, .extent = 0.5, .axis = 0},
                                    {.kind = kMovedTarget, .value = 0.005, .at_s = 2, .axis = 1}});
  forEachCorner(s, [&](int camera, double t_s, int id, const Vector2d& uv) {
    Vector3d p = nominalCorner(s, id);
    p.x() += 0.01 * std::sin(std::numbers::pi * t_s);
    if (t_s >= 2) p.y() += 0.005;
    ASSERT_LE((projectedAt(s, camera, p, t_s) - uv).norm(), 1e-9);
  });
}

TEST(ViewFaults, WrongSizeChangesTheStatedTargetOnly) {
  const SimulatedSession s = withFaults(soundRecording(), {{.kind = kWrongSize, .value = 0.009}});
  EXPECT_DOUBLE_EQ(s.session.target.tag_size, 0.088 * 1.009);
  EXPECT_EQ(cornersById(s), cornersById(cleanRecording()));
}

TEST(ViewFaults, JitterMovesTheStampsOfAllCamerasAlike) {
  SimulationOptions o = soundRecording(40);
  o.imu_rate_hz = 50;
  const SimulatedSession without = withFaults(o, {});
  const SimulatedSession s = withFaults(o, {{.kind = kJitter, .value = 0.001}});
  double sum2 = 0;
  const auto& views = s.session.cameras[0].views;
  ASSERT_EQ(views.size(), 800U);
  for (std::size_t k = 0; k < views.size(); ++k) {
    const double error = secondsBetween(without.session.cameras[0].views[k].t, views[k].t);
    sum2 += error * error;
    ASSERT_EQ(views[k].t, s.session.cameras[1].views[k].t);
    ASSERT_EQ(views[k].corners.size(), without.session.cameras[0].views[k].corners.size());
  }
  EXPECT_NEAR(sum2 / 1e-6, 800, 4 * std::sqrt(2 * 800.0));  // chi-square
}

TEST(ViewFaults, RestampedFramesAreEvenlySpacedAndShowOtherTimes) {
  const SimulatedSession s = withFaults(soundRecording(), {{.kind = kRestamp, .value = 0.1}});
  const auto& views = s.session.cameras[0].views;
  const auto& before = cleanRecording().session.cameras[0].views;
  ASSERT_LT(views.size(), before.size());
  EXPECT_EQ(views.front().t, before.front().t);
  EXPECT_EQ(views.back().t, before.back().t);
  const double step_s =
      secondsBetween(views.front().t, views.back().t) / static_cast<double>(views.size() - 1);
  for (std::size_t k = 1; k < views.size(); ++k) {
    ASSERT_NEAR(secondsBetween(views[k - 1].t, views[k].t), step_s, 1.01e-9);
    ASSERT_EQ(views[k].t, s.session.cameras[1].views[k].t);
    // Some frame of before shows what this one shows.
    ASSERT_TRUE(std::any_of(before.begin(), before.end(), [&](const ImageView& view) {
      return view.corners.size() == views[k].corners.size() &&
             std::equal(view.corners.begin(), view.corners.end(), views[k].corners.begin(),
                        [](const Corner& a, const Corner& b) { return a.uv == b.uv; });
    }));
  }
}

TEST(ViewFaults, FrozenFramesRepeatTheFrameBefore) {
  SimulationOptions o = soundRecording(40);
  o.corner_sigma_px = 0.3;
  o.imu_rate_hz = 50;
  const SimulatedSession s = withFaults(o, {{.kind = kFrozen, .value = 0.5, .camera = 1}});
  std::vector<TimeNs> frozen;
  for (const CameraStream& camera : s.session.cameras) {
    for (std::size_t k = 1; k < camera.views.size(); ++k) {
      const auto& a = camera.views[k - 1].corners;
      const auto& b = camera.views[k].corners;
      if (!a.empty() && a.size() == b.size() && a.front().uv == b.front().uv) {
        frozen.push_back(camera.views[k].t);
        ASSERT_EQ(camera.name, "cam1");
        ASSERT_EQ(a.back().uv, b.back().uv);
      }
    }
  }
  EXPECT_EQ(frozen, s.faults.front().stamps);
  EXPECT_NEAR(static_cast<double>(frozen.size()), 20, 4 * std::sqrt(20.0));
}

TEST(ViewFaults, SwappedTagsKeepTheirCornersAndChangeTheirIds) {
  const SimulatedSession s = withFaults(soundRecording(), {{.kind = kSwappedIds, .value = 0.05}});
  int tags = 0;
  int swapped = 0;
  std::set<TimeNs> struck;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < s.session.cameras[i].views.size(); ++k) {
      const ImageView& view = s.session.cameras[i].views[k];
      const ImageView& was = cleanRecording().session.cameras[i].views[k];
      ASSERT_EQ(view.corners.size(), was.corners.size());
      for (std::size_t c = 0; c < view.corners.size(); c += 4) {
        ASSERT_EQ(view.corners[c].id, was.corners[c].id);  // the same ids are there, ascending
        const auto own = std::find_if(was.corners.begin(), was.corners.end(),
                                      [&](const Corner& x) { return x.uv == view.corners[c].uv; });
        ASSERT_NE(own, was.corners.end());
        ++tags;
        if (own->id == view.corners[c].id) continue;
        ++swapped;
        struck.insert(view.t);
      }
    }
  }
  EXPECT_EQ(std::vector<TimeNs>(struck.begin(), struck.end()), s.faults.front().stamps);
  // Two tags an exchange; now and then one is exchanged twice, or back.
  EXPECT_NEAR(swapped, 2 * 0.05 * tags, 0.02 * tags);
}

TEST(ViewFaults, TagsThatAreSwappedBackAreNoFault) {
  SimulationOptions o = soundRecording();
  o.target = AprilGrid{.rows = 1, .cols = 2};
  const SimulatedSession clean = withFaults(o, {});
  const SimulatedSession s = withFaults(o, {{.kind = kSwappedIds, .value = 0.5}});
  const CornersById exact = cornersById(clean);
  std::set<TimeNs> struck;
  for (const auto& [key, uv] : cornersById(s)) {
    if (exact.at(key) != uv) struck.insert(std::get<1>(key));
  }
  EXPECT_FALSE(struck.empty());
  EXPECT_EQ(std::vector<TimeNs>(struck.begin(), struck.end()), s.faults.front().stamps);
}

TEST(ViewFaults, FalseCornersAreAsManyAndAsFarAsStated) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kFalseCorners, .value = 0.1, .extent = 8}});
  const CornersById exact = cornersById(cleanRecording());
  const CornersById disturbed = cornersById(s);
  int wrong = 0;
  for (const auto& [key, uv] : disturbed) {
    const double distance = (uv - exact.at(key)).norm();
    if (distance == 0) continue;
    ++wrong;
    ASSERT_LE(distance, 12 + 1e-9);
  }
  const auto n = static_cast<double>(disturbed.size());
  EXPECT_NEAR(wrong, 0.1 * n, 4 * std::sqrt(n * 0.1 * 0.9));
}

TEST(ViewFaults, ViewPosesAreThoseOfTheImages) {
  const SimulatedSession s =
      withFaults(soundRecording(), {{.kind = kExposureShift, .value = 0.002},
                                    {.kind = kJitter, .value = 0.001},
                                    {.kind = kMovedTarget, .value = 0.005, .at_s = 2}});
  for (std::size_t i = 0; i < 2; ++i) {
    const CameraStream& camera = s.session.cameras[i];
    ASSERT_EQ(s.view_poses[i].size(), camera.views.size());
    for (std::size_t k = 0; k < camera.views.size(); ++k) {
      for (const Corner& c : camera.views[k].corners) {
        const auto uv = project(s.truth.cameras[i].intrinsics,
                                s.view_poses[i][k].inverse() * nominalCorner(s, c.id));
        ASSERT_LE((*uv - c.uv).norm(), 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace plumbline

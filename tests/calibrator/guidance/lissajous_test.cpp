// SPDX-License-Identifier: BSD-3-Clause
// The suggested trajectories: derivatives, rest at both ends, limits, sight of the target.
#include "calibrator/guidance/trajectories/lissajous.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

const SimulatedRig& rig() {
  static const SimulatedRig r = simulatedRig("euroc");
  return r;
}
const Transform& leverArm() { return rig().calibration.imu->T_SC0; }

/// With the two that only the paper's public code (yac) has: their motion has one more turn.
std::vector<LissajousTrajectory> all(const LissajousOptions& options = {}) {
  std::vector<LissajousShape> shapes = lissajousShapes();
  shapes.push_back({"s horizontal", 1, 3, std::numbers::pi, 0.5, 0.5});
  shapes.push_back({"s vertical", 3, 1, std::numbers::pi, 0.55, 0.55});
  return lissajousTrajectories(shapes, AprilGrid{}, leverArm(), options);
}

LissajousOptions withRoll() {
  LissajousOptions options;
  options.roll_rad = 1;
  return options;
}

/// Largest magnitudes of camera 0 and of S on a fine grid.
struct Extremes {
  double speed = 0, rate = 0, acceleration = 0;
};
Extremes extremes(const LissajousTrajectory& trajectory) {
  Extremes most;
  for (int k = 0; k <= 5000; ++k) {
    const MotionState camera = trajectory.cameraAt(trajectory.durationS() * k / 5000);
    for (const MotionState& m : {camera, attached(camera, leverArm().inverse())}) {
      most.speed = std::max(most.speed, m.v_F.norm());
      most.rate = std::max(most.rate, m.omega_B.norm());
      most.acceleration = std::max(most.acceleration, m.a_F.norm());
    }
  }
  return most;
}

TEST(Lissajous, TheSixOfThePaperByName) {
  std::vector<std::string> names;
  for (const LissajousShape& shape : lissajousShapes()) names.push_back(shape.name);
  EXPECT_THAT(names,
              ::testing::ElementsAre("figure 8 horizontal", "figure 8 vertical", "pan horizontal",
                                     "pan vertical", "diagonal 0", "diagonal 1"));
}

// By hand: half way in time theta is 1/2; at theta = 1/4, pan horizontal stands at x = A.
TEST(Lissajous, TheFirstIsOneOfThem) {
  const LissajousShape first = lissajousFirst();
  EXPECT_EQ(first.name, "diagonal 0");
  EXPECT_TRUE(first.a == 1 && first.b == 1 && first.delta == 0);
}

TEST(Lissajous, PositionsByHand) {
  const AprilGrid target;
  const double R = 1.2 * target.width();
  const LissajousTrajectory pan(lissajousShapes()[2], target, leverArm(), {});
  const double quarter = pan.durationS() / 3;  // sin^2(pi / 6) = 1 / 4
  const double A = 0.95 * target.width();
  const Eigen::Vector3d centre(0.5 * target.width(), 0.5 * target.height(), 0);
  const Eigen::Vector3d end(A, 0, std::sqrt(R * R - A * A));
  EXPECT_LT((pan.cameraAt(quarter).T_FB.t - (centre + end)).norm(), 1e-12);
  EXPECT_LT((pan.cameraAt(0).T_FB.t - (centre + Eigen::Vector3d(0, 0, R))).norm(), 1e-12);
  // A figure of eight crosses its middle half way.
  const LissajousTrajectory eight(lissajousShapes()[0], target, leverArm(), {});
  EXPECT_LT((eight.cameraAt(0.5 * eight.durationS()).T_FB.t - eight.cameraAt(0).T_FB.t).norm(),
            1e-12);
}

TEST(Lissajous, CurvesHaveTheShapesOfTheirNames) {
  const AprilGrid target;
  for (const LissajousTrajectory& trajectory : all()) {
    double width = 0, height = 0, product = 0;
    for (const Transform& T_FC0 : trajectory.path(400)) {
      const double x = T_FC0.t.x() - 0.5 * target.width();
      const double y = T_FC0.t.y() - 0.5 * target.height();
      width = std::max(width, std::abs(x));
      height = std::max(height, std::abs(y));
      product += x * y;
    }
    const std::string& name = trajectory.name();
    EXPECT_EQ(width > 0.1, name != "pan vertical") << name;
    EXPECT_EQ(height > 0.1, name != "pan horizontal") << name;
    if (name.front() == 's') continue;
    EXPECT_EQ(product > 1, name == "diagonal 0") << name;
    EXPECT_EQ(product < -1, name == "diagonal 1") << name;
  }
}

/// All with roll and without.
std::vector<LissajousTrajectory> allOfBothKinds() {
  std::vector<LissajousTrajectory> both = all();
  for (LissajousTrajectory& rolled : all(withRoll())) both.push_back(std::move(rolled));
  return both;
}

// Central differences of step h leave an error of h^2/6 of a third derivative (below 100 here).
TEST(Lissajous, DerivativesAgreeWithDifferences) {
  constexpr double h = 1e-4;
  for (const LissajousTrajectory& trajectory : allOfBothKinds()) {
    for (int k = 1; k < 40; ++k) {
      const double t = trajectory.durationS() * k / 40;
      const MotionState m = trajectory.cameraAt(t);
      const MotionState a = trajectory.cameraAt(t - h);
      const MotionState b = trajectory.cameraAt(t + h);
      EXPECT_LT(((b.T_FB.t - a.T_FB.t) / (2 * h) - m.v_F).norm(), 1e-6) << trajectory.name();
      EXPECT_LT(((b.v_F - a.v_F) / (2 * h) - m.a_F).norm(), 1e-5) << trajectory.name();
      const Eigen::Vector3d turn =
          logSO3(m.T_FB.R.transpose() * b.T_FB.R) - logSO3(m.T_FB.R.transpose() * a.T_FB.R);
      EXPECT_LT((turn / (2 * h) - m.omega_B).norm(), 1e-6) << trajectory.name();
      EXPECT_LT(((b.omega_B - a.omega_B) / (2 * h) - m.alpha_B).norm(), 1e-5) << trajectory.name();
    }
  }
}

TEST(Lissajous, RestsAtBothEndsAndMovesInBetween) {
  for (const LissajousTrajectory& trajectory : all()) {
    const double T = trajectory.durationS();
    for (const double t : {-0.5, 0.0, T, T + 0.5}) {
      const MotionState camera = trajectory.cameraAt(t);
      const MotionState sensor = attached(camera, leverArm().inverse());
      for (const MotionState& m : {camera, sensor}) {
        EXPECT_LT(m.v_F.norm(), 1e-12) << trajectory.name() << " at " << t;
        EXPECT_LT(m.omega_B.norm(), 1e-12) << trajectory.name() << " at " << t;
      }
    }
    EXPECT_GT(trajectory.cameraAt(0.3 * T).v_F.norm(), 0.1) << trajectory.name();
  }
}

TEST(Lissajous, LooksExactlyAtTheCentreWithoutRoll) {
  const AprilGrid target;
  const Eigen::Vector3d centre(0.5 * target.width(), 0.5 * target.height(), 0);
  for (const LissajousTrajectory& trajectory : all()) {
    for (const Transform& T_FC0 : trajectory.path(101)) {
      const Eigen::Vector3d p_C0 = T_FC0.inverse() * centre;
      EXPECT_LT(p_C0.head<2>().norm(), 1e-12) << trajectory.name();
      EXPECT_NEAR(p_C0.z(), 1.2 * target.width(), 1e-12) << trajectory.name();
      EXPECT_NEAR(T_FC0.R(1, 0), 0, 1e-12) << trajectory.name();
    }
  }
}

// By hand: the line of sight is that without roll; x of the camera is turned about it by
// sin(2 pi theta) rad, 1 at theta = 1/4 and -1 at 3/4, which are passed at thirds of the time.
TEST(Lissajous, RollTurnsTheCameraAboutItsLineOfSight) {
  const std::vector<LissajousTrajectory> plain = all(), rolled = all(withRoll());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double T = plain[i].durationS();
    for (const auto& [share, roll] :
         {std::pair(0.0, 0.0), {1.0 / 3, 1.0}, {0.5, 0.0}, {2.0 / 3, -1.0}, {1.0, 0.0}}) {
      const Transform a = plain[i].cameraAt(share * T).T_FB;
      const Transform b = rolled[i].cameraAt(share * rolled[i].durationS()).T_FB;
      EXPECT_LT((a.t - b.t).norm(), 1e-12) << plain[i].name();
      EXPECT_LT((logSO3(a.R.transpose() * b.R) - roll * Eigen::Vector3d::UnitZ()).norm(), 1e-9)
          << plain[i].name() << " " << share;
    }
  }
}

TEST(Lissajous, BothCamerasSeeMostOfTheTargetAllAlong) {
  SimulationOptions seen;
  for (const LissajousTrajectory& trajectory : allOfBothKinds()) {
    for (const Transform& T_FC0 : trajectory.path(101)) {
      for (const CameraCalibration& camera : rig().calibration.cameras) {
        EXPECT_GT(visibleCorners(camera.intrinsics, T_FC0 * camera.T_C0Ci, seen).size(), 100u)
            << trajectory.name();
      }
    }
  }
}

TEST(Lissajous, KeepsItsDurationWithinTheLimits) {
  for (const LissajousTrajectory& trajectory : all()) {
    if (trajectory.name().front() == 's') continue;
    EXPECT_EQ(trajectory.durationS(), 5) << trajectory.name();
    EXPECT_LE(extremes(trajectory).speed, 1.5);
  }
}

TEST(Lissajous, IsSlowedAlongTheSamePathUntilItHoldsALimit) {
  LissajousOptions tight;
  tight.duration_s = 1;
  for (int limit = 0; limit < 3; ++limit) {
    LissajousOptions options = tight;
    if (limit == 0) options.max_speed_m_s = 0.5;
    if (limit == 1) options.max_rate_rad_s = 0.5;
    if (limit == 2) options.max_acceleration_m_s2 = 1;
    for (const LissajousTrajectory& trajectory : all(options)) {
      const Extremes most = extremes(trajectory);
      EXPECT_LE(most.speed, options.max_speed_m_s) << trajectory.name();
      EXPECT_LE(most.rate, options.max_rate_rad_s) << trajectory.name();
      EXPECT_LE(most.acceleration, options.max_acceleration_m_s2) << trajectory.name();
      // No slower than it takes.
      const double used =
          std::max({most.speed / options.max_speed_m_s, most.rate / options.max_rate_rad_s,
                    std::sqrt(most.acceleration / options.max_acceleration_m_s2)});
      EXPECT_GT(used, 0.99) << trajectory.name();
      EXPECT_GT(trajectory.durationS(), 1) << trajectory.name();
    }
  }
  const LissajousTrajectory fast = all().front();
  LissajousOptions slow;
  slow.max_speed_m_s = 0.1;
  const auto a = fast.path(50);
  const auto b = all(slow).front().path(50);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_LT(boxminus(a[k], b[k]).norm(), 1e-9);
}

TEST(Lissajous, AmplitudeScalesAndStopsShortOfTheTargetsPlane) {
  LissajousOptions half;
  half.amplitude = 0.5;
  const double x1 = all()[2].path(3001)[1000].t.x() - 0.5 * AprilGrid{}.width();
  const double x2 = all(half)[2].path(3001)[1000].t.x() - 0.5 * AprilGrid{}.width();
  EXPECT_NEAR(x2, 0.5 * x1, 1e-12);
  LissajousOptions huge;
  huge.amplitude = 10;
  for (const LissajousTrajectory& trajectory : all(huge)) {
    for (const Transform& T_FC0 : trajectory.path(101)) {
      ASSERT_TRUE(T_FC0.matrix().allFinite()) << trajectory.name();
      EXPECT_GE(T_FC0.t.z(), 1.2 * AprilGrid{}.width() * std::sin(0.26)) << trajectory.name();
    }
  }
}

TEST(Lissajous, RefusesWhatNoCurveHas) {
  for (double LissajousOptions::*field :
       {&LissajousOptions::amplitude, &LissajousOptions::distance_ratio,
        &LissajousOptions::duration_s, &LissajousOptions::max_speed_m_s,
        &LissajousOptions::max_rate_rad_s, &LissajousOptions::max_acceleration_m_s2}) {
    LissajousOptions options;
    options.*field = 0;
    EXPECT_THROW(all(options), InputError);
  }
}

}  // namespace
}  // namespace plumbline

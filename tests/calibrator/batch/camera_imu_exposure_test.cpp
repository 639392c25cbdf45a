// SPDX-License-Identifier: BSD-3-Clause
// The pose at an exposure off its frame's instant: against the trajectory, and its derivatives by
// central differences in the tangent space.
#include <gtest/gtest.h>

#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

struct Instant {
  CameraImuProblem problem;
  CameraImuEstimate estimate;  // the truth
};

/// One frame in the middle of an exact recording.
Instant instantOf(const SimulatedSession& s) {
  Instant at;
  at.problem.samples = s.session.imu->samples;
  at.problem.gravity_m_s2 = s.gravity_F.norm();
  at.problem.frames = {{s.frame_stamps[s.frame_stamps.size() / 2], {0, 0}}};
  at.estimate.states = {s.stateAt(at.problem.frames[0].t)};
  at.estimate.gravity_direction = s.gravity_F.normalized();
  at.estimate.time_offsets = s.truth.imu->time_offsets;
  return at;
}

TEST(ExposurePose, FollowsTheTrajectoryForSomeMilliseconds) {
  const SimulatedSession s = test::simulate(test::exactRecording(1600));
  const Instant at = instantOf(s);
  for (const double delay : {3e-3, -3e-3}) {
    const Transform truth = s.stateAt(at.problem.frames[0].t + toNanoseconds(delay)).T_FS;
    const Vector6d error = boxminus(exposurePose(at.problem, at.estimate, 0, delay).T_FS, truth);
    // Jerk d^3 / 12 and the like: below a hundredth of a pixel's worth.
    EXPECT_LT(error.head<3>().norm(), 1e-6) << delay;
    EXPECT_LT(error.tail<3>().norm(), 1e-6) << delay;
    EXPECT_GT(boxminus(at.estimate.states[0].T_FS, truth).norm(), 1e-4) << "it moves";
  }
}

TEST(ExposurePose, DerivativesAreThoseOfDifferences) {
  const Instant at = instantOf(test::simulate(test::exactRecording(200)));
  constexpr double kDelay = 3e-3;
  constexpr double kStep = 1e-5;
  const auto pose = [&](const CameraImuEstimate& e, double delay) {
    return exposurePose(at.problem, e, 0, delay).T_FS;
  };
  const ExposurePose exact = exposurePose(at.problem, at.estimate, 0, kDelay);
  const auto expectColumn = [&](const Vector6d& column, const Transform& plus,
                                const Transform& minus, const std::string& name) {
    const Vector6d difference = boxminus(plus, minus) / (2 * kStep);
    EXPECT_LT((column - difference).cwiseAbs().maxCoeff(), 1e-8) << name;
  };
  const auto moved = [&](const auto& change) {
    CameraImuEstimate e = at.estimate;
    change(e);
    return pose(e, kDelay);
  };
  for (int k = 0; k < 15; ++k) {
    const Vector15d d = kStep * Vector15d::Unit(k);
    const auto by = [&](const Vector15d& x) {
      return moved([&](CameraImuEstimate& e) { e.states[0] = boxplus(e.states[0], x); });
    };
    expectColumn(exact.by_state.col(k), by(d), by(-d), "state " + std::to_string(k));
  }
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d d = kStep * Eigen::Vector2d::Unit(k);
    const auto by = [&](const Eigen::Vector2d& x) {
      return moved([&](CameraImuEstimate& e) {
        e.gravity_direction = boxplusDirection(e.gravity_direction, x);
      });
    };
    expectColumn(exact.by_calibration.col(BorderLayout::kGravity + k), by(d), by(-d), "gravity");
  }
  const auto by_offset = [&](double x) {
    return moved([&](CameraImuEstimate& e) { e.time_offsets[0].s += x; });
  };
  expectColumn(exact.by_calibration.col(BorderLayout::kOffset), by_offset(kStep), by_offset(-kStep),
               "offset");
  expectColumn(exact.by_delay, pose(at.estimate, kDelay + kStep), pose(at.estimate, kDelay - kStep),
               "delay");
  EXPECT_TRUE(exact.by_calibration.leftCols<6>().isZero());
}

}  // namespace
}  // namespace plumbline

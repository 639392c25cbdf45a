// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/view_pool.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/frames.h"
#include "calibrator/information/covariance.h"
#include "tests/evaluate/replay/simulated_pools.h"

namespace plumbline {
namespace {

using test::simulatedPool;
using test::SimulatedPool;

/// A small pool with held-out frames as noisy as its own.
struct Case {
  SimulatedPool simulated = simulatedPool(0, {60, 30, 20, 0.3, 0.3});
  CameraStageOptions options;
  Case() { options.pixel_sigma = 0.3; }
  ViewPool prepare(int most = 1000) const {
    return ViewPool::prepare(simulated.session, simulated.split, options, most).value();
  }
};

/// The session with only these frames' views.
Session sessionOf(const Session& session, const std::vector<int>& positions) {
  const auto frames = pairFrames(session.cameras);
  Session out = session;
  for (std::size_t c = 0; c < out.cameras.size(); ++c) {
    out.cameras[c].views.clear();
    for (const int f : positions) {
      const int view = frames[static_cast<std::size_t>(f)].view[c];
      if (view < 0) continue;
      out.cameras[c].views.push_back(session.cameras[c].views[static_cast<std::size_t>(view)]);
    }
  }
  return out;
}

std::vector<CameraCalibration> calibrationsOf(const Session& session,
                                              const CameraEstimate& estimate) {
  std::vector<CameraCalibration> cameras;
  for (std::size_t c = 0; c < estimate.intrinsics.size(); ++c) {
    CameraCalibration camera;
    camera.name = session.cameras[c].name;
    camera.intrinsics = estimate.intrinsics[c];
    camera.T_C0Ci = estimate.T_C0Ci[c];
    cameras.push_back(camera);
  }
  return cameras;
}

TEST(ViewPool, SolvesWhatCalibratingTheSameFramesFromScratchSolves) {
  const Case c;
  const ViewPool pool = c.prepare();
  const std::vector<int> some(pool.pool().begin() + 7, pool.pool().begin() + 32);
  const auto solution = pool.solve(some);
  ASSERT_TRUE(solution);
  const auto oracle = calibrateCameras(sessionOf(c.simulated.session, some), c.options);
  ASSERT_TRUE(oracle);
  EXPECT_NEAR(solution->entropy_nats, oracle->summary.entropy_nats, 1e-6);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& expected = oracle->cameras[i];
    const Eigen::VectorXd off =
        (solution->estimate.intrinsics[i].stacked() - expected.intrinsics.stacked())
            .cwiseQuotient(*expected.intrinsics_std);
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-5) << i;
  }
  const Eigen::Vector3d t = solution->estimate.T_C0Ci[1].t - oracle->cameras[1].T_C0Ci.t;
  EXPECT_LT(t.cwiseQuotient(oracle->cameras[1].T_C0Ci_std->head<3>()).norm(), 1e-5);
}

TEST(ViewPool, HeldOutErrorIsThatOfScoringTheHeldOutSession) {
  const Case c;
  const ViewPool pool = c.prepare();
  EXPECT_EQ(pool.heldOut(), c.simulated.split.held_out);
  const auto solution = pool.solve({pool.pool().begin(), pool.pool().begin() + 12});
  ASSERT_TRUE(solution);
  const HeldOutError error = pool.heldOutError(solution->estimate);
  const Session held_out = sessionOf(c.simulated.session, pool.heldOut());
  const auto score =
      scoreCameras(held_out, calibrationsOf(held_out, solution->estimate), c.options);
  ASSERT_TRUE(score);
  EXPECT_NEAR(error.px, score->summary.reprojection.rmse_px, 1e-7);

  const double scale = c.options.cauchy_px * c.options.cauchy_px;
  double border = 0, centre = 0, loss = 0;
  int at_border = 0, elsewhere = 0;
  for (const CornerResidual& r : score->residuals) {
    const double s = r.error.cast<double>().squaredNorm();
    loss += scale * std::log(1 + s / scale);
    const Resolution& image = held_out.cameras[static_cast<std::size_t>(r.camera)].resolution;
    const double x = (static_cast<double>(r.uv.x()) + 0.5) / image.width;
    const double y = (static_cast<double>(r.uv.y()) + 0.5) / image.height;
    const bool is_border = x < 0.1 || x > 0.9 || y < 0.1 || y > 0.9;
    (is_border ? border : centre) += s;
    ++(is_border ? at_border : elsewhere);
  }
  ASSERT_GT(at_border, 50);
  ASSERT_GT(elsewhere, 50);
  EXPECT_NEAR(error.border_px, std::sqrt(border / at_border), 1e-6);
  EXPECT_NEAR(error.centre_px, std::sqrt(centre / elsewhere), 1e-6);
  EXPECT_NEAR(error.loss_px, std::sqrt(loss / (at_border + elsewhere)), 1e-6);
  EXPECT_NEAR(error.border_share, 1.0 * at_border / (at_border + elsewhere), 1e-12);
}

TEST(ViewPool, InformationOfItsFramesAddsUpToTheEntropyOfTheWholePool) {
  Case c;
  c.options.cauchy_px = 0;
  const ViewPool pool = c.prepare();
  const auto shares = pool.poolInformation();
  ASSERT_EQ(shares.size(), pool.pool().size());
  Eigen::MatrixXd sum = shares[0];
  for (std::size_t i = 1; i < shares.size(); ++i) sum += shares[i];
  EXPECT_NEAR(entropyNats(sum).value(), pool.reference().entropy_nats, 1e-6);
}

TEST(ViewPool, TheOrderInWhichFramesAreNamedDoesNotMatter) {
  const Case c;
  const ViewPool pool = c.prepare();
  std::vector<int> some(pool.pool().begin(), pool.pool().begin() + 20);
  const auto first = pool.solve(some);
  std::reverse(some.begin(), some.end());
  const auto second = pool.solve(some);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->entropy_nats, second->entropy_nats);
  EXPECT_EQ(first->estimate.intrinsics[1].stacked(), second->estimate.intrinsics[1].stacked());
}

TEST(ViewPool, OneViewDoesNotDetermineTheCameras) {
  const Case c;
  const ViewPool pool = c.prepare();
  EXPECT_FALSE(pool.solve({pool.pool().front()}));
}

TEST(ViewPool, HeldOutFramesAreThinnedEvenlyAndUnusableOnesLeftOut) {
  Case c;
  // A held-out frame whose corners are exchanged has no plausible pose.
  const auto frames = pairFrames(c.simulated.session.cameras);
  const auto broken = static_cast<std::size_t>(c.simulated.split.held_out[3]);
  for (std::size_t i = 0; i < 2; ++i) {
    const int view = frames[broken].view[i];
    if (view < 0) continue;
    auto& corners = c.simulated.session.cameras[i].views[static_cast<std::size_t>(view)].corners;
    for (std::size_t k = 0; k + 1 < corners.size(); k += 2) {
      std::swap(corners[k].uv, corners[corners.size() - 1 - k].uv);
    }
  }
  const ViewPool all = c.prepare();
  EXPECT_EQ(all.heldOut().size() + 1, c.simulated.split.held_out.size());
  EXPECT_EQ(std::count(all.heldOut().begin(), all.heldOut().end(), static_cast<int>(broken)), 0);
  const ViewPool few = c.prepare(5);
  ASSERT_EQ(few.heldOut().size(), 5u);
  EXPECT_EQ(few.heldOut().front(), all.heldOut().front());
  EXPECT_GT(few.heldOut().back(), all.heldOut()[all.heldOut().size() * 3 / 4 - 1]);
}

TEST(ViewPool, FailsWhereAPartHasNoFrame) {
  const Case c;
  FrameSplit split = c.simulated.split;
  split.held_out.clear();
  const auto none = ViewPool::prepare(c.simulated.session, split, c.options, 10);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason(), FailureReason::kTooFewViews);
  split = c.simulated.split;
  split.pool.resize(1);
  const auto one = ViewPool::prepare(c.simulated.session, split, c.options, 10);
  ASSERT_FALSE(one);
  EXPECT_EQ(one.failure().reason(), FailureReason::kNotObservable);
}

}  // namespace
}  // namespace plumbline

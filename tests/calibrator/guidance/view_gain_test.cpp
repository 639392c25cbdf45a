// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/view_gain.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/guidance/views/candidate_views.h"
#include "calibrator/information/covariance.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

using FrameCorners = std::vector<std::vector<Corner>>;

/// Information of one frame by the batch's own way.
Eigen::MatrixXd shareOf(const AprilGrid& target, const CameraEstimate& cameras,
                        const FrameCorners& corners, const Transform& T_FC0,
                        const ViewGainOptions& options) {
  std::vector<PackedCorners> packed;
  Frame frame;
  for (const auto& view : corners) {
    packed.emplace_back(target, std::vector<ImageView>{{0, view}});
    frame.view.push_back(view.empty() ? -1 : 0);
  }
  CameraProblem problem;
  problem.corners = packed;
  problem.frames = {frame};
  problem.pixel_sigma = options.pixel_sigma;
  problem.gram = {options.cauchy_px, 0};
  CameraEstimate at = cameras;
  at.T_C0F = {T_FC0.inverse()};
  return frameInformation(problem, at).front();
}

struct Example {
  test::StereoFrames frames;
  CameraEstimate cameras;
  Eigen::MatrixXd information;
  ViewGainOptions options;

  const AprilGrid& target() const { return frames.simulated.session.target; }
  ViewScorer scorer() const { return {target(), cameras, information, options}; }
};

/// Knows `count` frames of a recording.
Example exampleOf(const std::string& rig, std::size_t count, double cauchy_px = 0) {
  Example e{test::stereoFrames(2, 10, 3, 0.3, rig), {}, {}, {}};
  e.cameras = estimateOf(e.frames.simulated.truth.cameras);
  e.options.pixel_sigma = 0.4;
  e.options.cauchy_px = cauchy_px;
  const int n = CameraLayout(e.cameras.intrinsics).size;
  e.information.setZero(n, n);
  for (std::size_t f = 0; f < count; ++f) {
    e.information +=
        shareOf(e.target(), e.cameras, e.frames.corners[f], e.frames.T_FC0[f], e.options);
  }
  return e;
}

TEST(ViewGain, PredictsTheCornersThatSimulatedRecordingsHave) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const Example e = exampleOf(rig, 10);
    const ViewScorer scorer = e.scorer();
    const auto& cameras = e.frames.simulated.truth.cameras;
    std::size_t corners = 0;
    std::size_t partial = 0;
    for (const CandidateView& view : candidateViews(cameras, e.target())) {
      for (int c = 0; c < 2; ++c) {
        const CameraCalibration& camera = cameras[static_cast<std::size_t>(c)];
        const auto expected =
            visibleCorners(camera.intrinsics, view.T_FC0 * camera.T_C0Ci, SimulationOptions());
        const auto predicted = scorer.predictedCorners(c, view.T_FC0);
        ASSERT_EQ(predicted.size(), expected.size()) << view.name;
        for (std::size_t i = 0; i < expected.size(); ++i) {
          EXPECT_EQ(predicted[i].id, expected[i].id);
          EXPECT_LT((predicted[i].uv - expected[i].uv).norm(), 1e-9);
        }
        corners += expected.size();
        partial += expected.size() < 144 ? 1 : 0;
      }
    }
    EXPECT_GT(corners, 20000u);
    EXPECT_GT(partial, 10u);  // the border matters in some
  }
}

TEST(ViewGain, IsHalfTheGrowthOfTheLogDeterminant) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const Example e = exampleOf(rig, 10);
    const ViewScorer scorer = e.scorer();
    ASSERT_TRUE(scorer.determined());
    for (const CandidateView& view : candidateViews(e.frames.simulated.truth.cameras, e.target())) {
      const FrameCorners corners = {scorer.predictedCorners(0, view.T_FC0),
                                    scorer.predictedCorners(1, view.T_FC0)};
      const auto share = shareOf(e.target(), e.cameras, corners, view.T_FC0, e.options);
      const auto expected = mutualInformationNats(e.information, e.information + share);
      ASSERT_TRUE(expected.has_value());
      EXPECT_GT(*expected, 0.01);
      EXPECT_NEAR(scorer.predictedGains({view.T_FC0}).front(), *expected, 1e-7 * *expected)
          << view.name;
    }
  }
}

TEST(ViewGain, OfASeenFrameCountsTheLoss) {
  const Example plain = exampleOf("euroc", 10);
  const Example robust = exampleOf("euroc", 10, 0.5);
  for (std::size_t f = 10; f < 20; ++f) {
    const FrameCorners& corners = robust.frames.corners[f];
    const Transform& T_FC0 = robust.frames.T_FC0[f];
    const auto share = shareOf(robust.target(), robust.cameras, corners, T_FC0, robust.options);
    const auto expected = mutualInformationNats(robust.information, robust.information + share);
    const double gain = robust.scorer().seenGain(corners, T_FC0);
    EXPECT_NEAR(gain, *expected, 1e-7 * *expected);
    // Errors of 0.3 px under a loss of 0.5 px weigh less.
    const ViewScorer same(plain.target(), plain.cameras, robust.information, plain.options);
    EXPECT_LT(gain, 0.95 * same.seenGain(corners, T_FC0));
  }
}

TEST(ViewGain, CountsOneCameraWhereTheOtherSeesTooLittle) {
  Example e = exampleOf("euroc", 10);
  const FrameCorners& both = e.frames.corners[12];
  const Transform& T_FC0 = e.frames.T_FC0[12];
  const double gain = e.scorer().seenGain(both, T_FC0);
  const double one = e.scorer().seenGain({both[0], {}}, T_FC0);
  EXPECT_GT(one, 0);
  EXPECT_LT(one, gain);
  const Transform away(T_FC0.R * Eigen::AngleAxisd(2, Eigen::Vector3d::UnitY()).matrix(), T_FC0.t);
  EXPECT_TRUE(std::isnan(e.scorer().predictedGains({away}).front()));
  e.options.min_corners = 145;
  EXPECT_TRUE(std::isnan(e.scorer().predictedGains({T_FC0}).front()));
}

TEST(ViewGain, IsUnboundedAsLongAsParametersAreFree) {
  Example e = exampleOf("euroc", 0);
  for (std::size_t f = 0; f < 10; ++f) {  // that camera 1 has not seen
    const FrameCorners one = {e.frames.corners[f][0], {}};
    e.information += shareOf(e.target(), e.cameras, one, e.frames.T_FC0[f], e.options);
  }
  EXPECT_FALSE(e.scorer().determined());
  EXPECT_EQ(e.scorer().seenGain(e.frames.corners[3], e.frames.T_FC0[3]),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(e.scorer().predictedGains({e.frames.T_FC0[3]}).front(),
            std::numeric_limits<double>::infinity());
}

TEST(ViewGain, DoesNotDependOnTheNumberOfThreads) {
  const Example e = exampleOf("euroc", 10);
  std::vector<Transform> T_FC0;
  for (const auto& view : candidateViews(e.frames.simulated.truth.cameras, e.target())) {
    T_FC0.push_back(view.T_FC0);
  }
  const auto one = e.scorer().predictedGains(T_FC0, 1);
  EXPECT_EQ(one, e.scorer().predictedGains(T_FC0, 3));
  EXPECT_EQ(one[17], e.scorer().predictedGains({T_FC0[17]}).front());
}

TEST(ViewGain, RefusesOptionsOutOfRange) {
  Example e = exampleOf("euroc", 1);
  e.options.min_corners = 0;
  EXPECT_THROW(e.scorer(), InputError);
}

}  // namespace
}  // namespace plumbline

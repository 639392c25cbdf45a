// SPDX-License-Identifier: BSD-3-Clause
// Camera calibration of rigs of one, two and three cameras, and what a result can be used for.
#include <algorithm>

#include <gtest/gtest.h>

#include "calibrator/base/frames.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/resample.h"
#include "calibrator/information/covariance.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulationOptions shortRecording(double sigma_px) {
  SimulationOptions options;
  options.duration_s = 10;
  options.camera_rate_hz = 5;
  options.corner_sigma_px = sigma_px;
  return options;
}

/// EuRoC's pair and, above it, a fisheye that looks 30 degrees to the side.
SimulatedRig threeCameras() {
  SimulatedRig rig = simulatedRig("euroc");
  CameraCalibration fisheye = simulatedRig("tumvi").calibration.cameras[0];
  fisheye.name = "cam2";
  fisheye.T_C0Ci = {expSO3({0, 0.5, 0.1}), Eigen::Vector3d(0.05, -0.1, 0.02)};
  rig.calibration.cameras.push_back(fisheye);
  return rig;
}

CameraStageOptions squared(double pixel_sigma) {
  CameraStageOptions options;
  options.cauchy_px = 0;
  options.pixel_sigma = pixel_sigma;
  return options;
}

Eigen::VectorXd errorOf(const CameraStageResult& result,
                        const std::vector<CameraCalibration>& truth) {
  return cameraDifference(result.cameras, truth);
}

double largest(const Eigen::VectorXd& error, const CameraStageResult& result) {
  return error.cwiseQuotient(result.summary.covariance.standardDeviations()).cwiseAbs().maxCoeff();
}

TEST(CameraRigs, OneTwoAndThreeCamerasAreRecoveredWithoutNoise) {
  const SimulatedSession three = simulateSession(threeCameras(), shortRecording(0));
  for (std::size_t n = 1; n <= 3; ++n) {
    Session session = three.session;
    std::vector<CameraCalibration> truth = three.truth.cameras;
    session.cameras.resize(n);
    truth.resize(n);
    const auto result = calibrateCameras(session);
    ASSERT_TRUE(result.ok()) << n << " cameras: " << result.failure();
    const Eigen::VectorXd error = errorOf(*result, truth);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-7) << n << " cameras";  // px, m, rad, 1
    EXPECT_EQ(result->summary.covariance.names.size(), 8 * n + 6 * (n - 1));
    EXPECT_EQ(result->summary.per_camera.size(), n);
  }
}

TEST(CameraRigs, ParametersAreNamedWithTheirUnits) {
  const SimulatedSession s = simulateSession(threeCameras(), shortRecording(0.1));
  const auto result = calibrateCameras(s.session);
  ASSERT_TRUE(result.ok()) << result.failure();
  const ParameterCovariance& c = result->summary.covariance;
  EXPECT_EQ(c.names[0], "cam0.fu");
  EXPECT_EQ(c.names[6], "cam0.p1");
  EXPECT_EQ(c.names[8 + 3], "cam1.pv");
  EXPECT_EQ(c.names[16 + 7], "cam2.k4");
  EXPECT_EQ(c.names[24], "T_C0C1.tx");
  EXPECT_EQ(c.names[35], "T_C0C2.rz");
  EXPECT_EQ(c.units[0] + c.units[4] + c.units[24] + c.units[35], "px-mrad");
  EXPECT_EQ(result->cameras[2].T_C0Ci_std->size(), 6);
  EXPECT_FALSE(result->cameras[0].T_C0Ci_std.has_value());
  EXPECT_EQ((*result->cameras[1].intrinsics_std)[3], c.standardDeviations()[11]);
}

TEST(CameraRigs, StampsNeedNotBeEqual) {
  SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0));
  int k = 0;
  for (ImageView& view : s.session.cameras[1].views) view.t += (k++ % 2 ? 900'000 : -700'000);
  const auto result = calibrateCameras(s.session);
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_LT(errorOf(*result, s.truth.cameras).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(CameraRigs, TheOrderOfTheFramesDoesNotMatter) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0.2));
  Session backwards = s.session;
  for (CameraStream& camera : backwards.cameras) {
    std::reverse(camera.views.begin(), camera.views.end());
    for (ImageView& view : camera.views) view.t = -view.t;
  }
  const auto a = calibrateCameras(s.session);
  const auto b = calibrateCameras(backwards);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_NEAR(a->summary.cost, b->summary.cost, 1e-11 * a->summary.cost);
  EXPECT_LT(largest(errorOf(*a, b->cameras), *a), 1e-6);
}

// An error is a share of the width of the image that it is in, also where camera 0 has none of it.
TEST(CameraRigs, NoFramesOfAWideImageAreLostBesideANarrowOne) {
  SimulatedRig rig = simulatedRig("euroc");
  Intrinsics& narrow = rig.calibration.cameras[0].intrinsics;
  narrow.resolution = {narrow.resolution.width / 8, narrow.resolution.height / 8};
  narrow.projection.head<2>() *= 0.125;
  narrow.projection.tail<2>().array() = 0.125 * (narrow.projection.tail<2>().array() + 0.5) - 0.5;
  SimulationOptions options = shortRecording(0);
  options.border_px = 1;
  options.min_tag_px = 1;
  SimulatedSession s = simulateSession(rig, options);
  options.corner_sigma_px = 4;  // 0.8 % of one width, 6 % of the other
  CameraStream& wide = s.session.cameras[1];
  for (std::size_t v = 0; v < wide.views.size(); ++v) {
    disturbCorners(wide.views[v].corners, wide.resolution, 1, v, options);
  }
  std::erase_if(s.session.cameras[0].views,
                [k = 0](const ImageView&) mutable { return ++k % 2 == 0; });
  const std::size_t frames = pairFrames(s.session.cameras).size();
  const auto result = calibrateCameras(s.session);
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_GT(10 * result->frames.size(), 9 * frames) << frames;
}

TEST(CameraRigs, WidthIsThatOfTheImagesThatTheCornersAreIn) {
  SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0));
  const std::vector<PackedCorners> corners = packCorners(s.session);
  const CameraProblem problem = problemOf(corners, pairFrames(s.session.cameras), {});
  CameraEstimate cameras = estimateOf(s.truth.cameras);
  const int width = cameras.intrinsics[0].resolution.width;
  EXPECT_EQ(rmsWidth(problem, cameras), width);
  cameras.intrinsics[0].resolution.width = width / 8;
  EXPECT_GT(rmsWidth(problem, cameras), 0.6 * width);
  EXPECT_LT(rmsWidth(problem, cameras), width);
}

TEST(CameraRigs, StrayCornersAnywhereInTheImageCostNoFrames) {
  for (const char* rig : {"euroc", "d435i"}) {
    SimulatedSession s = simulateSession(simulatedRig(rig), shortRecording(0.2));
    int k = 0;
    for (CameraStream& camera : s.session.cameras) {
      for (ImageView& view : camera.views) {
        for (Corner& corner : view.corners) {
          if (++k % 50 == 0) corner.uv = Eigen::Vector2d(37 * k % 400, 91 * k % 400);
        }
      }
    }
    const auto result = calibrateCameras(s.session);
    ASSERT_TRUE(result.ok()) << rig << ": " << result.failure();
    EXPECT_EQ(result->summary.views_used, result->summary.views_offered) << rig;
    EXPECT_LT(largest(errorOf(*result, s.truth.cameras), *result), 2) << rig;  // sigma: 1 px
  }
}

TEST(CameraRigs, EveryFrameAddsItsShareOfInformationAndThatIsItsGain) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0.2));
  const auto result = calibrateCameras(s.session, squared(0.2));
  ASSERT_TRUE(result.ok());
  std::vector<PackedCorners> corners;
  CameraEstimate estimate;
  for (std::size_t c = 0; c < 2; ++c) {
    corners.emplace_back(s.session.target, s.session.cameras[c].views);
    estimate.intrinsics.push_back(result->cameras[c].intrinsics);
    estimate.T_C0Ci.push_back(result->cameras[c].T_C0Ci);
  }
  for (const Transform& T_FC0 : result->T_FC0) estimate.T_C0F.push_back(T_FC0.inverse());
  CameraProblem problem;
  problem.corners = corners;
  problem.frames = result->frames;
  problem.pixel_sigma = 0.2;
  const auto shares = frameInformation(problem, estimate);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(22, 22);
  for (const Eigen::MatrixXd& share : shares) all += share;
  const Eigen::MatrixXd identity = all * result->summary.covariance.matrix;
  EXPECT_LT((identity - Eigen::MatrixXd::Identity(22, 22)).cwiseAbs().maxCoeff(), 1e-6);
  // Without its first frame the problem has a covariance of its own: the ratio is the gain.
  problem.frames.erase(problem.frames.begin());
  estimate.T_C0F.erase(estimate.T_C0F.begin());
  const Eigen::MatrixXd rest = reducedInformation(normalsAt(problem, estimate));
  const auto gain = mutualInformationNats(rest, rest + shares[0]);
  ASSERT_TRUE(gain.has_value());
  EXPECT_NEAR(*gain, *entropyNats(rest) - result->summary.entropy_nats, 1e-8);
}

TEST(ScoreCameras, TheOptimumScoresItselfAndAnyOtherCalibrationScoresWorse) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0.2));
  const auto best = calibrateCameras(s.session, squared(1));
  ASSERT_TRUE(best.ok());
  const auto own = scoreCameras(s.session, best->cameras, squared(1));
  ASSERT_TRUE(own.ok());
  EXPECT_NEAR(own->summary.cost, best->summary.cost, 1e-9 * best->summary.cost);
  EXPECT_EQ(own->summary.corners_used, best->summary.corners_used);
  const auto truth = scoreCameras(s.session, s.truth.cameras, squared(1));
  ASSERT_TRUE(truth.ok());
  EXPECT_GT(truth->summary.cost, best->summary.cost);
  std::vector<CameraCalibration> other = best->cameras;
  other[1].intrinsics.projection[0] += 5;
  const auto worse = scoreCameras(s.session, other, squared(1));
  ASSERT_TRUE(worse.ok());
  EXPECT_GT(worse->summary.cost, 1.1 * best->summary.cost);
  EXPECT_EQ(worse->cameras[1].intrinsics.stacked(), other[1].intrinsics.stacked());
}

/// Two tags exchange their ids.
void exchangeTags(int a, int b, std::vector<Corner>& corners) {
  for (Corner& corner : corners) {
    const int tag = corner.id / 4;
    if (tag == a || tag == b) corner.id += 4 * (tag == a ? b - a : a - b);
  }
  std::ranges::sort(corners, {}, &Corner::id);
}

TEST(ScoreCameras, TagsInThePlaceOfOthersDoNotCount) {
  SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0.2));
  const auto sound = scoreCameras(s.session, s.truth.cameras);
  std::vector<ImageView>& views = s.session.cameras[0].views;
  exchangeTags(14, 15, std::ranges::max_element(views, {}, [](const ImageView& view) {
                         return view.corners.size();
                       })->corners);
  const auto exchanged = scoreCameras(s.session, s.truth.cameras);
  ASSERT_TRUE(sound.ok() && exchanged.ok());
  EXPECT_EQ(exchanged->summary.corners_used, sound->summary.corners_used - 8);
  EXPECT_NEAR(exchanged->summary.reprojection.rmse_px, sound->summary.reprojection.rmse_px, 1e-3);
}

TEST(RecalibrateCameras, TheWholeRecordingGivesTheSameAndWeightsCountAsRepeats) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0.2));
  const auto all = calibrateCameras(s.session);
  ASSERT_TRUE(all.ok());
  const int n = static_cast<int>(all->frames.size());
  const auto same = recalibrateCameras(s.session, *all, {{0, n, 1}});
  const auto twice = recalibrateCameras(s.session, *all, {{0, n, 2}});
  ASSERT_TRUE(same.ok() && twice.ok());
  EXPECT_NEAR(same->summary.cost, all->summary.cost, 1e-12 * all->summary.cost);
  EXPECT_NEAR(twice->summary.cost, 2 * all->summary.cost, 1e-11 * all->summary.cost);
  EXPECT_LT(largest(errorOf(*twice, all->cameras), *all), 1e-5);
  const Eigen::VectorXd half = twice->summary.covariance.matrix.diagonal() * 2;
  EXPECT_TRUE(half.isApprox(same->summary.covariance.matrix.diagonal(), 1e-6));
}

TEST(ResampleCameras, IndependentNoiseSpreadsTheDrawsAsTheCovarianceSays) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), shortRecording(0.2));
  const CameraStageOptions options = squared(0.2);
  const auto all = calibrateCameras(s.session, options);
  ASSERT_TRUE(all.ok());
  ResampleOptions resample{.draws = 40, .segments = 25, .seed = 5};
  const auto one = resampleCameras(s.session, *all, resample, options);
  ASSERT_TRUE(one.ok()) << one.failure();
  EXPECT_EQ(one->failed, 0);
  EXPECT_EQ(one->names, all->summary.covariance.names);
  const Eigen::VectorXd ratio =
      one->std.cwiseQuotient(all->summary.covariance.standardDeviations());
  EXPECT_GT(ratio.mean(), 0.7);
  EXPECT_LT(ratio.mean(), 1.5);
  resample.threads = 3;
  const auto three = resampleCameras(s.session, *all, resample, options);
  ASSERT_TRUE(three.ok());
  EXPECT_EQ(one->draws, three->draws);
}

}  // namespace
}  // namespace plumbline

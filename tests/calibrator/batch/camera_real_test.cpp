// SPDX-License-Identifier: BSD-3-Clause
// The real EuRoC recording against the optimum that two independent solvers agree on.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "tests/calibrator/batch/euroc_recording.h"

namespace plumbline {
namespace {

const Session& euroc() {
  static const Session session = test::readEurocRecording(PLUMBLINE_SHARED_DATA).session;
  return session;
}

/// Tags that both views hold, counted by their corner 0.
int commonTags(const ImageView& a, const ImageView& b) {
  const auto holds = [](const ImageView& view, int id) {
    return std::any_of(view.corners.begin(), view.corners.end(),
                       [id](const Corner& corner) { return corner.id == id; });
  };
  return static_cast<int>(std::count_if(
      a.corners.begin(), a.corners.end(),
      [&](const Corner& corner) { return corner.id % 4 == 0 && holds(b, corner.id); }));
}

/// The frames in which both cameras see at least 24 tags in common.
Session framesWithManyTags() {
  Session session = euroc();
  std::vector<CameraStream> kept = session.cameras;
  for (CameraStream& camera : kept) camera.views.clear();
  for (const Frame& frame : pairFrames(session.cameras)) {
    if (frame.view[0] < 0 || frame.view[1] < 0) continue;
    const ImageView& left = session.cameras[0].views[static_cast<std::size_t>(frame.view[0])];
    const ImageView& right = session.cameras[1].views[static_cast<std::size_t>(frame.view[1])];
    if (commonTags(left, right) < 24) continue;
    kept[0].views.push_back(left);
    kept[1].views.push_back(right);
  }
  session.cameras = std::move(kept);
  return session;
}

Session onlyCamera(Session session, int camera) {
  session.cameras = {session.cameras[static_cast<std::size_t>(camera)]};
  return session;
}

CameraStageOptions withoutLoss() {
  CameraStageOptions options;
  options.cauchy_px = 0;
  return options;
}

double rmseOf(const Session& session) {
  const auto result = calibrateCameras(session, withoutLoss());
  if (!result) {
    ADD_FAILURE() << result.failure();
    return 0;
  }
  EXPECT_TRUE(result->summary.converged);
  EXPECT_EQ(result->summary.corners_used, result->summary.corners_offered);
  return result->summary.reprojection.rmse_px;
}

TEST(EurocCameras, MonoReachesTheKnownOptimum) {
  const Session session = framesWithManyTags();
  ASSERT_EQ(session.cameras[0].views.size(), 1182u);
  EXPECT_NEAR(rmseOf(onlyCamera(session, 0)), 0.4725633, 1e-5);
  EXPECT_NEAR(rmseOf(onlyCamera(session, 1)), 0.4770631, 1e-5);
}

TEST(EurocCameras, StereoReachesTheKnownOptimum) {
  EXPECT_NEAR(rmseOf(framesWithManyTags()), 0.4804704, 1e-5);
}

TEST(EurocCameras, StereoOverAllFramesReachesTheKnownOptimum) {
  EXPECT_NEAR(rmseOf(euroc()), 0.5179713, 1e-5);
}

TEST(EurocCameras, TheDefaultLossConvergesAndTellsItsTimes) {
  const auto result = calibrateCameras(euroc());
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_TRUE(result->summary.converged);
  EXPECT_GT(result->summary.reprojection.rmse_px, 0.5179713);  // the squared loss has the least
  EXPECT_LT(result->summary.reprojection.median_px, 0.5);
  const StageSeconds& s = result->summary.seconds;
  EXPECT_GE(s.total, s.initialise + s.solve + s.checks + s.covariance);
  RecordProperty("seconds", std::to_string(s.total));
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// The camera stage over EuRoC's imu_april, frame by frame; nobody follows its suggestions there.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "tests/calibrator/batch/euroc_recording.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

std::vector<GuideFrame> guideFrames(const Session& session) {
  std::vector<GuideFrame> frames;
  for (const Frame& f : pairFrames(session.cameras)) {
    GuideFrame frame;
    frame.index = static_cast<int>(frames.size());
    frame.t = f.t;
    for (std::size_t c = 0; c < session.cameras.size(); ++c) {
      const int view = f.view[c];
      frame.corners.push_back(
          view < 0 ? std::vector<Corner>()
                   : session.cameras[c].views[static_cast<std::size_t>(view)].corners);
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

double rmseOn(const Session& session, const std::vector<CameraCalibration>& cameras) {
  const auto scored = scoreCameras(session, cameras);
  return scored ? scored->summary.reprojection.rmse_px : std::nan("");
}

TEST(CameraGuideOnEuroc, KeepsAFewViewsThatCalibrateTheWholeRecording) {
  const Session session = test::readEurocRecording(PLUMBLINE_SHARED_DATA).session;
  GuideRig rig;
  rig.target = session.target;
  for (const CameraStream& camera : session.cameras) {
    rig.cameras.push_back({camera.name, camera.resolution, {}});
  }
  CameraGuide guide(rig, {});
  std::vector<Decision> decisions;
  for (const GuideFrame& frame : guideFrames(session)) decisions.push_back(guide.step(frame));
  ASSERT_GE(decisions.size(), 1416u);  // frames with a view of either camera
  EXPECT_EQ(test::countOf(decisions, GuideReason::kInitialised), 1);
  EXPECT_EQ(test::countOf(decisions, GuideReason::kNotSolved), 0);
  EXPECT_GE(test::countOf(decisions, SuggestionEvent::kExpired), 1);
  const auto batch = guide.batch();
  ASSERT_TRUE(batch.ok()) << batch.failure();
  EXPECT_EQ(static_cast<int>(batch->frames.size()), decisions.back().views_kept);
  EXPECT_LT(batch->frames.size(), 300u);
  const auto full = calibrateCameras(session);
  ASSERT_TRUE(full.ok());
  const double with_kept = rmseOn(session, batch->cameras);
  const double with_full = rmseOn(session, full->cameras);
  EXPECT_LT(with_kept, 1.1 * with_full);
  const Eigen::VectorXd d = cameraDifference(batch->cameras, full->cameras);
  EXPECT_LT(std::abs(d(0)), 0.015 * full->cameras[0].intrinsics.projection(0));
  RecordProperty("finished", guide.finished() ? 1 : 0);
  RecordProperty("views_kept", decisions.back().views_kept);
  RecordProperty("batch_rmse_px", fmt::format("{:.4f}", batch->summary.reprojection.rmse_px));
  RecordProperty("full_batch_rmse_px", fmt::format("{:.4f}", full->summary.reprojection.rmse_px));
  RecordProperty("whole_recording_rmse_px",
                 fmt::format("kept {:.4f} full {:.4f}", with_kept, with_full));
  RecordProperty("focal_difference_px", fmt::format("{:.3f}", d(0)));
}

}  // namespace
}  // namespace plumbline

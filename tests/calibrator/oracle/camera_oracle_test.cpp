// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/camera_oracle.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/example_view.h"

namespace plumbline::oracle {
namespace {

// A stereo recording of a few frames whose truth is known.
struct CameraRecording {
  Session session;
  std::vector<Frame> frames;
  CameraState truth;
};

CameraRecording stereoRecording(int frames, double noise_px) {
  CameraRecording recording;
  CameraCalibration left{"cam0", "", test::radtanCamera(), Transform(), {}, {}};
  CameraCalibration right{"cam1", "", test::equidistantCamera(), Transform(), {}, {}};
  right.T_C0Ci = {expSO3({0.01, -0.02, 0.005}), Eigen::Vector3d(0.11, 0.001, -0.002)};
  recording.truth.cameras = {left, right};
  recording.session.cameras.resize(2);
  for (int i = 0; i < frames; ++i) {
    Vector6d d;
    d << 0.1 * std::sin(i), 0.1 * std::cos(i), 0.2 * std::sin(2 * i), 0.3 * std::cos(3 * i),
        0.3 * std::sin(4 * i), 0.3 * std::sin(5 * i);
    recording.truth.T_FC0.push_back(boxplus(test::examplePose(), d).inverse());
    for (int c = 0; c < 2; ++c) {
      const Transform T_CF =
          (recording.truth.T_FC0[i] * recording.truth.cameras[c].T_C0Ci).inverse();
      recording.session.cameras[c].views.push_back(
          test::noisyView(recording.session.target, recording.truth.cameras[c].intrinsics, T_CF, 60,
                          noise_px, 2 * i + c));
    }
    recording.frames.push_back({i, {i, i}});
  }
  return recording;
}

CameraState disturbed(CameraState state) {
  for (CameraCalibration& camera : state.cameras) {
    camera.intrinsics.projection *= 1.03;
    camera.intrinsics.distortion *= 0.8;
  }
  const Vector6d d = Vector6d::Constant(0.01);
  state.cameras[1].T_C0Ci = boxplus(state.cameras[1].T_C0Ci, d);
  for (Transform& T : state.T_FC0) T = boxplus(T, -d);
  return state;
}

TEST(CameraOracle, RecoversTheTruthWithoutNoise) {
  const CameraRecording recording = stereoRecording(8, 0);
  for (double cauchy_px : {0.0, 1.5}) {
    const CameraSolution solution =
        solveCameras(recording.session, recording.frames, disturbed(recording.truth),
                     {.cauchy_px = cauchy_px, .covariance = false});
    EXPECT_LT(solution.cost, 1e-18);
    EXPECT_LT(difference(solution.state, recording.truth).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(CameraOracle, ErrorsWithNoiseAgreeWithTheCovariance) {
  const CameraRecording recording = stereoRecording(8, 0.5);
  const CameraSolution solution = solveCameras(recording.session, recording.frames,
                                               disturbed(recording.truth), {.pixel_sigma = 0.5});
  EXPECT_TRUE(solution.converged);
  const Eigen::VectorXd error = difference(solution.state, recording.truth);
  const double chi2 = error.dot(solution.covariance.ldlt().solve(error));
  EXPECT_GT(chi2, 5.7);   // chi-square, 22 degrees of freedom: 0.01 %
  EXPECT_LT(chi2, 56.2);  // and 99.99 % quantiles
}

TEST(CameraOracle, CostIsHalfTheSumOverCornersInUnitsOfSigma) {
  const CameraRecording recording = stereoRecording(3, 0.5);
  const CameraSolution solution =
      solveCameras(recording.session, recording.frames, recording.truth,
                   {.cauchy_px = 1.5, .pixel_sigma = 2, .covariance = false});
  double cost = 0;
  for (const Frame& frame : recording.frames) {
    for (int c = 0; c < 2; ++c) {
      const CameraCalibration& camera = solution.state.cameras[c];
      const auto f = static_cast<std::size_t>(frame.t);
      const Transform T_CF = (solution.state.T_FC0[f] * camera.T_C0Ci).inverse();
      for (const Corner& corner : recording.session.cameras[c].views[frame.view[c]].corners) {
        const Eigen::Vector2d p_F = recording.session.target.corner(corner.id);
        const auto uv = project(camera.intrinsics, T_CF * Eigen::Vector3d(p_F.x(), p_F.y(), 0));
        cost += 0.5 * 2.25 * std::log1p((*uv - corner.uv).squaredNorm() / 2.25) / 4;
      }
    }
  }
  EXPECT_NEAR(solution.cost, cost, 1e-12 * cost);
}

}  // namespace
}  // namespace plumbline::oracle

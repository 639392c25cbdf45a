// SPDX-License-Identifier: BSD-3-Clause
// Monte Carlo of the definition in information/projection_uncertainty.h: the session is measured
// again under many seeds, calibrated, tied to the truth by its boards, and the spread of where
// fixed points are seen is held against the prediction. The alignment is done here on transforms
// and pixels (means of moved points; a fit of all corners), not with the linear formulas under
// test.
#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/information.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

constexpr int kProjectionSeeds = 200;
constexpr double kProjectionSigma = 0.2;  // [px]
constexpr double kFar = 1e7;              // [m], where translations no longer matter

SimulatedSession measuredAgain(int seed) {
  SimulationOptions recording;
  recording.seed = static_cast<std::uint64_t>(seed);
  recording.duration_s = 10;
  recording.camera_rate_hz = 2;
  recording.corner_sigma_px = kProjectionSigma;
  return simulateSession(simulatedRig("euroc"), recording);
}

// The truth at the frames of a result.
CameraStageResult truthOf(const SimulatedSession& s, const std::vector<Frame>& frames) {
  CameraStageResult truth;
  truth.cameras = s.truth.cameras;
  truth.frames = frames;
  for (const Frame& frame : frames) truth.T_FC0.push_back(s.cameraPose(0, frame.t));
  return truth;
}

// T of the reference that best explains, with the true cameras, where the moved boards are seen:
// min over T of sum |h_i(T^-1 T_C0F+ p_F) - h_i(T_C0F p_F)|^2.
Transform crossReprojected(const Session& session, const CameraStageResult& truth,
                           const CameraStageResult& moved) {
  Transform T_back;  // T^-1
  for (int iteration = 0; iteration < 5; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (std::size_t f = 0; f < truth.frames.size(); ++f) {
      for (std::size_t c = 0; c < truth.cameras.size(); ++c) {
        const int view = truth.frames[f].view[c];
        if (view < 0) continue;
        const CameraCalibration& camera = truth.cameras[c];
        const Transform T_CiC0 = camera.T_C0Ci.inverse();
        for (const Corner& corner :
             session.cameras[c].views[static_cast<std::size_t>(view)].corners) {
          Eigen::Vector3d p_F = Eigen::Vector3d::Zero();
          p_F.head<2>() = session.target.corner(corner.id);
          const auto seen = project(camera.intrinsics, T_CiC0 * (truth.T_FC0[f].inverse() * p_F));
          const Eigen::Vector3d p_C0 = T_back * (moved.T_FC0[f].inverse() * p_F);
          const auto now = projectWithJacobians(camera.intrinsics, T_CiC0 * p_C0);
          Eigen::Matrix<double, 2, 6> J;
          J << now->J_point * T_CiC0.R, -now->J_point * T_CiC0.R * skew(p_C0);
          H += J.transpose() * J;
          b += J.transpose() * (now->uv - *seen);
        }
      }
    }
    const Vector6d x = -H.ldlt().solve(b);
    T_back = Transform(expSO3(x.tail<3>()), x.head<3>()) * T_back;
  }
  return T_back.inverse();
}

Eigen::Vector3d meanOfFrames(const Eigen::Vector3d& p_C0, const CameraStageResult& truth,
                             const CameraStageResult& moved) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t f = 0; f < truth.T_FC0.size(); ++f) {
    sum += moved.T_FC0[f].inverse() * (truth.T_FC0[f] * p_C0);
  }
  return sum / static_cast<double>(truth.T_FC0.size());
}

struct Point {
  std::size_t camera;
  Eigen::Vector2d uv;
  double range_m;
};

std::vector<Point> points() {
  std::vector<Point> all;
  for (const std::size_t camera : {0, 1}) {
    for (const double range : {1.0, kFar}) {
      for (const auto& uv : {Eigen::Vector2d(376, 240), {20, 20}, {730, 460}}) {
        all.push_back({camera, uv, range});
      }
    }
  }
  return all;
}

struct ProjectionSums {
  double aligned = 0;    // of e^T C^-1 e
  double unaligned = 0;  // the same with the intrinsics alone, as if poses did not move
};

// The joint prediction at the truth for each method.
CameraInformation predicted(const SimulatedSession& s, const CameraStageResult& truth,
                            FrameAlignment alignment) {
  CameraInformationOptions options;
  options.pixel_sigma = kProjectionSigma;
  options.cauchy_px = 0;
  options.alignment = alignment;
  auto information = cameraInformation(s.session, truth, options);
  EXPECT_TRUE(information.ok());
  return std::move(information).value();
}

void addErrors(const SimulatedSession& s, const CameraStageResult& moved, FrameAlignment alignment,
               std::vector<ProjectionSums>& sums) {
  const CameraStageResult truth = truthOf(s, moved.frames);
  const CameraInformation information = predicted(s, truth, alignment);
  const bool mean = alignment == FrameAlignment::kMeanFrames;
  const Transform T = mean ? Transform() : crossReprojected(s.session, truth, moved);
  const std::vector<Point> all = points();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Point& at = all[i];
    const CameraCalibration& camera = truth.cameras[at.camera];
    const Eigen::Vector3d p_C0 =
        camera.T_C0Ci * (at.range_m * *unproject(camera.intrinsics, at.uv));
    const Eigen::Vector3d p = mean ? meanOfFrames(p_C0, truth, moved) : T * p_C0;
    const CameraCalibration& again = moved.cameras[at.camera];
    const Eigen::Vector2d e = *project(again.intrinsics, again.T_C0Ci.inverse() * p) - at.uv;
    ProjectionCovariance C = information.projection[at.camera];
    sums[i].aligned +=
        e.dot(pixelCovariance(camera.intrinsics, C, at.uv, at.range_m)->llt().solve(e));
    C.topRows<6>().setZero();
    C.leftCols<6>().setZero();
    sums[i].unaligned +=
        e.dot(pixelCovariance(camera.intrinsics, C, at.uv, at.range_m)->llt().solve(e));
  }
}

void check(FrameAlignment alignment, const char* name) {
  std::vector<ProjectionSums> sums(points().size());
  for (int seed = 1; seed <= kProjectionSeeds; ++seed) {
    const SimulatedSession s = measuredAgain(seed);
    CameraStageOptions options;
    options.cauchy_px = 0;
    options.pixel_sigma = kProjectionSigma;
    options.start = s.truth.cameras;
    const auto result = calibrateCameras(s.session, options);
    ASSERT_TRUE(result.ok()) << seed;
    addErrors(s, *result, alignment, sums);
  }
  // A sum of 2 kProjectionSeeds squared normal errors: relative deviation 1 /
  // sqrt(kProjectionSeeds) = 7 %.
  const double tolerance = 3.9 / std::sqrt(static_cast<double>(kProjectionSeeds));
  const std::vector<Point> all = points();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double ratio = sums[i].aligned / (2 * kProjectionSeeds);
    const std::string what = fmt::format("{} cam{} ({}, {}) at {} m", name, all[i].camera,
                                         all[i].uv.x(), all[i].uv.y(), all[i].range_m);
    EXPECT_NEAR(ratio, 1, tolerance) << what;
    // Intrinsics alone would predict several times the spread: the test can tell.
    EXPECT_LT(sums[i].unaligned / (2 * kProjectionSeeds), 0.5) << what;
    ::testing::Test::RecordProperty(fmt::format("{}_{}", name, i), fmt::format("{:.4f}", ratio));
  }
}

TEST(ProjectionUncertaintyStatistics, MeanFrames) { check(FrameAlignment::kMeanFrames, "mean"); }

TEST(ProjectionUncertaintyStatistics, CrossReprojection) {
  check(FrameAlignment::kCrossReprojection, "cross");
}

}  // namespace
}  // namespace plumbline

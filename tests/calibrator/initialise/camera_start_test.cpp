// SPDX-License-Identifier: BSD-3-Clause
// First guesses of the camera stage: poses from homographies, focal lengths, extrinsics.
#include "calibrator/initialise/camera_start.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/camera_graph.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/lens_fit.h"
#include "calibrator/residuals/view_gram.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/camera/example_cameras.h"

namespace plumbline {
namespace {

SimulatedSession recording(const std::string& rig, double sigma_px) {
  SimulationOptions options;
  options.duration_s = 10;
  options.camera_rate_hz = 3;
  options.corner_sigma_px = sigma_px;
  return simulateSession(simulatedRig(rig), options);
}

Transform truePose(const SimulatedSession& s, int camera, const ImageView& view) {
  return s.cameraPose(camera, view.t).inverse();
}

double distance(const Transform& a, const Transform& b) { return boxminus(a, b).norm(); }

TEST(HomographyPose, IsExactWithoutNoiseEvenAtTheRimOfAFisheye) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const SimulatedSession s = recording(rig, 0);
    const Intrinsics& camera = s.truth.cameras[0].intrinsics;
    const auto& views = s.session.cameras[0].views;
    const PackedCorners corners(s.session.target, views);
    for (int v = 0; v < corners.viewCount(); ++v) {
      const auto pose = homographyPose(camera, corners.view(v));
      ASSERT_TRUE(pose.has_value()) << rig << " view " << v;
      const Transform truth = truePose(s, 0, views[static_cast<std::size_t>(v)]);
      EXPECT_LT(distance(*pose, truth), 1e-7) << rig << " view " << v;
    }
  }
}

TEST(HomographyPose, NeedsFourCornersThatAreNotOnALine) {
  const AprilGrid target;
  const Intrinsics camera =
      plainCamera(ProjectionModel::kPinhole, DistortionModel::kRadtan, {640, 480}, 400);
  const auto viewOf = [&](const std::vector<int>& ids) {
    ImageView view;
    for (const int id : ids) {
      const Eigen::Vector2d p = target.corner(id);
      view.corners.push_back({id, Eigen::Vector2d(100, 100) + 300 * p});
    }
    return PackedCorners(target, {view});
  };
  EXPECT_FALSE(homographyPose(camera, viewOf({0, 1, 2}).view(0)).has_value());
  EXPECT_FALSE(homographyPose(camera, viewOf({0, 1, 4, 5, 8, 9}).view(0)).has_value());
  EXPECT_TRUE(homographyPose(camera, viewOf({0, 1, 2, 3}).view(0)).has_value());
}

TEST(MirroredPose, KeepsTheCentreAndReflectsTheNormalAtTheLineOfSight) {
  const Eigen::Vector2d centre(0.1, 0.2);
  const Transform T_CF(expSO3({2.5, 0.3, -0.2}), Eigen::Vector3d(0.1, -0.2, 1.5));
  const Transform other = mirroredPose(T_CF, centre);
  const Eigen::Vector3d C(centre.x(), centre.y(), 0);
  EXPECT_LT((other * C - T_CF * C).norm(), 1e-12);
  const Eigen::Vector3d sight = (T_CF * C).normalized();
  const Eigen::Vector3d sum = other.R.col(2) + T_CF.R.col(2);
  EXPECT_LT(sum.cross(sight).norm(), 1e-12);
  EXPECT_GT(distance(other, T_CF), 0.1);
  EXPECT_LT(distance(mirroredPose(other, centre), T_CF), 1e-12);
}

TEST(FindPose, StrayCornersDoNotSpoilIt) {
  SimulatedSession s = recording("euroc", 0);
  auto& views = s.session.cameras[0].views;
  for (ImageView& view : views) {
    for (std::size_t k = 0; k < view.corners.size(); k += 25) {
      view.corners[k].uv += Eigen::Vector2d(150, -90);
    }
  }
  const Intrinsics& camera = s.truth.cameras[0].intrinsics;
  const PackedCorners corners(s.session.target, views);
  PoseRefinementOptions options;
  options.gram.cauchy_px = 1;
  options.max_iterations = 30;
  for (int v = 0; v < corners.viewCount(); ++v) {
    const auto pose = findPose({{&camera, corners.view(v), Transform()}}, 0.1, options);
    ASSERT_TRUE(pose.has_value());
    const Transform truth = truePose(s, 0, views[static_cast<std::size_t>(v)]);
    EXPECT_LT(distance(pose->T_C0F, truth), 0.01) << "view " << v;
  }
}

/// One frame of a stereo recording with its true pose.
struct StereoFrame {
  explicit StereoFrame(double corner_sigma_px) : s(recording("euroc", corner_sigma_px)) {}
  StereoFrame(const StereoFrame&) = delete;  // its views point to its own corners and cameras

  SimulatedSession s;
  const std::vector<CameraCalibration>& cameras = s.truth.cameras;
  PackedCorners left{s.session.target, s.session.cameras[0].views};
  PackedCorners right{s.session.target, s.session.cameras[1].views};
  std::vector<FrameView> views = {
      {&cameras[0].intrinsics, left.view(3), Transform()},
      {&cameras[1].intrinsics, right.view(3), cameras[1].T_C0Ci.inverse()}};
  Transform truth = truePose(s, 0, s.session.cameras[0].views[3]);
};

TEST(RefinePose, ASecondCameraWithKnownExtrinsicsAddsToTheFirst) {
  const StereoFrame frame(0);
  const Transform start = boxplus(frame.truth, Vector6d::Constant(0.03));
  const PoseRefinement pose = refinePose(frame.views, start, {{0, 0}, 20, 1e-8});
  EXPECT_TRUE(pose.converged);
  EXPECT_LT(distance(pose.T_C0F, frame.truth), 1e-9);
  EXPECT_EQ(pose.corners, frame.left.view(3).count + frame.right.view(3).count);
}

TEST(ErrorPx, OfAPoseAsItStandsIsThatOfARefinementWithoutSteps) {
  const StereoFrame frame(0.3);
  // Of both coordinates, 0.3 px each; 288 corners, so that it is within some 12 %.
  EXPECT_NEAR(errorPx(frame.views, frame.truth, {0, 0}), 0.3 * std::sqrt(2), 0.06);
  const Transform off = boxplus(frame.truth, Vector6d::Constant(0.01));
  for (const double cauchy_px : {0.0, 2.0}) {
    EXPECT_NEAR(errorPx(frame.views, off, {cauchy_px, 0}),
                refinePose(frame.views, off, {{cauchy_px, 0}, 0, 1e-8}).errorPx(), 1e-9);
  }
}

TEST(FocalCandidates, TheFirstIsWithinAThirdOfTheTruth) {
  for (const char* rig : {"euroc", "tumvi", "d435i"}) {
    const SimulatedSession s = recording(rig, 0.2);
    const Intrinsics& truth = s.truth.cameras[0].intrinsics;
    const PackedCorners corners(s.session.target, s.session.cameras[0].views);
    std::vector<PackedView> views;
    for (int v = 0; v < corners.viewCount(); ++v) views.push_back(corners.view(v));
    const auto candidates = focalCandidates(truth.projection_model, truth.distortion_model,
                                            s.session.cameras[0].resolution, views);
    ASSERT_FALSE(candidates.empty());
    EXPECT_LT(std::abs(std::log(candidates[0] / truth.projection[0])), std::log(4.0 / 3)) << rig;
  }
}

TEST(FocalCandidates, WithoutViewsAFieldOfAboutSeventyDegreesIsAssumed) {
  const auto candidates =
      focalCandidates(ProjectionModel::kPinhole, DistortionModel::kRadtan, {1000, 800}, {});
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_NEAR(2 * std::atan(500 / candidates[0]) * kDegrees, 71, 1);
}

TEST(MedianTransform, IsNotSpoiledByAThirdOfGrossErrors) {
  const Transform truth(expSO3({0.1, -0.2, 0.3}), Eigen::Vector3d(0.1, 0.02, -0.03));
  std::vector<Transform> all;
  for (int i = 0; i < 30; ++i) {
    Vector6d d = Vector6d::Constant(1e-4 * (i % 5 - 2));
    if (i % 3 == 0) d = Vector6d::Constant(0.5);
    all.push_back(boxplus(truth, d));
  }
  EXPECT_LT(distance(medianTransform(all), truth), 1e-3);
  // The first of them is one; those that are right lie about half a turn away, on both sides.
  for (std::size_t i = 0; i < all.size(); i += 3) all[i].R = expSO3({3.14159, 0, 0}) * truth.R;
  EXPECT_LT(distance(medianTransform(all), truth), 1e-3);
  all.insert(all.end(), all.begin(), all.begin() + 18);  // 48, three times what is tried
  EXPECT_LT(distance(medianTransform(all), truth), 1e-3);
}

TEST(ExtrinsicsFromPoses, AChainOfThreeCamerasIsFollowed) {
  const Transform T_C0C1(expSO3({0, 0.5, 0}), Eigen::Vector3d(0.1, 0, 0));
  const Transform T_C1C2(expSO3({0.2, 0.5, 0}), Eigen::Vector3d(0.1, 0.05, 0));
  std::vector<CameraPoses> poses(3, CameraPoses(20));
  for (std::size_t f = 0; f < 20; ++f) {
    const double a = 0.1 * static_cast<double>(f);
    const Transform T_C0F(expSO3({a, 0.1, -a}), Eigen::Vector3d(a, 0, 1));
    if (f < 12) poses[0][f] = T_C0F;
    poses[1][f] = T_C0C1.inverse() * T_C0F;
    if (f >= 12) poses[2][f] = (T_C0C1 * T_C1C2).inverse() * T_C0F;  // never together with camera 0
  }
  const auto T = extrinsicsFromPoses(poses, {"cam0", "cam1", "cam2"});
  ASSERT_TRUE(T.ok()) << T.failure();
  EXPECT_LT(distance((*T)[1], T_C0C1), 1e-12);
  EXPECT_LT(distance((*T)[2], T_C0C1 * T_C1C2), 1e-12);
}

TEST(ExtrinsicsFromPoses, CamerasThatShareNoFrameAreNamed) {
  std::vector<CameraPoses> poses(3, CameraPoses(4));
  poses[0][0] = poses[1][0] = Transform();
  poses[2][1] = Transform();
  const auto T = extrinsicsFromPoses(poses, {"left", "right", "rear"});
  ASSERT_FALSE(T.ok());
  EXPECT_EQ(toString(T.failure()), "CamerasShareNoFrame (apart rear, together left, right)");
}

/// Pixels per radian of a camera for a ray beside its axis.
Eigen::Vector2d magnification(const Intrinsics& camera) {
  constexpr double kAngle = 1e-5;
  const Eigen::Vector2d middle = project(camera, {0, 0, 1}).value();
  return {(project(camera, {kAngle, 0, 1}).value() - middle).x() / kAngle,
          (project(camera, {0, kAngle, 1}).value() - middle).y() / kAngle};
}

// Also for models whose fu is no scale of the image.
TEST(PlainCamera, HasTheFocalLengthAtItsCentreWhateverTheModel) {
  for (const Intrinsics& example : test::everyModel()) {
    const auto projection = example.projection_model;
    const auto distortion = example.distortion_model;
    if (!canBeCalibrated(projection, distortion)) continue;
    const std::string name = toString(projection) + "-" + toString(distortion);
    const Intrinsics camera = plainCamera(projection, distortion, {640, 480}, 350);
    EXPECT_LT((magnification(camera) - Eigen::Vector2d(350, 350)).norm(), 0.01) << name;
    EXPECT_LT((project(camera, {0, 0, 1}).value() - Eigen::Vector2d(319.5, 239.5)).norm(), 1e-9);
    // And a lens in another model begins with its own.
    const Intrinsics like = plainLike(test::radtanCamera(), projection, distortion);
    const Intrinsics& lens = test::radtanCamera();
    EXPECT_LT((magnification(like) - magnification(lens)).norm(), 3) << name;
    EXPECT_LT((project(like, {0, 0, 1}).value() - project(lens, {0, 0, 1}).value()).norm(), 1e-9)
        << name;
  }
}

TEST(IsWellAhead, EndsAt88DegreesAndBehind) {
  const auto at = [](double degrees) {
    return Eigen::Vector3d(0, std::sin(degrees * kDegree), std::cos(degrees * kDegree));
  };
  EXPECT_TRUE(isWellAhead(at(0)));
  EXPECT_TRUE(isWellAhead(5 * at(88)));
  EXPECT_FALSE(isWellAhead(at(88.2)));
  EXPECT_FALSE(isWellAhead(at(150)));
}

// Of the two poses that explain a tag far away the better one is taken, whichever the homography
// leads to.
TEST(FindPose, OfASmallTagTheMirroredPoseIsTriedAsWell) {
  const AprilGrid target;
  const Intrinsics camera =
      plainCamera(ProjectionModel::kPinhole, DistortionModel::kRadtan, {640, 480}, 400);
  const double half = 0.5 * target.tag_size;
  int better_mirrored = 0;
  for (int k = 0; k < 60; ++k) {
    const Transform truth(
        expSO3({std::numbers::pi + 0.5 * std::sin(k), 0.5 * std::cos(1.7 * k), 0.1 * k}),
        Eigen::Vector3d(0.2, -0.1, 3));
    ImageView view;
    for (const int id : {0, 1, 2, 3}) {
      const Eigen::Vector2d p = target.corner(id);
      const Eigen::Vector2d noise(std::sin(3.1 * k + id), std::cos(5.3 * k - 2 * id));
      const auto uv = project(camera, truth * Eigen::Vector3d(p.x(), p.y(), 0));
      view.corners.push_back({id, uv.value() + 0.3 * noise});
    }
    const PackedCorners corners(target, {view});
    const std::vector<FrameView> views{{&camera, corners.view(0), Transform()}};
    PoseRefinementOptions options;
    options.max_iterations = 50;
    const auto found = findPose(views, 1e-9, options);
    ASSERT_TRUE(found) << k;
    const auto start = homographyPose(camera, corners.view(0));
    const PoseRefinement one = refinePose(views, *start, options);
    const PoseRefinement other = refinePose(views, mirroredPose(*start, {half, half}), options);
    EXPECT_LE(found->cost, 1.001 * std::min(one.cost, other.cost)) << k;
    better_mirrored += other.cost < 0.9 * one.cost ? 1 : 0;
  }
  EXPECT_GE(better_mirrored, 1) << "else the example tells nothing";
}

// To second order the cost grows by the information, in the left twist of the pose.
TEST(RefinePose, InformationIsTheCurvatureOfTheCost) {
  const StereoFrame frame(0);
  const PoseRefinement pose = refinePose(frame.views, frame.truth, {{0, 0}, 20, 1e-8});
  for (int k = 0; k < 6; ++k) {
    const Vector6d d = 1e-4 * Vector6d::Unit(k);
    const double px = errorPx(frame.views, twisted(pose.T_C0F, d), {0, 0});
    const double expected = d.dot(pose.information * d);
    EXPECT_NEAR(px * px * pose.corners, expected, 0.01 * expected) << k;
  }
}

// One frame that a pair of cameras shares, and which misleads, does not stand against many.
TEST(ExtrinsicsFromPoses, TheWayOfMostSharedFramesIsTaken) {
  const Transform T_C0C1(expSO3({0, 0.4, 0}), {0.1, 0, 0});
  const Transform T_C0C2(expSO3({0.1, 0.8, 0}), {0.2, 0.05, 0});
  std::vector<CameraPoses> poses(3, CameraPoses(20));
  for (std::size_t f = 0; f < 20; ++f) {
    const double a = 0.1 * static_cast<double>(f);
    const Transform T_C0F(expSO3({a, 0.1, -a}), Eigen::Vector3d(a, 0, 1));
    if (f < 12) poses[0][f] = T_C0F;
    poses[1][f] = T_C0C1.inverse() * T_C0F;
    if (f >= 11) poses[2][f] = T_C0C2.inverse() * T_C0F;
  }
  *poses[2][11] = Transform(expSO3({1, 1, 1}), {3, 2, 1});  // the only one with camera 0
  const auto T = extrinsicsFromPoses(poses, {"cam0", "cam1", "cam2"});
  ASSERT_TRUE(T.ok());
  EXPECT_LT(distance((*T)[2], T_C0C2), 1e-9);
}

TEST(RefinePose, RefusesOptionsOutOfRange) {
  EXPECT_THROW(refinePose({}, Transform(), {.max_iterations = -1}), InputError);
  EXPECT_THROW(refinePose({}, Transform(), {.tolerance = 0}), InputError);
}

}  // namespace
}  // namespace plumbline

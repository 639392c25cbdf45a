// SPDX-License-Identifier: BSD-3-Clause
// The Gram matrix of a view against derivatives found without it: Jets and central differences.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/view_gram.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/example_view.h"

namespace plumbline {
namespace {

using GramJet = ceres::Jet<double, 14>;
using Vector14d = Eigen::Matrix<double, 14, 1>;
using Matrix14d = Eigen::Matrix<double, 14, 14>;

const AprilGrid kTarget;

struct Scene {
  Intrinsics camera;
  Transform T_CF = test::examplePose();
  PackedCorners corners;
};

Scene sceneOf(const Intrinsics& camera) {
  Scene scene{camera, test::examplePose(), {}};
  const ImageView view = test::noisyView(kTarget, camera, scene.T_CF, 76, 1.5, 7);
  scene.corners = PackedCorners(kTarget, {view});
  return scene;
}

// The errors of all corners as Jets in (twist, intrinsics).
std::vector<GramJet> errorsAsJets(const Scene& scene) {
  const Eigen::VectorXd k = scene.camera.stacked();
  GramJet twist[6], parameter[8];
  for (int i = 0; i < 6; ++i) twist[i] = GramJet(0.0, i);
  for (int i = 0; i < 8; ++i) parameter[i] = GramJet(k[i], 6 + i);
  const PackedView view = scene.corners.view(0);
  std::vector<GramJet> errors;
  for (int i = 0; i < view.count; ++i) {
    const Eigen::Vector3d p = scene.T_CF * Eigen::Vector3d(view.x[i], view.y[i], 0);
    const GramJet X = p.x() + twist[0] + twist[4] * p.z() - twist[5] * p.y();
    const GramJet Y = p.y() + twist[1] + twist[5] * p.x() - twist[3] * p.z();
    const GramJet Z = p.z() + twist[2] + twist[3] * p.y() - twist[4] * p.x();
    std::visit(
        [&]<class Model>(Model) {
          if constexpr (kIsVectorised<Model>) {
            const auto m = Model::image(parameter + 4, X, Y, Z);
            errors.push_back(parameter[0] * m.x + parameter[2] - view.u[i]);
            errors.push_back(parameter[1] * m.y + parameter[3] - view.v[i]);
          }
        },
        cameraModelOf(scene.camera));
  }
  return errors;
}

TEST(ViewGram, EqualsTheProductOfJetJacobians) {
  for (const Intrinsics& camera : test::allCameras()) {
    const Scene scene = sceneOf(camera);
    Matrix14d H = Matrix14d::Zero();
    Vector14d b = Vector14d::Zero();
    for (const GramJet& e : errorsAsJets(scene)) {
      H += e.v * e.v.transpose();
      b += e.v * e.a;
    }
    const ViewGram gram = viewGram(camera, scene.T_CF, scene.corners.view(0));
    Matrix14d ours;
    ours << gram.H, gram.H_pose_k, gram.H_pose_k.transpose(), gram.H_k;
    Vector14d our_b;
    our_b << gram.b, gram.b_k;
    const Vector14d scale = H.diagonal().cwiseSqrt().cwiseInverse();
    EXPECT_LT((scale.asDiagonal() * (ours - H) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((scale.asDiagonal() * (our_b - b)).cwiseAbs().maxCoeff(), 1e-10);
  }
}

// The cost after a step in the tangent of T_CF (first six) and the intrinsics.
double costAt(const Scene& scene, const Vector14d& d, const GramOptions& options) {
  Intrinsics camera = scene.camera;
  camera.setStacked(camera.stacked() + d.tail<8>());
  return viewCost(camera, boxplus(scene.T_CF, d.head<6>()), scene.corners.view(0), options);
}

TEST(ViewGram, GradientIsHalfTheSlopeOfTheCostWithAndWithoutLoss) {
  for (const Intrinsics& camera : test::allCameras()) {
    const Scene scene = sceneOf(camera);
    for (const GramOptions& options : {GramOptions{}, GramOptions{.cauchy_px = 1.5}}) {
      const ViewGram gram = viewGram(camera, scene.T_CF, scene.corners.view(0), options);
      Vector14d b;
      b << twistFromTangent(scene.T_CF).transpose() * gram.b, gram.b_k;
      for (int i = 0; i < 14; ++i) {
        // A step that moves a corner by some 1e-3 px: errors of 1e-6 from the third derivative and
        // of 1e-11 of the cost from rounding.
        const double size = i < 6 ? gram.H(i, i) : gram.H_k(i - 6, i - 6);
        const double step = 1e-2 / std::sqrt(size);
        const Vector14d d = step * Vector14d::Unit(i);
        const double slope = (costAt(scene, d, options) - costAt(scene, -d, options)) / (2 * step);
        EXPECT_NEAR(2 * b[i], slope, 1e-5 * std::sqrt(size * gram.cost)) << "parameter " << i;
      }
    }
  }
}

TEST(ViewGram, HIsHalfTheCurvatureOfTheCostForSmallErrors) {
  // Without noise the Gauss-Newton matrix is the Hessian, and the Cauchy loss starts as |e|^2.
  const Intrinsics camera = test::radtanCamera();
  Scene scene{camera, test::examplePose(), {}};
  scene.corners = PackedCorners(kTarget, {test::noisyView(kTarget, camera, scene.T_CF, 100, 0, 1)});
  for (const GramOptions& options : {GramOptions{}, GramOptions{.cauchy_px = 1.5}}) {
    const ViewGram gram = viewGram(camera, scene.T_CF, scene.corners.view(0), options);
    for (int i = 0; i < 8; ++i) {
      const double step = 1e-2 / std::sqrt(gram.H_k(i, i));
      const Vector14d d = step * Vector14d::Unit(6 + i);
      const double curvature = (costAt(scene, d, options) + costAt(scene, -d, options) -
                                2 * costAt(scene, Vector14d::Zero(), options)) /
                               (step * step);
      EXPECT_NEAR(2 * gram.H_k(i, i), curvature, 1e-4 * curvature) << "parameter " << i;
    }
  }
}

TEST(ViewGram, TheClampedCurvatureLiesBetweenReweightingAndTheFullSecondDerivative) {
  const Scene scene = sceneOf(test::radtanCamera());
  const auto smallest = [&](double clamp) {
    const GramOptions options{.cauchy_px = 1.5, .triggs_clamp = clamp};
    return viewGram(scene.camera, scene.T_CF, scene.corners.view(0), options).H;
  };
  const Matrix6d reweighted = smallest(0);
  const Matrix6d clamped = smallest(0.7);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> removed(reweighted - clamped);
  EXPECT_GT(removed.eigenvalues().minCoeff(), 0);
  EXPECT_EQ(Eigen::LLT<Matrix6d>(clamped).info(), Eigen::Success);
  EXPECT_EQ(Eigen::LLT<Matrix6d>(clamped - 0.3 * reweighted).info(), Eigen::Success);
}

}  // namespace
}  // namespace plumbline

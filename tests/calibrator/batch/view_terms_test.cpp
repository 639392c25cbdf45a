// SPDX-License-Identifier: BSD-3-Clause
// What views of a stereo rig say of its cameras and of a misfit field, against sums over corners
// with dense rows, and against the information that the batch finds.
#include "calibrator/batch/camera/view_terms.h"

#include <Eigen/Cholesky>
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/camera/camera.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulatedSession viewsRecording(double sigma_px) {
  SimulationOptions simulation;
  simulation.duration_s = 8;
  simulation.camera_rate_hz = 4;
  simulation.imu_rate_hz = 10;
  simulation.corner_sigma_px = sigma_px;
  return simulateSession(simulatedRig("euroc"), simulation);
}

const double kHalfDiagonal = 0.5 * std::hypot(752, 480);  // [px]

/// A stereo recording at its own calibration.
struct SolvedViews {
  SimulatedSession simulated;
  CameraStageResult result;
  std::vector<PackedCorners> corners;
  CameraProblem problem;
  CameraEstimate estimate;
  std::vector<RigView> views;

  /// r7_px: the lenses displace the ends of the image's half diagonal outwards by so much, as r^7.
  explicit SolvedViews(double sigma_px = 0.3, double r7_px = 0)
      : simulated(viewsRecording(sigma_px)) {
    for (std::size_t c = 0; c < simulated.session.cameras.size(); ++c) {
      const Eigen::Vector2d axis = simulated.truth.cameras[c].intrinsics.projection.tail<2>();
      for (ImageView& view : simulated.session.cameras[c].views) {
        for (Corner& corner : view.corners) {
          const Eigen::Vector2d d = (corner.uv - axis) / kHalfDiagonal;
          corner.uv += r7_px * std::pow(d.norm(), 6) * d;
        }
      }
    }
    CameraStageOptions options;
    options.cauchy_px = 0;
    options.pixel_sigma = 0.3;
    result = calibrateCameras(simulated.session, options).value();
    corners = usedCorners(simulated.session, result.frames, result.residuals);
    problem.corners = corners;
    problem.frames = result.frames;
    problem.pixel_sigma = 0.3;
    estimate = estimateOf(result.cameras, result.T_FC0);
    for (std::size_t f = 0; f < result.frames.size(); ++f) {
      RigView rig;
      rig.T_C0F = estimate.T_C0F[f];
      for (std::size_t c = 0; c < 2; ++c) {
        const int view = result.frames[f].view[c];
        rig.views.push_back(view >= 0 ? corners[c].view(view) : PackedView{});
      }
      views.push_back(std::move(rig));
    }
  }
};

const SolvedViews& solved() {
  static const SolvedViews s;
  return s;
}

/// Rows (twist of T_C0F 6, cameras 22, fields 100, error) of all corners of a frame, squared up,
/// the twist eliminated.
Eigen::MatrixXd denseTerms(const SolvedViews& s, const RigView& rig,
                           const std::vector<FieldBox>& box) {
  constexpr int kColumns = 6 + 22 + 2 * kFieldColumns + 1;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kColumns, kColumns);
  for (std::size_t c = 0; c < 2; ++c) {
    const Transform T_CiC0 = s.estimate.T_C0Ci[c].inverse();
    const PackedView& view = rig.views[c];
    for (int i = 0; i < view.count; ++i) {
      const Eigen::Vector3d p_0 = rig.T_C0F * Eigen::Vector3d(view.x[i], view.y[i], view.z[i]);
      const Projection at = projectWithJacobians(s.estimate.intrinsics[c], T_CiC0 * p_0).value();
      const Eigen::Matrix<double, 2, 3> by_p0 = at.J_point * T_CiC0.R;
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, kColumns);
      J.leftCols(3) = by_p0;
      J.middleCols(3, 3) = -by_p0 * skew(p_0);
      J.middleCols(6 + 8 * static_cast<int>(c), 8) = at.J_intrinsics;
      if (c == 1) {
        // By the tangent of T_C0C1 (boxplus): p_C1 = R^T Exp(-phi) (p_C0 - t - rho).
        J.middleCols(22, 3) = -by_p0;
        J.middleCols(25, 3) = by_p0 * skew(Eigen::Vector3d(p_0 - s.estimate.T_C0Ci[c].t));
      }
      const Eigen::Vector2d uv(view.u[i], view.v[i]);
      const auto f = fieldFunctions(box[c], uv);
      const int at_field = 28 + kFieldColumns * static_cast<int>(c);
      J.block<1, kFieldFunctions>(0, at_field) = f.transpose();
      J.block<1, kFieldFunctions>(1, at_field + kFieldFunctions) = f.transpose();
      J.rightCols<1>() = at.uv - uv;
      A += J.transpose() * J;
    }
  }
  const Eigen::MatrixXd X = A.topRows<6>();
  return A - X.transpose() * A.topLeftCorner<6, 6>().ldlt().solve(X);
}

TEST(ViewTerms, AreTheSumsOverCornersWithoutThePose) {
  const SolvedViews& s = solved();
  const auto boxes = seenBoxes(s.views, s.estimate);
  const ViewTermsMaker maker(s.estimate, {boxes, {}}, 0);
  for (const std::size_t f : {std::size_t{0}, s.views.size() / 2}) {
    const ViewTerms terms = maker.seen(s.views[f]);
    const Eigen::MatrixXd dense = denseTerms(s, s.views[f], boxes);
    const int F = 2 * kFieldColumns;
    EXPECT_LT((terms.I - dense.block(6, 6, 22, 22)).norm(), 1e-8 * terms.I.norm());
    EXPECT_LT((terms.C - dense.block(6, 28, 22, F)).norm(), 1e-8 * terms.I.norm());
    EXPECT_LT((terms.D - dense.block(28, 28, F, F)).norm(), 1e-7 * terms.D.norm());
    EXPECT_LT((terms.s - dense.block(28, 28 + F, F, 1)).norm(), 1e-7 * terms.s.norm());
  }
}

TEST(ViewTerms, TheInformationIsTheBatchs) {
  const SolvedViews& s = solved();
  const auto shares = frameInformation(s.problem, s.estimate);
  const ViewTermsMaker maker(s.estimate, {seenBoxes(s.views, s.estimate), {}}, 0);
  for (std::size_t f = 0; f < s.views.size(); ++f) {
    const Eigen::MatrixXd I = maker.seen(s.views[f]).I / (0.3 * 0.3);
    EXPECT_LT((I - shares[f]).norm(), 1e-8 * shares[f].norm()) << f;
  }
}

TEST(ViewTerms, CombinationsOfFieldsAreTheirProducts) {
  const SolvedViews& s = solved();
  const auto model = errorModel(s.views, s.estimate, 0, LaterUseKind::kSeen);
  ASSERT_TRUE(model);
  const MisfitField& field = model->maker.field();
  const ViewTermsMaker each(s.estimate, {field.boxes, {}}, 0);
  const ViewTerms all = each.seen(s.views[3]);
  const ViewTerms few = model->maker.seen(s.views[3]);
  EXPECT_EQ(few.C.cols(), 16);
  EXPECT_LT((few.C - all.C * field.columns).norm(), 1e-9 * all.C.norm());
  EXPECT_LT((few.D - field.columns.transpose() * all.D * field.columns).norm(),
            1e-9 * all.D.norm());
  EXPECT_LT((few.s - field.columns.transpose() * all.s).norm(), 1e-9 * all.s.norm());
  const ViewTerms imagined = model->maker.imagined(s.views[3]);
  EXPECT_EQ(imagined.I, few.I);
  // Products with fields have single precision here, and the pose takes most of them.
  EXPECT_LT((imagined.C - few.C).norm(), 1e-4 * few.C.norm());
}

TEST(ViewTerms, SinglePrecisionDoesNotChangeThePredictedError) {
  const SolvedViews& s = solved();
  const auto model = errorModel(s.views, s.estimate, 0, LaterUseKind::kImage);
  ASSERT_TRUE(model);
  // As much misfit as guarded() lets in.
  ErrorComponents components;
  components.sigma2 = 0.09;
  components.b2 = 0.45 * components.sigma2;
  components.tau2 = components.sigma2 / 9;
  PredictedError error(model->use, components);
  for (std::size_t kept = 1; kept <= 8; ++kept) {
    error.add(model->maker.seen(s.views[kept - 1]));
    // Rounding weighs the more the less the views tell.
    const double bound = kept < 3 ? 5e-3 : 2e-4;
    for (std::size_t i = 8; i < s.views.size(); ++i) {
      const double exact = error.valueWith(model->maker.seen(s.views[i]));
      const double single = error.valueWith(model->maker.imagined(s.views[i]));
      EXPECT_NEAR(single / exact, 1, bound) << kept << " views";
    }
  }
}

/// Lenses with r^7, and what of it is left once parameters and poses have taken their part.
struct WideLenses {
  static constexpr double kEdge_px = 10;  // radtan leaves a thousandth of it, RMS
  SolvedViews s{0.02, kEdge_px};
  std::vector<FieldBox> boxes = seenBoxes(s.views, s.estimate);
  Eigen::VectorXd misfit = Eigen::VectorXd::Zero(2 * kFieldColumns);
  Eigen::MatrixXd M;

  WideLenses() {
    for (int c = 0; c < 2; ++c) {
      const double px = kEdge_px * std::pow(boxes[c].half.norm() / kHalfDiagonal, 7);
      misfit[c * kFieldColumns + kFieldPolynomials] = px;
      misfit[c * kFieldColumns + kFieldFunctions + kFieldPolynomials + 1] = px;
    }
    const LaterUse use = laterUse(terms({}));
    M = use.D - use.C.transpose() * use.H.ldlt().solve(use.C);
  }

  std::vector<ViewTerms> terms(const Eigen::MatrixXd& columns) const {
    const ViewTermsMaker maker(s.estimate, {boxes, columns}, 0);
    std::vector<ViewTerms> terms;
    for (const RigView& view : s.views) terms.push_back(maker.seen(view));
    return terms;
  }

  /// Of a field in these columns and the misfit, by what corners show of either.
  double cosine(const Eigen::VectorXd& field) const {
    const Eigen::VectorXd shown = M * misfit;
    return field.dot(shown) / std::sqrt(field.dot(M * field) * misfit.dot(shown));
  }
};

/// The residuals' estimate of the common misfit, up to its sign: sharedMoment() is beta beta^T + P,
/// and P what it is of residuals that show nothing.
Eigen::VectorXd sharedMisfit(const ErrorComponents& found, Eigen::Index functions) {
  ErrorComponents blind = found;
  blind.shared.s.setZero();
  const SymmetricEigen beta =
      symmetricEigen(sharedMoment(found, functions) - sharedMoment(blind, functions));
  const Eigen::Index last = functions - 1;
  return beta.vectors.col(last) * std::sqrt(std::max(0.0, beta.values[last]));
}

// Radtan takes of a radial displacement what goes with r^5, and polynomials of that degree have
// nothing of the rest.
TEST(ErrorModel, FindsWhatRadtanMissesOfAWideLens) {
  const WideLenses wide;
  const auto model = errorModel(wide.s.views, wide.s.estimate, 0, LaterUseKind::kSeen);
  ASSERT_TRUE(model);
  const Eigen::MatrixXd& all = model->maker.field().columns;
  const auto found = [&](const Eigen::MatrixXd& columns) {
    const ErrorComponents components = errorComponents(wide.terms(columns));
    return Eigen::VectorXd(columns * sharedMisfit(components, columns.cols()));
  };
  // The field in these columns that comes nearest to the misfit.
  const Eigen::MatrixXd weighted = all.transpose() * wide.M;
  const double nearest = wide.cosine(all * (weighted * all).ldlt().solve(weighted * wide.misfit));
  // Noise of 0.02 px over the corners of 32 frames leaves a tenth of the misfit's length open.
  EXPECT_GT(std::abs(wide.cosine(found(all))), 0.9 * nearest);
  EXPECT_GT(nearest, std::sqrt(0.5));
  EXPECT_LT(std::abs(wide.cosine(found(all.leftCols(12)))), 0.5 * nearest);  // not the radial ones
}

TEST(ViewTerms, AFrameWithoutAPoseSaysNothing) {
  const SolvedViews& s = solved();
  const ViewTermsMaker maker(s.estimate, {seenBoxes(s.views, s.estimate), {}}, 0);
  const RigView nothing{{PackedView{}, PackedView{}}, Transform()};
  EXPECT_EQ(maker.seen(nothing).corners, 0);
  // Two corners of one camera: some pose always explains them.
  const CameraStream& stream = s.simulated.session.cameras[0];
  ImageView two = stream.views[static_cast<std::size_t>(s.result.frames[0].view[0])];
  two.corners.resize(2);
  const PackedCorners packed(s.simulated.session.target, std::vector<ImageView>{two});
  const ViewTerms terms = maker.seen({{packed.view(0), PackedView{}}, s.views[0].T_C0F});
  EXPECT_EQ(terms.corners, 0);
  EXPECT_EQ(terms.I.norm() + terms.C.norm() + terms.D.norm() + terms.s.norm(), 0);
}

TEST(CellWeights, RaiseWhatIsRarelySeen) {
  const SolvedViews& s = solved();
  const auto seen = cellWeights(s.views, s.estimate, LaterUseKind::kSeen);
  const auto image = cellWeights(s.views, s.estimate, LaterUseKind::kImage);
  ASSERT_EQ(seen.size(), 96u);
  std::vector<double> counts(96, 0);
  double all = 0;
  for (const RigView& rig : s.views) {
    for (std::size_t c = 0; c < 2; ++c) {
      for (int i = 0; i < rig.views[c].count; ++i) {
        const int cell = CornerCells::cellOf(rig.views[c].u[i], rig.views[c].v[i],
                                             s.estimate.intrinsics[c].resolution);
        counts[48 * c + static_cast<std::size_t>(cell)] += 1;
        all += 1;
      }
    }
  }
  for (std::size_t i = 0; i < 96; ++i) {
    if (counts[i] == 0) continue;
    const double q = all / 96 / counts[i];
    EXPECT_NEAR(seen[i], 1 + 0.06 * std::min(q, 50.0), 1e-12);
    EXPECT_NEAR(image[i], std::min(q, 20.0), 1e-12);
  }
}

// Residuals of 0.3 px under a loss of 0.3 px: views used count for half of what they are without,
// what later use asks does not know the residuals.
TEST(ErrorModel, LaterUseCountsCornersWithoutTheLoss) {
  const SolvedViews& s = solved();
  const auto plain = errorModel(s.views, s.estimate, 0, LaterUseKind::kSeen);
  const auto robust = errorModel(s.views, s.estimate, 0.3, LaterUseKind::kSeen);
  ASSERT_TRUE(plain && robust);
  EXPECT_EQ(plain->use.H, robust->use.H);
  EXPECT_EQ(plain->use.D, robust->use.D);
  const double all = plain->maker.seen(s.views[3]).I.trace();
  EXPECT_LT(robust->maker.seen(s.views[3]).I.trace(), 0.8 * all);
}

TEST(ErrorModel, NothingFromTooFewFrames) {
  const SolvedViews& s = solved();
  EXPECT_FALSE(errorModel({}, s.estimate, 0, LaterUseKind::kSeen));
  RigView one = s.views[0];
  one.views[1] = PackedView{};  // T_C0C1 stays free
  EXPECT_FALSE(errorModel({one}, s.estimate, 0, LaterUseKind::kSeen));
}

TEST(SelectViewsByError, FewByPredictedErrorAreNearlyAsGoodAsAll) {
  const SolvedViews& s = solved();
  CameraStageOptions options;
  options.cauchy_px = 0;
  options.pixel_sigma = 0.3;
  options.select_views = ViewSelectionOptions{};
  options.select_views->criterion = ViewCriterion::kPredictedError;
  const auto few = calibrateCameras(s.simulated.session, options);
  ASSERT_TRUE(few.ok()) << few.failure();
  EXPECT_GE(few->frames.size(), 8u);
  EXPECT_LE(few->frames.size(), 14u);
  ASSERT_GT(s.result.frames.size(), 25u);
  CameraStageOptions score;
  score.cauchy_px = 0;
  const auto scored = scoreCameras(s.simulated.session, few->cameras, score);
  ASSERT_TRUE(scored.ok());
  const double excess =
      scored->summary.reprojection.rmse_px / s.result.summary.reprojection.rmse_px - 1;
  EXPECT_GT(excess, 0);
  // Predicted: at most 2 %, and the views that were chosen are among those that are scored.
  EXPECT_LT(excess, 0.03);
}

TEST(SelectViewsByError, AViewOfSeveralPixelsIsNotTaken) {
  const SolvedViews& s = solved();
  Session spoilt = s.simulated.session;
  for (CameraStream& camera : spoilt.cameras) {
    for (std::size_t i = 0; i < camera.views[5].corners.size(); ++i) {
      camera.views[5].corners[i].uv += Eigen::Vector2d(i % 2 == 0 ? 6 : -6, i % 3 == 0 ? 6 : -3);
    }
  }
  CameraStageOptions options;
  options.cauchy_px = 0;
  options.select_views = ViewSelectionOptions{};
  options.select_views->criterion = ViewCriterion::kPredictedError;
  const auto few = calibrateCameras(spoilt, options);
  ASSERT_TRUE(few.ok()) << few.failure();
  const TimeNs t = spoilt.cameras[0].views[5].t;
  for (const Frame& frame : few->frames) EXPECT_NE(frame.t, t);
}

}  // namespace
}  // namespace plumbline

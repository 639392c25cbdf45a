// SPDX-License-Identifier: BSD-3-Clause
// The board's own shape, estimated together with the cameras.
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

SimulationOptions recordingOf(const TargetTerms& terms, double sigma_px) {
  SimulationOptions options;
  options.duration_s = 15;
  options.camera_rate_hz = 5;
  options.corner_sigma_px = sigma_px;
  options.target.shape.terms = terms;
  return options;
}

/// Bowed, stretched and keystoned by some tenths of a millimetre, as real boards are.
TargetTerms bentTerms() {
  TargetTerms terms;
  terms << 4e-4, -1.5e-4, 0, 0.2e-4, -1e-4, 0, 2e-4, 0, -3e-4, 0.5e-4, -1e-4, 0;
  return terms;
}

CameraStageOptions estimating(TargetMode mode, double pixel_sigma = 1) {
  CameraStageOptions options;
  options.cauchy_px = 0;
  options.pixel_sigma = pixel_sigma;
  options.target = mode;
  return options;
}

/// Of the cameras' parameters, in standard deviations.
double largestError(const CameraStageResult& result, const Calibration& truth) {
  const Eigen::VectorXd error = cameraDifference(result.cameras, truth.cameras);
  return error.cwiseQuotient(result.summary.covariance.standardDeviations()).cwiseAbs().maxCoeff();
}

TEST(CameraTarget, RecoversABentBoardWithoutNoise) {
  for (const char* rig : {"euroc", "tumvi"}) {
    const auto s = simulateSession(simulatedRig(rig), recordingOf(bentTerms(), 0));
    EXPECT_TRUE(s.session.target.shape.isFlat());  // what target.yaml says
    const auto result = calibrateCameras(s.session, estimating(TargetMode::kEstimate));
    ASSERT_TRUE(result.ok()) << result.failure();
    // The prior of 5 mm pulls by a millionth of what a pixel of noise does.
    EXPECT_LT((result->target.terms - bentTerms()).norm(), 1e-7);
    EXPECT_LT(largestError(*result, s.truth), 1e-3);
    EXPECT_LT(result->summary.reprojection.rmse_px, 1e-4);
  }
}

/// The bent board in noise: shared, and so is what its recording gives where the board is estimated
/// as asked.
const SimulatedSession& noisyBent() {
  static const SimulatedSession s =
      simulateSession(simulatedRig("euroc"), recordingOf(bentTerms(), 0.2));
  return s;
}

const Result<CameraStageResult>& noisyBentByItself() {
  static const auto result =
      calibrateCameras(noisyBent().session, estimating(TargetMode::kAuto, 0.2));
  return result;
}

// The tags of EuRoC's imu_april look 0.3 px smaller on either side, near and far.
TEST(CameraTarget, RecoversTagsThatLookSmallerByPixels) {
  TargetTerms terms = bentTerms();
  terms[kTargetTerms - 1] = -5e-4;
  const auto s = simulateSession(simulatedRig("euroc"), recordingOf(terms, 0));
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kEstimate));
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_NEAR(result->target.terms[kTargetTerms - 1], -5e-4, 5e-6);
  EXPECT_LT((result->target.terms - terms).head<kTargetTerms - 1>().norm(), 3e-6);
  EXPECT_LT(result->summary.reprojection.rmse_px, 0.01);
}

/// Error of a result's board, without tag_edge [m].
double boardError(const CameraStageResult& result, const TargetTerms& truth) {
  return (result.target.terms - truth).head<kTargetTerms - 1>().norm();
}

// A board measured on another day, with tags that looked wider there: what it knows is used within
// its deviations, the tags' edges are found anew.
TEST(CameraTarget, AKnownBoardHoldsWithTheTagsEdgeOfTheRecording) {
  SimulationOptions recording = recordingOf(bentTerms(), 0.2);
  recording.duration_s = 3;
  SimulatedSession s = simulateSession(simulatedRig("euroc"), recording);
  const auto flat = calibrateCameras(s.session, estimating(TargetMode::kGiven, 0.2));
  s.session.target.shape.terms = bentTerms();
  s.session.target.shape.terms[kTargetTerms - 1] = 1e-3;
  s.session.target.shape.covariance = TargetCovariance::Identity() * 1e-10;  // 10 um
  const auto exact = calibrateCameras(s.session, estimating(TargetMode::kGiven, 0.2));
  const auto known = calibrateCameras(s.session, estimating(TargetMode::kKnown, 0.2));
  ASSERT_TRUE(known.ok() && exact.ok() && flat.ok());
  EXPECT_LT(boardError(*known, bentTerms()), 3e-5);
  EXPECT_NEAR(known->target.terms[kTargetTerms - 1], 0, 5e-5);
  EXPECT_LT(largestError(*known, s.truth), 4);
  EXPECT_GT(largestError(*flat, s.truth), 6);
  EXPECT_LT(known->summary.reprojection.rmse_px, 0.3);  // sqrt(2) 0.2
  EXPECT_GT(exact->summary.reprojection.rmse_px, 0.4);
  ASSERT_TRUE(known->target_fit);
  EXPECT_EQ(known->target_fit->finding, TargetFinding::kKnown);
}

TEST(CameraTarget, AnotherBoardsShapeIsSaidToBeAnothers) {
  SimulatedSession s = simulateSession(simulatedRig("euroc"), recordingOf(bentTerms(), 0.2));
  s.session.target.shape.terms = -bentTerms();
  s.session.target.shape.covariance = TargetCovariance::Identity() * 1e-10;
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kKnown, 0.2));
  ASSERT_TRUE(result.ok() && result->target_fit);
  EXPECT_EQ(result->target_fit->finding, TargetFinding::kOther);
  EXPECT_LT((result->target_fit->shape.terms - bentTerms()).norm(), 5e-5);  // what it is
}

TEST(CameraTarget, FindsABentBoardBentAndAFlatOneFlat) {
  const auto& found = noisyBentByItself();
  ASSERT_TRUE(found.ok() && found->target_fit);
  EXPECT_EQ(found->target_fit->finding, TargetFinding::kBent);
  EXPECT_LT(found->target_fit->held_out_px, 0.9 * found->target_fit->flat_held_out_px);
  EXPECT_LT(largestError(*found, noisyBent().truth), 4);

  const auto flat = simulateSession(simulatedRig("euroc"), recordingOf(TargetTerms::Zero(), 0.2));
  const auto kept = calibrateCameras(flat.session, estimating(TargetMode::kAuto, 0.2));
  const auto stated = calibrateCameras(flat.session, estimating(TargetMode::kGiven, 0.2));
  ASSERT_TRUE(kept.ok() && kept->target_fit && stated.ok());
  EXPECT_EQ(kept->target_fit->finding, TargetFinding::kAsStated);
  EXPECT_TRUE(kept->target.isFlat());
  EXPECT_EQ(kept->summary.cost, stated->summary.cost);
  EXPECT_EQ(kept->summary.covariance.matrix, stated->summary.covariance.matrix);
}

// The filter's further solutions move the board too.
TEST(CameraTarget, TheFitIsOfTheBoardThatAFilterLeaves) {
  SimulationOptions recording = recordingOf(bentTerms(), 0.2);
  recording.duration_s = 3;
  const auto s = simulateSession(simulatedRig("euroc"), recording);
  CameraStageOptions options = estimating(TargetMode::kEstimate, 0.2);
  const auto all = calibrateCameras(s.session, options);
  options.filter = CornerFilter::kSigma;
  options.filter_sigmas = 2.5;
  const auto filtered = calibrateCameras(s.session, options);
  ASSERT_TRUE(all.ok() && filtered.ok() && filtered->target_fit);
  EXPECT_NE(filtered->target.terms, all->target.terms);
  EXPECT_EQ(filtered->target.terms, filtered->target_fit->shape.terms);
  EXPECT_NE(filtered->target_fit->std, all->target_fit->std);
}

// Whether a recording determines the board is no matter of the noise that is stated.
TEST(CameraTarget, TheFitsDeviationsAreAtTheNoiseOfTheCorners) {
  SimulationOptions recording = recordingOf(bentTerms(), 0.2);
  recording.duration_s = 3;
  const auto s = simulateSession(simulatedRig("euroc"), recording);
  const auto matched = calibrateCameras(s.session, estimating(TargetMode::kEstimate, 0.2));
  const auto larger = calibrateCameras(s.session, estimating(TargetMode::kEstimate, 1));
  ASSERT_TRUE(matched.ok() && matched->target_fit && larger.ok() && larger->target_fit);
  const TargetTerms ratio = larger->target_fit->std.cwiseQuotient(matched->target_fit->std);
  EXPECT_NEAR(ratio.minCoeff(), 1, 0.05);
  EXPECT_NEAR(ratio.maxCoeff(), 1, 0.05);
}

TEST(CameraTarget, AKnownShapeGivesTheCamerasBack) {
  auto s = simulateSession(simulatedRig("euroc"), recordingOf(bentTerms(), 0));
  s.session.target.shape.terms = bentTerms();
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kGiven));
  ASSERT_TRUE(result.ok());
  EXPECT_LT(largestError(*result, s.truth), 1e-6);
  EXPECT_EQ(result->target.terms, bentTerms());
}

TEST(CameraTarget, AFlatBoardInItsPlaceBiasesTheCameras) {
  const SimulatedSession& s = noisyBent();
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kGiven, 0.2));
  ASSERT_TRUE(result.ok());
  EXPECT_GT(largestError(*result, s.truth), 8);
}

TEST(CameraTarget, DoesNotDependOnTheNumberOfThreads) {
  CameraStageOptions options = estimating(TargetMode::kAuto, 0.2);
  const auto& one = noisyBentByItself();
  options.threads = 3;
  const auto three = calibrateCameras(noisyBent().session, options);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->target.terms, three->target.terms);
  EXPECT_EQ(one->target_fit->gain_px2, three->target_fit->gain_px2);
  EXPECT_EQ(one->target_fit->std, three->target_fit->std);
}

TEST(CameraTarget, DrawsOfABootstrapEstimateTheBoardAgain) {
  const SimulatedSession& s = noisyBent();
  const CameraStageOptions options = estimating(TargetMode::kEstimate, 0.2);
  const auto result = calibrateCameras(s.session, options);
  ASSERT_TRUE(result.ok());
  const int half = static_cast<int>(result->frames.size()) / 2;
  const auto again = recalibrateCameras(s.session, *result, {{0, half, 1}}, options);
  ASSERT_TRUE(again.ok());
  EXPECT_NE(again->target.terms, result->target.terms);
  EXPECT_LT((again->target.terms - bentTerms()).norm(), 1e-4);
}

/// Bent, and in an S of 0.1 mm besides.
TargetShape higherShape() {
  TargetShape shape;
  shape.terms = bentTerms();
  shape.higher = HigherTerms::Zero();
  (*shape.higher)[1] = 4e-5;                      // along x, cubic
  (*shape.higher)[kHigherFunctions + 5] = -3e-5;  // along y, quartic
  (*shape.higher)[2 * kHigherFunctions] = 1e-4;   // height, cubic
  return shape;
}

SimulatedSession recordedHigher(double sigma_px) {
  SimulationOptions recording = recordingOf(bentTerms(), sigma_px);
  recording.target.shape = higherShape();
  return simulateSession(simulatedRig("euroc"), recording);
}

/// Shared likewise.
const SimulatedSession& noisyHigher() {
  static const SimulatedSession s = recordedHigher(0.2);
  return s;
}

const Result<CameraStageResult>& noisyHigherByItself() {
  static const auto result =
      calibrateCameras(noisyHigher().session, estimating(TargetMode::kAuto, 0.2));
  return result;
}

TEST(CameraTarget, RecoversTermsOfHigherDegreesWithoutNoise) {
  const auto s = recordedHigher(0);
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kAuto));
  ASSERT_TRUE(result.ok()) << result.failure();
  ASSERT_TRUE(result->target.higher);
  EXPECT_LT((*result->target.higher - *higherShape().higher).norm(), 2e-6);
  EXPECT_LT((result->target.terms - bentTerms()).norm(), 2e-6);
  EXPECT_LT(result->summary.reprojection.rmse_px, 2e-3);
}

TEST(CameraTarget, FindsTermsOfHigherDegreesWithinTheirNoise) {
  const SimulatedSession& s = noisyHigher();
  const auto& result = noisyHigherByItself();
  ASSERT_TRUE(result.ok() && result->target_fit && result->target.higher);
  const TargetFit& fit = *result->target_fit;
  EXPECT_GT(*fit.higher_gain_px2, 2 * *fit.higher_gain_std_px2);
  EXPECT_LT(*fit.higher_held_out_px, fit.held_out_px);
  EXPECT_EQ(fit.shape.higher, result->target.higher);
  EXPECT_LT((*result->target.higher - *higherShape().higher).norm(), 3e-5);
  EXPECT_LT(largestError(*result, s.truth), 4);

  CameraStageOptions twelve = estimating(TargetMode::kAuto, 0.2);
  twelve.target_degree = 2;
  const auto fixed = calibrateCameras(s.session, twelve);
  ASSERT_TRUE(fixed.ok());
  EXPECT_FALSE(fixed->target.higher);
  // What the higher terms leave uncertain is in the deviations.
  EXPECT_GT((result->summary.covariance.standardDeviations() -
             fixed->summary.covariance.standardDeviations())
                .minCoeff(),
            -1e-3 * fixed->summary.covariance.standardDeviations().maxCoeff());
}

TEST(CameraTarget, AnotherHalfHasHigherTermsOfItsOwn) {
  const SimulatedSession& s = noisyHigher();
  const CameraStageOptions options = estimating(TargetMode::kAuto, 0.2);
  const auto& result = noisyHigherByItself();
  ASSERT_TRUE(result.ok() && result->target.higher);
  const auto half = static_cast<int>(result->frames.size() / 2);
  const auto again = recalibrateCameras(s.session, *result, {{0, half, 1}}, options);
  ASSERT_TRUE(again.ok() && again->target.higher);
  EXPECT_NE(*again->target.higher, *result->target.higher);
  EXPECT_LT((*again->target.higher - *higherShape().higher).norm(), 6e-5);
}

TEST(CameraTarget, AKnownBoardsHigherTermsHaveTheirDeviations) {
  const auto& known = noisyHigherByItself();
  ASSERT_TRUE(known.ok() && known->target.higher_std);
  const HigherTerms error = *known->target.higher - *higherShape().higher;
  EXPECT_LT(error.cwiseQuotient(*known->target.higher_std).cwiseAbs().maxCoeff(), 4.5);

  SimulationOptions recording = recordingOf(bentTerms(), 0.2);
  recording.target.shape = higherShape();
  recording.seed = recording.trajectory.seed = 77;
  auto second = simulateSession(simulatedRig("euroc"), recording);
  second.session.target.shape = known->target;
  const CameraStageOptions options = estimating(TargetMode::kKnown, 0.2);
  const auto result = calibrateCameras(second.session, options);
  ASSERT_TRUE(result.ok()) << result.failure();
  EXPECT_LT(largestError(*result, second.truth), 4);
  // Both recordings speak.
  EXPECT_LT((*result->target.higher - *higherShape().higher).norm(), error.norm());

  second.session.target.shape.higher_std.reset();  // as if exact
  const auto exact = calibrateCameras(second.session, options);
  ASSERT_TRUE(exact.ok());
  EXPECT_EQ(exact->target.higher, known->target.higher);
  EXPECT_GT(result->summary.covariance.standardDeviations().sum(),
            exact->summary.covariance.standardDeviations().sum());
}

TEST(CameraTarget, ABoardOfDegreeTwoHasNoHigherTerms) {
  CameraStageOptions options = estimating(TargetMode::kAuto, 0.2);
  const auto& four = noisyBentByItself();
  options.target_degree = 2;
  const auto two = calibrateCameras(noisyBent().session, options);
  ASSERT_TRUE(four.ok() && two.ok());
  EXPECT_FALSE(four->target.higher);
  EXPECT_EQ(four->target.terms, two->target.terms);
  EXPECT_EQ(four->summary.covariance.matrix, two->summary.covariance.matrix);
}

/// The board above, each of whose corners is off by itself: 30 um in the plane, 100 um in height.
SimulationOptions unevenRecording(double sigma_px) {
  SimulationOptions recording = recordingOf(bentTerms(), sigma_px);
  recording.target.shape = higherShape();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const int n = recording.target.cornerCount();
  recording.target.shape.corners = Eigen::VectorXd(3 * n);
  for (int j = 0; j < 3 * n; ++j) {
    (*recording.target.shape.corners)[j] = (j % 3 == 2 ? 1e-4 : 3e-5) * normal(random);
  }
  return recording;
}

/// Height of the corners over the plane and x, y over the similarity that fit them best, by which
/// alone boards differ to a camera; a column per corner [m].
Eigen::Matrix3Xd withoutSimilarity(const TargetShape& shape) {
  AprilGrid board;
  board.shape = shape;
  const auto points = cornerPoints(board);
  Eigen::Matrix3Xd P(3, board.cornerCount()), grid(3, board.cornerCount());
  for (int id = 0; id < board.cornerCount(); ++id) {
    P.col(id) = points[static_cast<std::size_t>(id)];
    grid.col(id) << board.corner(id), 0;
  }
  const Eigen::Matrix4d T = Eigen::umeyama(P, grid, true);
  return (T.topLeftCorner<3, 3>() * P).colwise() + T.topRightCorner<3, 1>() - grid;
}

double cornersRms(const TargetShape& found, const TargetShape& truth) {
  const Eigen::Matrix3Xd d = withoutSimilarity(found) - withoutSimilarity(truth);
  return std::sqrt(d.squaredNorm() / static_cast<double>(d.cols()));
}

TEST(CameraTarget, RecoversSingleCornersWithoutNoise) {
  const SimulationOptions recording = unevenRecording(0);
  const auto s = simulateSession(simulatedRig("euroc"), recording);
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kAuto));
  ASSERT_TRUE(result.ok()) << result.failure();
  ASSERT_TRUE(result->target.corners);
  EXPECT_LT(cornersRms(result->target, recording.target.shape), 2e-6);
  EXPECT_LT(result->summary.reprojection.rmse_px, 5e-3);
}

TEST(CameraTarget, FindsSingleCornersWithinTheirNoise) {
  const SimulationOptions recording = unevenRecording(0.1);
  const auto s = simulateSession(simulatedRig("euroc"), recording);
  CameraStageOptions options = estimating(TargetMode::kAuto, 0.1);
  const auto result = calibrateCameras(s.session, options);
  ASSERT_TRUE(result.ok() && result->target_fit && result->target.corners);
  const TargetFit& fit = *result->target_fit;
  EXPECT_GT(*fit.corners_gain_px2, 2 * *fit.corners_gain_std_px2);
  EXPECT_EQ(fit.shapeHeldOutPx(), *fit.corners_held_out_px);
  EXPECT_LT(*fit.corners_held_out_px, *fit.higher_held_out_px);
  EXPECT_NEAR(*fit.corners_plane_std, 3e-5, 6e-6);
  EXPECT_NEAR(*fit.corners_height_std, 1e-4, 3e-5);
  EXPECT_LT(largestError(*result, s.truth), 4);

  options.target_corners = false;
  const auto smooth = calibrateCameras(s.session, options);
  ASSERT_TRUE(smooth.ok());
  EXPECT_FALSE(smooth->target.corners || smooth->target_fit->corners_held_out_px);
  EXPECT_LT(cornersRms(result->target, recording.target.shape),
            0.6 * cornersRms(smooth->target, recording.target.shape));

  // Half of the recording has remainders of its own.
  options.target_corners = true;
  const auto half = static_cast<int>(result->frames.size() / 2);
  const auto again = recalibrateCameras(s.session, *result, {{0, half, 1}}, options);
  ASSERT_TRUE(again.ok() && again->target.corners);
  EXPECT_NE(*again->target.corners, *result->target.corners);
  EXPECT_LT(cornersRms(again->target, recording.target.shape),
            cornersRms(smooth->target, recording.target.shape));
}

TEST(CameraTarget, ASmoothBoardHasNoRemaindersOfCorners) {
  const SimulatedSession& s = noisyHigher();
  CameraStageOptions options = estimating(TargetMode::kAuto, 0.2);
  const auto& result = noisyHigherByItself();
  ASSERT_TRUE(result.ok() && result->target.higher);
  EXPECT_TRUE(result->target_fit->corners_held_out_px);
  EXPECT_FALSE(result->target.corners);
  options.target_corners = false;
  const auto untried = calibrateCameras(s.session, options);
  ASSERT_TRUE(untried.ok());
  EXPECT_EQ(untried->summary.covariance.matrix, result->summary.covariance.matrix);
}

// They belong to recording and detector, as tag_edge does.
TEST(CameraTarget, AKnownBoardBringsNoRemaindersOfCorners) {
  SimulationOptions recording = recordingOf(bentTerms(), 0.2);
  auto s = simulateSession(simulatedRig("euroc"), recording);
  s.session.target.shape.terms = bentTerms();
  s.session.target.shape.covariance = TargetCovariance::Identity() * 1e-10;
  const auto smooth = calibrateCameras(s.session, estimating(TargetMode::kKnown, 0.2));
  s.session.target.shape.corners = 1e-4 * Eigen::VectorXd::Random(3 * AprilGrid().cornerCount());
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kKnown, 0.2));
  ASSERT_TRUE(result.ok() && smooth.ok());
  EXPECT_FALSE(result->target.corners);
  EXPECT_LT((result->target.terms - smooth->target.terms).norm(), 1e-7);
}

TEST(CameraTarget, AVeryShortRecordingIsLeftAsStated) {
  SimulationOptions recording = recordingOf(bentTerms(), 0.2);
  recording.duration_s = 1;
  const auto s = simulateSession(simulatedRig("euroc"), recording);
  const auto result = calibrateCameras(s.session, estimating(TargetMode::kAuto, 0.2));
  ASSERT_TRUE(result.ok()) << result.failure();
  ASSERT_TRUE(result->target_fit);
  EXPECT_NE(result->target_fit->finding, TargetFinding::kBent);
  EXPECT_TRUE(result->target.isFlat());
}

}  // namespace
}  // namespace plumbline

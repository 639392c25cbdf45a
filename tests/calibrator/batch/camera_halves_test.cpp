// SPDX-License-Identifier: BSD-3-Clause
// Whether the halves of a recording agree.
#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/batch/halves.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/batch/camera_imu_examples.h"

namespace plumbline {
namespace {

SimulatedSession recorded(std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.duration_s = 30;
  options.camera_rate_hz = 5;
  return simulateSession(simulatedRig("euroc"), options);
}

/// The same recording, with a lens that is knocked in its middle: its corners move from there on.
Session knocked(Session session, double shift_px) {
  auto& views = session.cameras[0].views;
  for (std::size_t i = views.size() / 2; i < views.size(); ++i) {
    for (Corner& corner : views[i].corners) corner.uv.x() += shift_px;
  }
  return session;
}

TEST(CameraHalves, AgreeWhereNothingChanged) {
  const SimulatedSession s = recorded(1);
  const auto whole = calibrateCameras(s.session);
  ASSERT_TRUE(whole.ok());
  const auto check = checkCameraHalves(s.session, *whole);
  ASSERT_TRUE(check);
  ASSERT_EQ(check->blocks.size(), 3U);  // two lenses, one transform
  EXPECT_EQ(check->split, whole->frames[whole->frames.size() / 2].t);
  for (const HalvesBlock& b : check->blocks) EXPECT_TRUE(b.agree()) << b.name << " " << b.chi2;
}

TEST(CameraHalves, ALensThatWasKnockedIsNamedWithItsShift) {
  const SimulatedSession s = recorded(1);
  const Session session = knocked(s.session, 2);
  const auto whole = calibrateCameras(session);
  ASSERT_TRUE(whole.ok());
  const auto check = checkCameraHalves(session, *whole);
  ASSERT_TRUE(check);
  const HalvesBlock& lens = check->blocks[0];
  EXPECT_FALSE(lens.agree());
  EXPECT_EQ(lens.worst, "cam0.pu");
  EXPECT_NEAR(lens.difference, 2, 4 * lens.std);
  EXPECT_TRUE(check->blocks[1].agree()) << "the other lens stayed";
}

// Corners have 0.2 px of noise; a stated 1 px hid a difference of six deviations.
TEST(CameraHalves, ADifferenceCountsTheSameWhateverNoiseIsStated) {
  const Session session = knocked(recorded(1).session, 0.8);
  const auto checkedUnder = [&](double pixel_sigma) {
    CameraStageOptions options;
    options.cauchy_px = 0;
    options.pixel_sigma = pixel_sigma;
    const auto whole = calibrateCameras(session, options);
    return whole ? checkCameraHalves(session, *whole, options) : std::nullopt;
  };
  const auto true_noise = checkedUnder(0.2), larger = checkedUnder(1);
  ASSERT_TRUE(true_noise && larger);
  EXPECT_FALSE(larger->blocks[0].agree());
  for (std::size_t b = 0; b < larger->blocks.size(); ++b) {
    const HalvesBlock& block = true_noise->blocks[b];
    EXPECT_NEAR(larger->blocks[b].chi2, block.chi2, 0.01 * block.chi2) << block.name;
  }
}

TEST(CameraImuHalves, QuietCornersLowerTheLeastDeviation) {
  const SimulatedSession s = test::simulate(test::noisyRecording(1));
  CameraImuOptions options = test::matchedOptions(s, 1);
  options.diagnose_faults = false;
  const auto solved = calibrateCameraImu(s.session, s.truth.cameras, options);
  ASSERT_TRUE(solved.ok()) << solved.failure();
  CameraImuStageResult whole = *solved;
  FaultDiagnosis& faults = whole.faults.emplace();
  faults.formal_std = Eigen::VectorXd::Ones(7);
  faults.robust_std = 0.01 * faults.formal_std;  // too small by chance
  const auto stdUnder = [&](double noise_px) {
    whole.summary.reprojection.rmse_px = std::sqrt(2) * noise_px;
    const auto check = checkCameraImuHalves(s.session, whole, options);
    return check ? check->blocks.back().std : -1;
  };
  const double assumed = stdUnder(1);
  EXPECT_GT(assumed, 0);
  EXPECT_NEAR(stdUnder(0.2), 0.2 * assumed, 1e-9 * assumed);
  EXPECT_NEAR(stdUnder(3), assumed, 1e-9 * assumed);
}

TEST(CameraHalves, ChiSquareOfAWhiteDifferenceIsThatOfItsParameters) {
  HalvesDifference d;
  d.name = "two";
  d.parameters = {{"a", "px"}, {"b", "m"}};
  d.difference = Eigen::Vector2d(3, 0.2);
  d.formal = Eigen::Vector2d(1, 0.01).asDiagonal();
  d.robust = d.formal;
  d.blocks = 80;
  const HalvesBlock same = compareHalves(d);
  EXPECT_NEAR(same.chi2, 9 + 4, 1e-12);
  EXPECT_EQ(same.worst, "a");
  EXPECT_NEAR(same.std, 1, 1e-12);
  EXPECT_NEAR(same.limit, 9.2103 * 78 / 75, 0.05);  // Wilson and Hilferty
  d.robust = 4 * d.formal;                          // deviations twice as large: a quarter
  EXPECT_NEAR(compareHalves(d).chi2, 13.0 / 4, 1e-12);
  d.robust = 0.01 * d.formal;  // a robust covariance that is too small by chance is drawn upwards
  EXPECT_LT(compareHalves(d).chi2, 13 / 0.03);
}

// Ten deviations of noise, but one of what both halves' detector does alike.
TEST(CompareHalves, ADifferenceThatACommonErrorExplainsIsNone) {
  HalvesDifference d;
  d.name = "cam0 intrinsics";
  d.parameters = {{"cam0.fu", "px"}, {"cam0.fv", "px"}};
  d.difference = Eigen::Vector2d(10, 0);
  d.formal = d.robust = Eigen::Matrix2d::Identity();
  d.blocks = 80;
  EXPECT_NEAR(compareHalves(d).chi2, 100, 1e-9);
  d.moves = Eigen::Vector2d(10, 0);
  const HalvesBlock explained = compareHalves(d);
  EXPECT_NEAR(explained.chi2, 100. / 101, 1e-9);
  EXPECT_NEAR(explained.std, std::sqrt(101), 1e-9);
  // It explains nothing along another direction.
  d.moves = Eigen::Vector2d(0, 10);
  EXPECT_NEAR(compareHalves(d).chi2, 100, 1e-9);
}

}  // namespace
}  // namespace plumbline

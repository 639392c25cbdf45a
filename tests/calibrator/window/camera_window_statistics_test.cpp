// SPDX-License-Identifier: BSD-3-Clause
// The window's covariance is a claim, although its prior keeps the derivatives of early estimates:
// over 100 seeds the normalised errors must be as large as it says.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/window/camera_window.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

constexpr int kSeeds = 100;
constexpr double kSigma = 0.3;  // [px]
constexpr int kStart = 5;       // frames of the first solution

/// Quantile of chi-square by Wilson and Hilferty; z is the normal quantile.
double chiSquareQuantile(double dof, double z) {
  const double a = 2 / (9 * dof);
  return dof * std::pow(1 - a + z * std::sqrt(a), 3);
}

/// The session's first frames, as a session.
Session firstFrames(const test::StereoFrames& frames, std::size_t count) {
  Session session = frames.simulated.session;
  for (CameraStream& camera : session.cameras) {
    std::erase_if(camera.views, [&](const ImageView& v) { return v.t > frames.t[count - 1]; });
  }
  return session;
}

struct Outcome {
  double nees = 0;
  double from_batch = 0;  ///< largest difference to the batch, in its standard deviations
};

/// As the guide works: a batch on the first frames, then frame by frame.
std::optional<Outcome> runWindow(std::uint64_t seed) {
  const test::StereoFrames frames = test::stereoFrames(seed, 12, 5, kSigma);
  CameraStageOptions batch_options;
  batch_options.cauchy_px = 0;
  batch_options.pixel_sigma = kSigma;
  const auto start = calibrateCameras(firstFrames(frames, kStart), batch_options);
  const auto batch = calibrateCameras(frames.simulated.session, batch_options);
  if (!start || !batch || start->frames.size() != kStart) return std::nullopt;
  CameraWindowOptions options;
  options.pixel_sigma = kSigma;
  options.cauchy_px = 0;
  CameraWindow window(frames.simulated.session.target, start->cameras, options);
  for (std::size_t f = 0; f < frames.corners.size(); ++f) {
    window.add(frames.corners[f], f < kStart ? start->T_FC0[f] : frames.T_FC0[f]);
    if (f < kStart) continue;
    if (!window.solve()) return std::nullopt;
    while (window.frameCount() > options.size) window.marginaliseOldest();
  }
  const Eigen::VectorXd error = cameraDifference(window.cameras(), frames.simulated.truth.cameras);
  const Eigen::VectorXd std = batch->summary.covariance.standardDeviations();
  Outcome outcome;
  outcome.nees = error.dot(window.information() * error);
  outcome.from_batch =
      cameraDifference(window.cameras(), batch->cameras).cwiseQuotient(std).cwiseAbs().maxCoeff();
  return outcome;
}

TEST(CameraWindowStatistics, NormalisedErrorsOfAHundredSeedsAreChiSquare) {
  double sum = 0;
  double farthest = 0;
  constexpr int kDimension = 22;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto outcome = runWindow(seed);
    ASSERT_TRUE(outcome.has_value()) << seed;
    sum += outcome->nees;
    farthest = std::max(farthest, outcome->from_batch);
  }
  const double z = 1.959964;  // two-sided 95 %
  const double mean = sum / kSeeds;
  EXPECT_GT(mean, chiSquareQuantile(kSeeds * kDimension, -z) / kSeeds);
  EXPECT_LT(mean, chiSquareQuantile(kSeeds * kDimension, z) / kSeeds);
  EXPECT_LT(farthest, 0.2);
  RecordProperty("mean_nees", fmt::format("{:.3f}", mean));
  RecordProperty("farthest_from_batch_sigmas", fmt::format("{:.3f}", farthest));
}

}  // namespace
}  // namespace plumbline

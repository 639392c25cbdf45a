// SPDX-License-Identifier: BSD-3-Clause
// A gain is a promise: views are scored, then taken by the true cameras with noise, and the cameras
// solved again with them.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/guidance/views/candidate_views.h"
#include "calibrator/guidance/views/view_gain.h"
#include "calibrator/information/covariance.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/window/stereo_frames.h"

namespace plumbline {
namespace {

struct GainPair {
  double predicted = 0;  ///< [nats]
  double actual = 0;     ///< 0.5 log of the ratio of the covariances' determinants
};

struct Weighting {
  double pixel_sigma = 0.3;
  double cauchy_px = 0;
};

CameraStageOptions stageOptions(const Weighting& weighting) {
  CameraStageOptions options;
  options.pixel_sigma = weighting.pixel_sigma;
  options.cauchy_px = weighting.cauchy_px;
  return options;
}

/// The session with one view more, as the true cameras at T_FC0 see it.
Session withView(const SimulatedSession& s, const Session& session, const Transform& T_FC0,
                 std::uint64_t number) {
  Session more = session;
  SimulationOptions options;
  options.seed = 7;
  options.corner_sigma_px = 0.3;
  for (std::size_t c = 0; c < more.cameras.size(); ++c) {
    const CameraCalibration& camera = s.truth.cameras[c];
    ImageView view{more.cameras[c].views.back().t + 1'000'000'000,
                   visibleCorners(camera.intrinsics, T_FC0 * camera.T_C0Ci, options)};
    disturbCorners(view.corners, camera.intrinsics.resolution, static_cast<int>(c), number,
                   options);
    more.cameras[c].views.push_back(std::move(view));
  }
  return more;
}

/// Ten candidates after a recording of `seconds` at 3 frames a second.
void addPairs(std::uint64_t seed, double seconds, const Weighting& weighting,
              std::vector<GainPair>& pairs) {
  const auto frames = test::stereoFrames(seed, seconds, 3, 0.3);
  const Session& session = frames.simulated.session;
  const auto before = calibrateCameras(session, stageOptions(weighting));
  ASSERT_TRUE(before.ok()) << before.failure();
  CameraEstimate cameras;
  for (const CameraCalibration& camera : before->cameras) {
    cameras.intrinsics.push_back(camera.intrinsics);
    cameras.T_C0Ci.push_back(camera.T_C0Ci);
  }
  ViewGainOptions options;
  options.pixel_sigma = weighting.pixel_sigma;
  const Eigen::MatrixXd& covariance = before->summary.covariance.matrix;
  const ViewScorer scorer(session.target, cameras, *covarianceOf(covariance), options);
  const auto views = candidateViews(before->cameras, session.target);
  for (std::size_t k = 0; k < 10; ++k) {
    const CandidateView& view = views[(37 * seed + 21 * k) % views.size()];
    CameraStageOptions again = stageOptions(weighting);
    again.start = before->cameras;
    const auto after =
        calibrateCameras(withView(frames.simulated, session, view.T_FC0, 1000 * seed + k), again);
    ASSERT_TRUE(after.ok()) << after.failure();
    pairs.push_back({scorer.predictedGains({view.T_FC0}).front(),
                     before->summary.entropy_nats - after->summary.entropy_nats});
  }
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
  return rank;
}

struct Line {
  double slope = 0;  ///< of y over x
  double correlation = 0;
};
Line lineThrough(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  return {xy / xx, xy / std::sqrt(xx * yy)};
}

class PredictedGain : public ::testing::TestWithParam<Weighting> {};

TEST_P(PredictedGain, IsWhatSolvingAgainGives) {
  std::vector<GainPair> pairs;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    addPairs(seed, seed % 3 == 0 ? 3 : (seed % 3 == 1 ? 8 : 20), GetParam(), pairs);
  }
  ASSERT_GE(pairs.size(), 200u);
  std::vector<double> predicted;
  std::vector<double> actual;
  for (const GainPair& pair : pairs) {
    predicted.push_back(bitsFromNats(pair.predicted));
    actual.push_back(bitsFromNats(pair.actual));
  }
  const double slope = lineThrough(predicted, actual).slope;
  const double rank_correlation = lineThrough(ranks(predicted), ranks(actual)).correlation;
  EXPECT_GT(slope, 0.8);
  EXPECT_LT(slope, 1.2);
  EXPECT_GE(rank_correlation, 0.9);
  const auto [least, most] = std::minmax_element(predicted.begin(), predicted.end());
  EXPECT_GT(*most, 3 * *least);  // a range worth a slope
  RecordProperty("pairs", static_cast<int>(pairs.size()));
  RecordProperty("slope", fmt::format("{:.4f}", slope));
  RecordProperty("rank_correlation", fmt::format("{:.4f}", rank_correlation));
  RecordProperty("predicted_bits", fmt::format("{:.3f} to {:.3f}", *least, *most));
}

INSTANTIATE_TEST_SUITE_P(SquaredAndTheGuidesOwn, PredictedGain,
                         ::testing::Values(Weighting{0.3, 0}, Weighting{1, 1.5}));

}  // namespace
}  // namespace plumbline

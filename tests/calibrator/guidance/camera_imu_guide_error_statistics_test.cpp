// SPDX-License-Identifier: BSD-3-Clause
// The camera-IMU stage by predicted error: whether points that the IMU predicts are off by what it
// says.
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/trajectories/imu_reprojection.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"

namespace plumbline {
namespace {

using test::byTrajectoryError, test::kErrorSigma;

/// What the guide believes of the noise, over the truth.
struct Belief {
  double corner = 1, imu = 1;
  double most = 1.9;  // of the ratio below
};

/// Squared error of a batch through M, over what was predicted: mean of the recordings.
double errorOverPrediction(const Belief& belief, const std::vector<SimulatedSession>& recordings) {
  double sum = 0;
  for (const SimulatedSession& s : recordings) {
    GuideOptions options = byTrajectoryError();
    options.trajectories.pixel_sigma = belief.corner * kErrorSigma;
    options.trajectories.stop_reprojection_px = 1e-9;  // never
    GuideRig rig = test::rigOf(s);
    rig.imu->gyro_density *= belief.imu;
    rig.imu->accel_density *= belief.imu;
    CameraImuGuide guide(rig, s.truth.cameras, options);
    const auto decisions = test::replay(guide, test::framesOf(s.session));
    const auto result = guide.batch();
    if (!result || !decisions.back().error_px) return std::numeric_limits<double>::quiet_NaN();
    Eigen::Matrix<double, 7, 1> error;
    error << boxminus(result->imu.T_SC0, s.truth.imu->T_SC0),
        result->imu.timeOffset() - s.truth.imu->timeOffset();
    const Matrix7d M = ImuReprojection(s.truth.cameras).gram(s.truth.imu->T_SC0);
    sum += error.dot(M * error) / std::pow(*decisions.back().error_px, 2);
  }
  return sum / static_cast<double>(recordings.size());
}

// Mean of 16 of about 3 degrees of freedom each: std 0.25. Whatever noise is assumed, the residuals
// tell what there is: with densities a quarter of the true ones as stated the ratio would be
// above 7.
TEST(CameraImuGuideByError, PointsAreOffByWhatWasPredicted) {
  std::vector<SimulatedSession> recordings;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) recordings.push_back(test::flight(4, seed, 10));
  for (const Belief& belief :
       {Belief{1, 1}, Belief{5, 1}, Belief{0.2, 1}, Belief{1, 0.25, 2.5}, Belief{1, 4}}) {
    const double ratio = errorOverPrediction(belief, recordings);
    RecordProperty(fmt::format("sigma_{}_{}", belief.corner, belief.imu), std::to_string(ratio));
    EXPECT_GT(ratio, 0.4) << belief.corner << ' ' << belief.imu;
    EXPECT_LT(ratio, belief.most) << belief.corner << ' ' << belief.imu;
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Isolated readings, repeated views, tags out of place and grazing corners are found where they
// are, and what looks like them is not. Not proven here: what they do to a calibration.
#include "calibrator/initialise/screening.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

// A swinging sensor with white noise, 200 Hz for 10 s.
std::vector<ImuSample> swinging(double gyro_sigma, double accel_sigma) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> unit;
  std::vector<ImuSample> samples;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.005 * k;
    ImuSample s{5'000'000LL * k,
                {2 * std::sin(9 * t), std::cos(5 * t), std::sin(12 * t + 1)},
                {4 * std::sin(14 * t), 9.8 + 4 * std::sin(8 * t), 3 * std::cos(11 * t)}};
    for (int i = 0; i < 3; ++i) {
      s.gyro(i) += gyro_sigma * unit(random);
      s.accel(i) += accel_sigma * unit(random);
    }
    samples.push_back(s);
  }
  return samples;
}

TEST(FindSpikes, NoneInMotionNoiseVibrationAndKnocks) {
  EXPECT_TRUE(findSpikes(swinging(0, 0), {}).empty());
  EXPECT_TRUE(findSpikes(swinging(0.0024, 0.03), {}).empty());
  EXPECT_TRUE(findSpikes(swinging(0.05, 0.5), {}).empty());  // ten times what was stated
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].accel.z() += 20 * std::sin(1.9 * static_cast<double>(k));  // 60 Hz
  }
  EXPECT_TRUE(findSpikes(samples, {}).empty());
  samples = swinging(0.0024, 0.03);
  for (std::size_t k = 1000; k < samples.size(); ++k) samples[k].gyro.x() += 0.2;  // a jump
  EXPECT_TRUE(findSpikes(samples, {}).empty());
  for (std::size_t k = 0; k < 8; ++k) {  // a knock of 40 ms
    samples[500 + k].accel.y() += 30 * std::sin(3.14159 * static_cast<double>(k) / 8);
  }
  EXPECT_TRUE(findSpikes(samples, {}).empty());
}

TEST(FindSpikes, FindsStampChannelAndSize) {
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  samples[300].gyro.y() += 0.2;
  samples[700].accel.x() -= 500;
  samples[1500].gyro.z() += 100;
  const std::vector<ImuSpike> spikes = findSpikes(samples, {});
  ASSERT_EQ(spikes.size(), 3U);
  EXPECT_EQ(spikes[0].t, samples[300].t);
  EXPECT_EQ(spikes[0].channel, 1);
  EXPECT_NEAR(spikes[0].size, 0.2, 0.02);
  EXPECT_EQ(spikes[1].channel, 3);
  EXPECT_NEAR(spikes[1].size, -500, 1);
  EXPECT_EQ(spikes[2].t, samples[1500].t);
  const std::vector<ImuSample> kept = withoutSpikes(samples, spikes);
  EXPECT_EQ(kept.size(), samples.size() - 3);
  EXPECT_TRUE(findSpikes(kept, {}).empty());
}

TEST(CutOff, IsFoundAndLeavesAGap) {
  std::vector<ImuSample> samples = swinging(0.0024, 0.03);
  EXPECT_TRUE(findCutOff(samples).empty());
  for (ImuSample& s : samples) s.accel.y() = std::min(s.accel.y(), 13.0);
  const std::vector<CutOff> found = findCutOff(samples);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].channel, 4);
  EXPECT_EQ(found[0].limit, 13);
  for (const std::size_t k : found[0].samples) EXPECT_EQ(samples[k].accel.y(), 13);
  for (const ImuSample& s : withoutCutOff(samples, found)) EXPECT_LT(s.accel.y(), 13);
  // Where most would have to go, all stay.
  for (ImuSample& s : samples) s.accel.y() = std::min(s.accel.y(), 10.0);
  EXPECT_EQ(withoutCutOff(samples, findCutOff(samples)).size(), samples.size());
}

TEST(CutOff, IsNotWhereACoarseSensorRests) {
  std::vector<ImuSample> samples = swinging(0, 0);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].accel.z() = k % 20 == 0 ? -9.7 : -9.8;
  }
  EXPECT_TRUE(findCutOff(samples).empty());
}

SimulatedSession recorded(double duration_s, const char* rig = "euroc") {
  SimulationOptions options;
  options.duration_s = duration_s;
  return simulateSession(simulatedRig(rig), options);
}

TEST(RepeatedViews, NeedAWitnessThatSomethingMoved) {
  Session session = recorded(2).session;
  EXPECT_TRUE(repeatedViews(session)[0].empty());
  session.cameras[0].views[11].corners = session.cameras[0].views[10].corners;
  EXPECT_EQ(repeatedViews(session)[0], std::vector<int>{11});
  EXPECT_TRUE(repeatedViews(session)[1].empty());
  Session without_imu = session;
  without_imu.imu.reset();
  EXPECT_EQ(repeatedViews(without_imu)[0], std::vector<int>{11});  // the other camera changed
  without_imu.cameras.resize(1);
  EXPECT_TRUE(repeatedViews(without_imu)[0].empty());
}

struct View {
  AprilGrid target;
  Intrinsics lens;
  Transform T_CF;
  std::vector<ImageView> views;
};

View viewOfBoard() {
  const SimulatedSession s = recorded(1);
  View v{s.session.target, s.truth.cameras[0].intrinsics, {}, {s.session.cameras[0].views[5]}};
  v.T_CF = s.cameraPose(0, v.views[0].t).inverse();
  return v;
}

TEST(MisplacedTags, AreFoundWithTheirPlace) {
  View v = viewOfBoard();
  const PackedCorners clean(v.target, v.views);
  EXPECT_TRUE(findMisplacedTags(v.target, v.lens, clean.view(0), v.T_CF).empty());
  std::vector<Corner>& corners = v.views[0].corners;
  const int a = corners.front().id / 4;
  const int b = corners.back().id / 4;
  ASSERT_NE(a, b);
  for (std::size_t k = 0; k < 4; ++k) {
    std::swap(corners[k].uv, corners[corners.size() - 4 + k].uv);
  }
  const PackedCorners swapped(v.target, v.views);
  const auto found = findMisplacedTags(v.target, v.lens, swapped.view(0), v.T_CF);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].tag, a);
  EXPECT_EQ(found[0].place, b);
  EXPECT_EQ(found[1].tag, b);
  EXPECT_EQ(found[1].place, a);
  // Under a pose that is wrong for the whole view nothing is said of single tags.
  Transform far = v.T_CF;
  far.t.x() += 0.3;
  EXPECT_TRUE(findMisplacedTags(v.target, v.lens, clean.view(0), far).empty());
}

TEST(GrazingCorners, AreThoseBeyondTheAngle) {
  const View v = viewOfBoard();
  const PackedCorners packed(v.target, v.views);
  EXPECT_TRUE(beyondAngle(packed.view(0), v.T_CF, kGrazing).empty());
  Transform grazing;  // the board's plane through the camera, along the optical axis
  grazing.R << 0, 0, 1, 0, 1, 0, 1, 0, 0;
  grazing.t << 0.1, 0, -0.3;
  for (const int k : beyondAngle(packed.view(0), grazing, kGrazing)) {
    const Eigen::Vector3d p =
        grazing * Eigen::Vector3d(packed.view(0).x[k], packed.view(0).y[k], 0);
    EXPECT_LT(p.z() / p.norm(), std::cos(kGrazing));
  }
  EXPECT_FALSE(beyondAngle(packed.view(0), grazing, kGrazing).empty());
}

TEST(FalseCorners, AreFound) {
  View v = viewOfBoard();
  EXPECT_TRUE(falseCorners(v.lens, PackedCorners(v.target, v.views).view(0), v.T_CF).empty());
  v.views[0].corners[3].uv.x() += 5;
  v.views[0].corners[9].uv.y() -= 12;
  EXPECT_EQ(falseCorners(v.lens, PackedCorners(v.target, v.views).view(0), v.T_CF).size(), 2U);
}

}  // namespace
}  // namespace plumbline

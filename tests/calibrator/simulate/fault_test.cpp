// SPDX-License-Identifier: BSD-3-Clause
// The table of faults, what check() refuses, and that no fault moves another's random numbers.
#include "calibrator/simulate/faults/fault.h"

#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/calibrator/simulate/fault_recordings.h"

namespace plumbline {
namespace {

using test::cornersById;
using test::withFaults;
using enum FaultKind;

TEST(Fault, TableIsCompleteAndInOrder) {
  std::set<std::string> names;
  std::uint64_t number = 1;
  for (const FaultDescription& d : faultDescriptions()) {
    EXPECT_EQ(static_cast<std::uint64_t>(d.kind), number++) << d.name;
    EXPECT_EQ(describe(d.kind).name, std::string(d.name));
    EXPECT_EQ(std::string(d.example).rfind(d.name, 0), 0U) << d.name;
    EXPECT_FALSE(std::string(d.sentence).empty()) << d.name;
    names.insert(d.name);
  }
  EXPECT_EQ(names.size(), faultDescriptions().size());
  EXPECT_EQ(faultDescriptions().back().kind, kColumnShutter);
}

TEST(Fault, CheckRefusesByTheFaultsName) {
  const FaultScope scope{.duration_s = 10, .cameras = 2};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Fault> bad{
      {.kind = kAccelScale, .value = 0},
      {.kind = kAccelScale, .value = nan},
      {.kind = kAccelScale, .value = 1.1, .axis = 3},
      {.kind = kStretch, .value = 0.1, .axis = 2},
      {.kind = kGyroDelay, .value = 0.005, .axis = 1},
      {.kind = kGyroDelay, .value = 0.005, .camera = 1},
      {.kind = kBump, .value = 0.1, .at_s = 5, .camera = 2},
      {.kind = kSlip, .value = 0.1, .at_s = 10},
      {.kind = kSlip, .value = 0.1, .at_s = -1},
      {.kind = kSpike, .value = 1, .extent = -1},
      {.kind = kBurst, .value = 2.5},
      {.kind = kFalseCorners, .value = 1.1},
  };
  for (const Fault& fault : bad) {
    try {
      check({fault}, scope);
      ADD_FAILURE() << describe(fault.kind).name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(describe(fault.kind).name));
    }
  }
  EXPECT_NO_THROW(check({{.kind = kSlip, .value = 0.1, .at_s = 5}}, scope));
  // A rig of one camera has no camera 1 to be bumped.
  EXPECT_THROW(check({{.kind = kBump, .value = 0.1, .at_s = 5}}, {10, 1}), InputError);
}

TEST(Fault, SimulationRefusesWhatCheckRefuses) {
  EXPECT_THROW((void)withFaults({}, {{.kind = kBurst, .value = 1}}), InputError);
  SimulationOptions brief;
  brief.duration_s = 1;
  EXPECT_THROW((void)withFaults(brief, {{.kind = kSlip, .value = 0.1, .at_s = 5}}), InputError);
}

TEST(Fault, ImagesCannotShowFaultsOfDetectedCorners) {
  for (const FaultKind kind :
       {kRollingShutter, kColumnShutter, kBlur, kBow, kFalseCorners, kSwappedIds, kFrozen}) {
    EXPECT_THROW(checkRendered({{.kind = kGyroDelay}, {.kind = kind}}), InputError);
  }
  EXPECT_NO_THROW(checkRendered({{.kind = kGyroDelay}, {.kind = kBump}, {.kind = kSway}}));
}

// Faults of the IMU leave the corners alone to the last bit, noise and all; those of the corners
// the samples; and a fault's own random numbers do not depend on what else is wrong.
TEST(Fault, NoFaultMovesTheNumbersOfAnother) {
  SimulationOptions o;
  o.duration_s = 4;
  const Fault spike{.kind = kSpike, .value = 2, .extent = 100};
  const Fault wrong{.kind = kFalseCorners, .value = 0.1, .extent = 10};
  const SimulatedSession none = withFaults(o, {});
  const SimulatedSession a = withFaults(o, {spike});
  const SimulatedSession b = withFaults(o, {wrong});
  const SimulatedSession both = withFaults(o, {wrong, spike, {.kind = kGyroDelay, .value = 0}});
  EXPECT_EQ(cornersById(none), cornersById(a));
  EXPECT_EQ(cornersById(b), cornersById(both));
  EXPECT_EQ(a.faults[0].stamps, both.faults[1].stamps);
  EXPECT_FALSE(a.faults[0].stamps.empty());
  const auto& samples = none.session.imu->samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(samples[i].gyro, b.session.imu->samples[i].gyro);
    ASSERT_EQ(samples[i].accel, a.session.imu->samples[i].accel);
    ASSERT_EQ(a.session.imu->samples[i].gyro, both.session.imu->samples[i].gyro);
  }
}

TEST(Fault, TwoOfAKindHaveNumbersOfTheirOwn) {
  const std::vector<Fault> faults{{.kind = kSpike}, {.kind = kJitter}, {.kind = kSpike}};
  const auto spikes = faultsOf(faults, {kSpike});
  ASSERT_EQ(spikes.size(), 2U);
  EXPECT_NE(spikes[0].random(1, 0, 0).bits(), spikes[1].random(1, 0, 0).bits());
  EXPECT_EQ(faultsOf(faults, {kJitter}).front().number, 0U);
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Faults as words of the command line, and that the documents list the same ones.
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/cli/options/simulation_options.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

TEST(FaultWords, EveryExampleIsReadAndIsWithinItsRange) {
  for (const FaultDescription& d : faultDescriptions()) {
    const Fault fault = faultFrom(d.example);
    EXPECT_EQ(fault.kind, d.kind) << d.name;
    EXPECT_EQ(fault.spec, d.example);
    EXPECT_NO_THROW(check({fault}, {.duration_s = 60, .cameras = 2})) << d.name;
  }
}

TEST(FaultWords, ValuesAreReadInTheirUnits) {
  EXPECT_DOUBLE_EQ(faultFrom("slip=0.2deg@15s").value, 0.2 * kDegree);
  EXPECT_DOUBLE_EQ(faultFrom("slip=0.2rad@500ms").at_s, 0.5);
  EXPECT_DOUBLE_EQ(faultFrom("clock-drift=-100ppm").value, -1e-4);
  EXPECT_DOUBLE_EQ(faultFrom("gyro-delay=5ms").value, 0.005);
  EXPECT_DOUBLE_EQ(faultFrom("bow=1mm").value, 0.001);
  EXPECT_DOUBLE_EQ(faultFrom("stretch=0.3%").value, 0.003);
  EXPECT_DOUBLE_EQ(faultFrom("stretch=0.003").value, 0.003);
  EXPECT_DOUBLE_EQ(faultFrom("clip=12").value, faultFrom("clip=12m/s2").value);
  const Fault spike = faultFrom("spike=30/min,100rad/s,y");
  EXPECT_DOUBLE_EQ(spike.value, 0.5);
  EXPECT_DOUBLE_EQ(spike.extent, 100);
  EXPECT_EQ(spike.axis, 1);
}

TEST(FaultWords, KeysStandInAnyOrderAndValuesMayBeLeftOutWhereTheyHaveAUsual) {
  const Fault bump = faultFrom("bump=0.1deg,cam0,z@5s");
  EXPECT_EQ(bump.camera, 0);
  EXPECT_EQ(bump.axis, 2);
  EXPECT_DOUBLE_EQ(bump.at_s, 5);
  EXPECT_DOUBLE_EQ(faultFrom("burst").value, 10);
  EXPECT_DOUBLE_EQ(faultFrom("restamp").value, 0.01);
  EXPECT_DOUBLE_EQ(faultFrom("restamp,cam1").value, 0.01);
  EXPECT_EQ(faultFrom("restamp,cam1").camera, 1);
  EXPECT_DOUBLE_EQ(faultFrom("false-corners=10%").extent, 10);
}

TEST(FaultWords, RefusesEverythingElseBySpecAndForm) {
  for (const char* spec : {"",
                           "=",
                           "gyro",
                           "gyro-delay",
                           "gyro-delay=",
                           "gyro-delay=5",
                           "gyro-delay=5kg",
                           "gyro-delay=nanms",
                           "gyro-delay=5ms,x",
                           "gyro-delay=5ms@3s",
                           "gyro-delay=5ms,6ms",
                           "accel-scale=1.1,w",
                           "accel-scale=1.1,x,y",
                           "accel-scale=1.1,",
                           "slip=1deg",
                           "slip=1deg@",
                           "slip=1deg@5",
                           "slip=1deg@1s@2s",
                           "spike=10/min",
                           "spike=100rad/s,10/min",
                           "bump=1deg@1s,cam",
                           "bump=1deg@1s,cam-1",
                           "bump=1deg@1s,cam1,cam1",
                           "frozen=1e999/min",
                           "burst=,"}) {
    try {
      (void)faultFrom(spec);
      ADD_FAILURE() << spec;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("--fault " + std::string(spec)));
    }
  }
}

TEST(FaultWords, RangesAreSaidInTheUnitThatWasWritten) {
  try {
    (void)faultFrom("slip=400deg@5s");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'400deg' is out of range (-180 to 180 deg)"));
  }
}

// The section of docs/faults.md is what `plumbline simulate --fault list` prints.
TEST(FaultWords, DocumentsListTheSameFaults) {
  std::ifstream in(PLUMBLINE_SOURCE_DIR "/docs/faults.md");
  const std::string document{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(document, HasSubstr("```text\n" + faultList() + "```\n"));
}

}  // namespace
}  // namespace plumbline

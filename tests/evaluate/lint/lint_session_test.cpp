// SPDX-License-Identifier: BSD-3-Clause
// A recording tells which of two conventions a calibration follows.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/simulate/simulate_session.h"
#include "evaluate/lint/lint.h"
#include "tests/evaluate/lint/lint_cases.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const SimulatedSession& recording(const std::string& name) {
  const auto simulate = [](const char* rig) {
    SimulationOptions options;
    options.duration_s = 15;
    options.time_offset_s = 5e-3;
    return simulateSession(simulatedRig(rig), options);
  };
  static const SimulatedSession euroc = simulate("euroc");
  static const SimulatedSession d435i = simulate("d435i");
  return name == "euroc" ? euroc : d435i;
}

LintedCalibration truthOf(const std::string& name) {
  return {"rig.yaml", recording(name).truth, true};
}

std::vector<Finding> lintWith(const std::string& name, LintedCalibration linted,
                              const std::function<void(Calibration&)>& inject) {
  inject(linted.calibration);
  return lintAgainstSession({&linted, 1}, recording(name).session);
}

TEST(LintSession, TheTruthIsClean) {
  for (const char* const name : {"euroc", "d435i"}) {
    EXPECT_EQ(rulesOf(lintWith(name, truthOf(name), [](Calibration&) {})), "") << name;
  }
}

// As when a camera matrix was copied row by row: poses by such a camera turn otherwise than the
// gyroscope, which is no fault of T_SC0.
TEST(LintSession, ACameraThatDoesNotExplainTheCornersAccusesNoImu) {
  const auto exchange = [](Calibration& c) {
    for (CameraCalibration& camera : c.cameras) {
      std::swap(camera.intrinsics.projection[1], camera.intrinsics.projection[2]);
    }
  };
  EXPECT_EQ(rulesOf(lintWith("euroc", truthOf("euroc"), exchange)), "");
}

std::vector<LintCase> sessionCases() {
  return {
      {"T_cam_imu inverted", invertImu, "Inverted transform", "T_cam_imu"},
      {"offset negated", negateOffset, "Flipped time offset", "timeshift_cam_imu"},
      {"offset of another session", [](Calibration& c) { c.imu->time_offsets = {{0.031}}; },
       "Contradicting time offset", "time offset"},
      {"cameras exchanged", swapCameras, "Order of cameras", "cam0 and cam1"},
      {"baseline inverted", invertBaseline, "Inverted baseline", "T_cn_cnm1"},

      {"discrete densities", makeDensitiesDiscrete, "Noise densities", "rig.yaml"},
      {"renamed axes",
       [](Calibration& c) {
         Eigen::Matrix3d R;
         R << 0, 0, 1, 1, 0, 0, 0, 1, 0;
         c.imu->T_SC0.R = R * c.imu->T_SC0.R;
       },
       "Contradicting rotation", "T_cam_imu"},
  };
}

TEST(LintSession, EachMistakeIsNamedAlone) {
  for (const LintCase& fault : sessionCases()) {
    const auto found = lintWith("euroc", truthOf("euroc"), fault.inject);
    ASSERT_EQ(found.size(), 1U) << fault.what << "\n" << rulesOf(found);
    EXPECT_EQ(found[0].rule, fault.rule) << fault.what;
    EXPECT_THAT(found[0].evidence, HasSubstr("rig.yaml")) << fault.what;
    EXPECT_THAT(found[0].advice, HasSubstr(fault.field)) << fault.what;
  }
}

// About the right axis half a turn more is nearly the inverse: inverted, the file would be refused.
TEST(LintSession, AnImuFrameTurnedByHalfATurnIsNotInverted) {
  const auto found = lintWith("euroc", truthOf("euroc"), [](Calibration& c) {
    const Eigen::Matrix3d turn = expSO3({0, 0, std::acos(-1.0)});
    c.imu->T_SC0 = Transform(turn, Eigen::Vector3d::Zero()) * c.imu->T_SC0;
  });
  ASSERT_EQ(found.size(), 1U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Contradicting rotation");
  // Places of several cameras that confirm each other may be inverted all of them: the lever arm,
  // which the recording gives, tells.
  LintedCalibration confirmed = truthOf("euroc");
  confirmed.imu_places_agree = true;
  const auto other = lintWith("euroc", confirmed, invertImu);
  ASSERT_EQ(other.size(), 1U) << rulesOf(other);
  EXPECT_EQ(other[0].rule, "Inverted transform");
}

TEST(LintSession, AnUnknownOffsetIsNotCompared) {
  LintedCalibration unknown = truthOf("euroc");
  unknown.offset_known = false;
  EXPECT_EQ(rulesOf(lintWith("euroc", unknown,
                             [](Calibration& c) { c.imu->time_offsets = {TimeOffset()}; })),
            "");
}

TEST(LintSession, WrongDensitiesHideNoInversion) {
  const auto found = lintWith("euroc", truthOf("euroc"), [](Calibration& c) {
    c.imu->noise.gyro_density *= 100;
    c.imu->T_SC0 = c.imu->T_SC0.inverse();
    c.imu->time_offsets[0].s *= -1;
  });
  ASSERT_EQ(found.size(), 3U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Noise densities");
  EXPECT_EQ(found[1].rule, "Inverted transform");
  EXPECT_EQ(found[2].rule, "Flipped time offset");
}

TEST(LintSession, SamplesWithoutScatterSayNothingOfTheNoise) {
  Session session = recording("euroc").session;
  for (ImuSample& sample : session.imu->samples) sample.accel = {0, 0, 9.81};
  const LintedCalibration linted = truthOf("euroc");
  EXPECT_EQ(rulesOf(lintAgainstSession({&linted, 1}, session)), "");
}

TEST(LintSession, AnInversionShowsWithoutRotation) {
  const auto found = lintWith("d435i", truthOf("d435i"), invertImu);
  ASSERT_EQ(found.size(), 1U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Inverted transform");
}

TEST(LintSession, TheImusColumnsAndUnits) {
  const auto ruleWith = [](const std::function<void(ImuSample&)>& inject) {
    Session session = recording("euroc").session;
    for (ImuSample& sample : session.imu->samples) inject(sample);
    const LintedCalibration linted = truthOf("euroc");
    const auto found = lintAgainstSession({&linted, 1}, session);
    return found.size() == 1 ? found[0].rule : rulesOf(found);
  };
  EXPECT_EQ(ruleWith([](ImuSample& s) { std::swap(s.gyro, s.accel); }),
            "Columns and units of the IMU");
  EXPECT_EQ(ruleWith([](ImuSample& s) { s.accel /= 9.80665; }), "Columns and units of the IMU");
  EXPECT_EQ(ruleWith([](ImuSample& s) { s.gyro *= 180 / std::acos(-1.0); }), "Degrees for radians");
  EXPECT_EQ(ruleWith([](ImuSample& s) { s.gyro.x() *= -1; }), "Gyroscope and cameras");
}

}  // namespace
}  // namespace plumbline

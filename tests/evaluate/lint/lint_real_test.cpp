// SPDX-License-Identifier: BSD-3-Clause
// Lint over every result of Kalibr in PLUMBLINE_SHARED_DATA, alone, beside its repeats, and against
// its recording.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/session/session_reader.h"
#include "evaluate/lint/lint.h"
#include "tests/evaluate/lint/lint_cases.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string shared(const std::string& name) {
  const fs::path path = fs::path(PLUMBLINE_SHARED_DATA) / name;
  EXPECT_TRUE(fs::exists(path)) << path << " is missing; configure with -DPLUMBLINE_SHARED_DATA="
                                << "<folder of the real recordings>";
  return path.string();
}

LintedCalibration runAt(const std::string& path) {
  const KalibrRun run = readKalibrRun(path);
  return {path, run.calibration(), run.imu.has_value()};
}

TEST(RealLint, OneResultOfAllIsImpossible) {
  std::vector<std::string> found;
  int chains = 0;
  for (const char* const folder : {"kalibr_results", "euroc_imu_april/kalibr_runs"}) {
    for (const auto& entry : fs::recursive_directory_iterator(shared(folder))) {
      const auto kind = entry.is_regular_file() ? kalibrFileKind(entry.path().string())
                                                : std::optional<KalibrFileKind>();
      if (kind != KalibrFileKind::kCamchain && kind != KalibrFileKind::kCamchainImu) continue;
      ++chains;
      const LintedCalibration linted = runAt(entry.path().string());
      for (const Finding& f : lintCalibrations({&linted, 1})) {
        found.push_back(f.rule + ": " + f.evidence);
      }
    }
  }
  EXPECT_EQ(chains, 58);
  // 12.7 cm between a D435i's IMU and its left camera, in a housing of 9 cm: the run of that
  // sensor with the lowest residuals.
  for (const std::string& text : found) {
    EXPECT_THAT(text, AllOf(HasSubstr("Impossible lever arm"), HasSubstr("pinhole-radtan-d435i/2/"),
                            HasSubstr("12.7 cm")));
  }
  EXPECT_FALSE(found.empty());
}

TEST(RealLint, RepeatsOfOneSensorShowTheImpossibleRun) {
  const std::string base = shared("kalibr_results/SainaRez_d435i_t265/pinhole-radtan-d435i");
  std::vector<LintedCalibration> runs;
  for (const char* const name : {"", "/2", "/librs2.24.0", "/librs2.24.0/complete"}) {
    runs.push_back(runAt(base + name));
    runs.back().calibration.imu->rostopic.clear();  // without knowing that it is one device
  }
  const auto found = lintCalibrations(runs);
  ASSERT_EQ(found.size(), 1U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Impossible lever arm");
  EXPECT_THAT(found[0].evidence, HasSubstr("pinhole-radtan-d435i/2"));
}

TEST(RealLint, RepeatsOfOtherSensorsAreClean) {
  const std::string rpng = shared("kalibr_results/rpng_ar_table_d455/calibration");
  const std::vector<LintedCalibration> d455{runAt(rpng + "/kalibr_color_0_imu"),
                                            runAt(rpng + "/kalibr_color_1_imu")};
  EXPECT_EQ(rulesOf(lintCalibrations(d455)), "");
  const std::vector<LintedCalibration> euroc{
      runAt(shared("euroc_imu_april/kalibr_runs/camera_imu")),
      {"yac", readCalibration(shared("yac_results/camera_imu.yaml")), true}};
  EXPECT_EQ(rulesOf(lintCalibrations(euroc)), "");
}

TEST(RealLint, EurocRecordingJudgesConventions) {
  const Session session = readSession(shared("euroc_imu_april"));
  const LintedCalibration good = runAt(shared("euroc_imu_april/kalibr_runs/camera_imu"));
  EXPECT_EQ(rulesOf(lintAgainstSession({&good, 1}, session)), "");
  LintedCalibration inverted = good;
  inverted.calibration.imu->T_SC0 = good.calibration.imu->T_SC0.inverse();
  LintedCalibration discrete = good;
  discrete.calibration.imu->noise.gyro_density *= std::sqrt(200.0);
  discrete.calibration.imu->noise.accel_density *= std::sqrt(200.0);
  LintedCalibration swapped = good;
  swapCameras(swapped.calibration);
  const std::vector<LintedCalibration> wrong{inverted, discrete, swapped};
  const auto found = lintAgainstSession(wrong, session);
  ASSERT_EQ(found.size(), 3U) << rulesOf(found);
  EXPECT_EQ(found[0].rule, "Inverted transform");
  EXPECT_EQ(found[1].rule, "Noise densities");
  EXPECT_EQ(found[2].rule, "Order of cameras");
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
// Time offsets injected into EuRoC's imu_april, between and beyond multiples of the IMU's period.
// Further ones by the batch alone are in camera_imu_real_test.cpp.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

TEST(PerturbationOfEuroc, OffsetsOfUpToHalfASecondComeBackToATenthOfAMicrosecond) {
  const std::string data = PLUMBLINE_SHARED_DATA;
  ASSERT_TRUE(std::filesystem::is_directory(data))
      << data << " is missing: configure with -DPLUMBLINE_SHARED_DATA=FOLDER";
  PerturbRequest request;
  request.load.session = data + "/euroc_imu_april";
  request.cameras_file = request.load.session + "/kalibr/camchain-imucam.yaml";
  request.camera.cauchy_px = request.camera_imu.cauchy_px = 0;
  for (int ms = -500; ms <= 500; ms += 500) {
    request.perturbations.push_back({PerturbationKind::kImuShift, ms + 0.37, 0});
  }
  for (const double ms : {-3.21, 0.5, 2.5}) {
    request.perturbations.push_back({PerturbationKind::kImuShift, ms, 0});
  }
  const auto record = perturbSession(request, [](const std::string&, double) {});
  ASSERT_TRUE(record) << record.failure();
  EXPECT_EQ(record->base.frames, 1415);
  for (const PerturbationCase& c : record->cases) {
    EXPECT_EQ(c.problem, "") << c.amount;
    EXPECT_LT(std::abs(c.offset_error_s), 0.1e-6) << c.amount;
  }
  // Kalibr's cameras and this IMU have faults that calibrate names; the offsets all come back.
  for (const Finding& f : record->verdict.findings) {
    const auto expected =
        f.rule == "Base calibration" ? VerdictLevel::kCaution : VerdictLevel::kGood;
    EXPECT_EQ(f.level, expected) << f.rule << ": " << f.evidence;
  }
}

}  // namespace
}  // namespace plumbline

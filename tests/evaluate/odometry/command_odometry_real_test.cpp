// SPDX-License-Identifier: BSD-3-Clause
// The first 17 s of EuRoC MH_01: starts in motion, 5.5 m, one image of camera 1 missing.
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using nlohmann::json;

const fs::path kShared = PLUMBLINE_SHARED_DATA;

class OdometryEuroc : public testing::Test {
 protected:
  void SetUp() override {
    out_ = fs::temp_directory_path() / ("plumbline_odometry_real_" + std::to_string(getpid()));
  }
  void TearDown() override { fs::remove_all(out_); }

  json run(const std::string& options) const {
    const Outcome outcome =
        plumbline("odometry " + (kShared / "euroc_mh01_17s").string() + " --calibration " +
                  (kShared / "euroc_imu_april/kalibr/camchain-imucam.yaml").string() +
                  " --association interpolate --force --out " + out_.string() + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return json::parse(read(out_ / "odometry.json"))["runs"][0];
  }

  fs::path out_;
};

// The bar is 0.9 cm; OpenVINS reaches 0.43 and ORB-SLAM3 0.34 cm.
TEST_F(OdometryEuroc, StereoIsWithinItsBar) {
  const json stereo = run("");
  EXPECT_EQ(stereo["status"], "complete") << stereo["problem"];
  EXPECT_LT(stereo["ate"]["translation_m"]["rmse"], 0.009);
  EXPECT_LT(stereo["ate"]["rotation_deg"]["rmse"], 2);
  EXPECT_EQ(stereo["odometry"]["losses"], 0);
  EXPECT_EQ(stereo["odometry"]["frames"], 341);
}

TEST_F(OdometryEuroc, OneCameraAlone) {
  const json mono = run("--cameras 1 --coverage-from first-pose");
  EXPECT_EQ(mono["status"], "complete") << mono["problem"];
  EXPECT_LT(mono["ate"]["translation_m"]["rmse"], 0.02);
}

}  // namespace
}  // namespace plumbline

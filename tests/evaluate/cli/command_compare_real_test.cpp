// SPDX-License-Identifier: BSD-3-Clause
// EuRoC imu_april: ours with the published cameras, Kalibr's published calibration and a run of
// Kalibr's camera-IMU tool on the same corners.
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "calibrator/base/transform.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const fs::path kEuroc = fs::path(PLUMBLINE_SHARED_DATA) / "euroc_imu_april";
const std::string kPublished = (kEuroc / "kalibr/camchain-imucam.yaml").string();
const std::string kRun = (kEuroc / "kalibr_runs/camera_imu/euroc-camchain-imucam.yaml").string();

class CompareEuroc : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("plumbline_compare_" + std::to_string(getpid()));
    const Outcome outcome =
        plumbline("calibrate " + kEuroc.string() + " --cameras " + kPublished +
                  " --loss none --no-cache --no-report --out " + (root_ / "ours").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static json compared(const std::string& arguments) {
    const Outcome outcome = plumbline("compare --force " + arguments + " --no-report --out " +
                                      (root_ / "out").string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return json::parse(read(root_ / "out/comparison.json"));
  }
  static double difference(const json& document, const std::string& name, std::size_t i = 1) {
    for (const json& p : document["parameters"]) {
      if (p["name"] == name) return p["difference"][i].get<double>();
    }
    ADD_FAILURE() << name;
    return NAN;
  }
  static std::string ours() { return (root_ / "ours/calibration.json").string(); }

  static inline fs::path root_;
};

TEST_F(CompareEuroc, OursLiesWhereKalibrsRunDoes) {
  const json d = compared(ours() + " " + kRun + " " + kPublished + " --labels ours,run,published");
  EXPECT_NEAR(difference(d, "T_SC0.angle"), 0.026 * kDegree, 0.002 * kDegree);
  EXPECT_NEAR(difference(d, "T_SC0.lever"), 0.43e-3, 0.02e-3);
  EXPECT_LT(std::abs(difference(d, "time_offset")), 10e-6);
  EXPECT_LT(difference(d, "T_C0C1.angle"), 1e-6);  // the published cameras, in all three
  // The published camera-IMU transform is from another recording.
  EXPECT_GT(difference(d, "T_SC0.lever", 2), 5 * difference(d, "T_SC0.lever"));
  EXPECT_EQ(d["calibrations"][1]["tool"], "kalibr");
  bool own_figures = false;
  for (const json& f : d["verdict"]["findings"]) {
    own_figures = own_figures || f["rule"] == "run: Kalibr's own errors";
  }
  EXPECT_TRUE(own_figures);
  for (const json& map : d["differences"]) {
    for (const json& v : map["values_px"]) EXPECT_LT(v.get<double>(), 1e-3);
  }
}

TEST_F(CompareEuroc, BothFormatsOfOursAreIdentical) {
  const json d = compared(ours() + " " + (root_ / "ours/camchain-imucam.yaml").string());
  for (const json& p : d["parameters"]) {
    EXPECT_LT(std::abs(p["difference"][1].get<double>()), 1e-9) << p["name"];
  }
}

TEST_F(CompareEuroc, TheOrderOnlyFlipsSigns) {
  const json forth = compared(ours() + " " + kRun);
  const json back = compared(kRun + " " + ours());
  for (const json& p : forth["parameters"]) {
    const std::string name = p["name"];
    const bool norm = name.ends_with(".angle") || name.ends_with(".lever");
    EXPECT_NEAR(p["difference"][1].get<double>(), (norm ? 1 : -1) * difference(back, name), 1e-12)
        << name;
  }
}

// The published cameras predict this recording's corners as its own Kalibr run does: same cameras.
TEST_F(CompareEuroc, EqualCamerasPredictEqually) {
  const json d = compared(kRun + " " + kPublished + " --session " + kEuroc.string() +
                          " --no-cache --stride 10 --range 1 --grid 5x3");
  ASSERT_EQ(d["paired"].size(), 2u);
  for (const json& p : d["paired"]) {
    EXPECT_GT(p["views"].get<int>(), 100);
    EXPECT_LT(std::abs(p["difference_px2"].get<double>()), 1e-4);
  }
  EXPECT_NEAR(d["scores"][0]["entropy_nats"].get<double>(),
              d["scores"][1]["entropy_nats"].get<double>(), 1e-3);
}

}  // namespace
}  // namespace plumbline

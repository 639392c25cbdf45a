// SPDX-License-Identifier: BSD-3-Clause
// plumbline export as a user runs it: files, messages, what is left alone. What the files say is
// export_test's.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const fs::path kConfigs = fs::path(PLUMBLINE_SOURCE_DIR) / "third_party_configs";

class CommandExport : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() / ("plumbline_export_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  fs::path out() const { return root_ / "out"; }
  Outcome exported(const fs::path& calibration, const std::string& options) const {
    return plumbline("export " + calibration.string() + " --out " + out().string() + " " + options);
  }
  Outcome exportedSource(const std::string& options) const {
    return exported(kConfigs / "source/calibration.json", options);
  }
  // One line, exit 2, and no folder that was not there.
  void expectRefusal(const Outcome& outcome, const testing::Matcher<std::string>& words) const {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_THAT(outcome.text, AllOf(testing::StartsWith("plumbline: "), words));
    EXPECT_FALSE(fs::exists(out()));
  }

  fs::path root_;
};

TEST_F(CommandExport, GivesTheCamerasInAnotherModelAndSaysWhatThatCosts) {
  const Outcome outcome = exportedSource("--to basalt --model ds-none");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("as ds-none: 1."), HasSubstr("by region [px]")));
  EXPECT_THAT(contents(out()).at("basalt_calib.json"), HasSubstr("\"camera_type\": \"ds\""));
  fs::remove_all(out());
  expectRefusal(exportedSource("--to basalt --model omni-fov"), HasSubstr("omni-fov"));
}

TEST_F(CommandExport, WritesEveryToolsFilesAndNamesThem) {
  for (const char* tool :
       {"kalibr", "orbslam3", "openvins", "vins-fusion", "okvis2", "basalt", "camera_info"}) {
    const Outcome outcome = exportedSource(std::string("--camera-rate 20 --to ") + tool);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    const auto goldens = contents(kConfigs / tool);
    const auto written = contents(out());
    ASSERT_EQ(written.size(), goldens.size()) << tool;
    for (const auto& [name, text] : written) {
      EXPECT_EQ(goldens.count(name), 1U) << name;
      EXPECT_THAT(outcome.text, HasSubstr((out() / name).string()));
    }
    fs::remove_all(out());
  }
}

TEST_F(CommandExport, JsonListsFilesAndWarnings) {
  const Outcome outcome = exportedSource("--to orbslam3 --json -");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const auto json = nlohmann::json::parse(outcome.text);
  EXPECT_EQ(json["tool"], "orbslam3");
  EXPECT_EQ(json["files"], nlohmann::json{(out() / "orbslam3.yaml").string()});
  EXPECT_EQ(json["warnings"].size(), 3U) << outcome.text;  // time, camera 2, rate
}

TEST_F(CommandExport, MistakesOfUnitsAreSaidBeforeAnotherToolTakesThem) {
  auto json = nlohmann::json::parse(read(kConfigs / "source/calibration.json"));
  json["cameras"][1]["T_C0Ci"][0][3] = 110.07;
  write(root_ / "mm.json", json.dump());
  const Outcome outcome = exported(root_ / "mm.json", "--to basalt");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("warning: "), HasSubstr("110.1 m long")));
}

TEST_F(CommandExport, ReplacesItsOwnFolderOnlyIfToldToAndNoOthers) {
  ASSERT_EQ(exportedSource("--to basalt").exit_code, 0);
  const auto first = contents(out());
  const Outcome again = exportedSource("--to basalt");
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.text, AllOf(HasSubstr("contains an earlier result"), HasSubstr("--force")));
  EXPECT_EQ(exportedSource("--to orbslam3 --force").exit_code, 0);
  EXPECT_EQ(contents(out()).count("orbslam3.yaml"), 1U);
  EXPECT_EQ(contents(out()).size(), 1U);
  for (const auto& [name, text] : {std::pair("notes.txt", "mine"), {"orbslam3.yaml", "edited"}}) {
    const std::string before = read(out() / name);
    write(out() / name, text);
    const Outcome outcome = exportedSource("--to orbslam3 --force");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.text, HasSubstr((out() / name).string()));
    EXPECT_EQ(read(out() / name), text);
    if (before.empty()) fs::remove(out() / name);
  }
}

TEST_F(CommandExport, KalibrsCamchainNeedsTheNoise) {
  const fs::path camchain = kConfigs / "kalibr/camchain-imucam.yaml";
  expectRefusal(exported(camchain, "--to openvins"), HasSubstr("--imu imu.yaml"));
  const std::string imu = " --imu " + (kConfigs / "kalibr/imu.yaml").string();
  ASSERT_EQ(exported(camchain, "--to openvins" + imu).exit_code, 0);
  EXPECT_THAT(read(out() / "kalibr_imu_chain.yaml"),
              HasSubstr("gyroscope_noise_density: 0.00016968\n"));
}

TEST_F(CommandExport, OnlyOneCamera) {
  ASSERT_EQ(exportedSource("--to camera_info --only cam1").exit_code, 0);
  EXPECT_TRUE(fs::exists(out() / "cam1.yaml"));
  EXPECT_FALSE(fs::exists(out() / "cam0.yaml"));
}

TEST_F(CommandExport, RefusalsLeaveNothingBehind) {
  write(root_ / "chain.yaml", read(kConfigs / "kalibr/camchain-imucam.yaml"));
  expectRefusal(exported(root_ / "chain.yaml", "--to openvins"),
                HasSubstr("does not state them; give its noise densities with --imu imu.yaml\n"));
  expectRefusal(exportedSource("--to rtabmap"), HasSubstr("vins-fusion"));
  for (const std::string rate : {"0", "-5", "nan", "2e6"}) {
    expectRefusal(exportedSource("--to kalibr --camera-rate " + rate),
                  HasSubstr("--camera-rate: " + rate + ": expected 1e-06 to 1e+06"));
  }
  expectRefusal(exportedSource("--to orbslam3 --only cam7"), HasSubstr("cam0, cam1"));
  expectRefusal(exported(root_ / "nowhere.json", "--to kalibr"), HasSubstr("nowhere.json"));
  expectRefusal(exported(kConfigs / "targets/target_6x6.yaml", "--to kalibr"),
                HasSubstr("target_6x6.yaml"));
  fs::path omni = root_ / "omni.yaml";
  write(omni,
        "cam0:\n  camera_model: omni\n  intrinsics: [1.8, 1100.0, 1100.0, 370.0, 240.0]\n"
        "  distortion_model: radtan\n  distortion_coeffs: [-0.1, 0.2, 0.001, 0.001]\n"
        "  resolution: [752, 480]\n  rostopic: /cam0/image_raw\n");
  expectRefusal(exported(omni, "--to orbslam3"),
                AllOf(HasSubstr("ORB-SLAM3"), HasSubstr("omni-radtan"), HasSubstr("export")));
}

TEST_F(CommandExport, HelpHasAnExample) {
  const Outcome outcome = plumbline("export --help");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("Example"), HasSubstr("plumbline export result")));
}

}  // namespace
}  // namespace plumbline

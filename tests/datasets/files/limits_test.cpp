// SPDX-License-Identifier: BSD-3-Clause
// Texts that are too large, too deep or of another coding; values that no rig has; what a terminal
// is shown of a file's bytes.
#include <chrono>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/numbers.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/camera_description.h"
#include "datasets/session/image_list.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(ShownText, KeepsWordsAndEscapesWhatMovesATerminal) {
  EXPECT_EQ(shownText("cam0 \u00b5\u03c3 \u2013 \U0001F600\nnext"),
            "cam0 \u00b5\u03c3 \u2013 \U0001F600\nnext");
  EXPECT_EQ(shownLine("two\nlines\tand\rmore"), "two\\nlines\\tand\\x0dmore");
  EXPECT_EQ(shownText("\x1b[31mred\x07\x7f"), "\\x1b[31mred\\x07\\x7f");
  EXPECT_EQ(shownText("\u009b31m"), "\\x9b31m");              // C1, of two bytes
  EXPECT_EQ(shownText("a\u202egnp.exe"), "a\\u202egnp.exe");  // right to left
  EXPECT_EQ(shownText("\u2066x\u2069\u200f"), "\\u2066x\\u2069\\u200f");
  EXPECT_EQ(shownText("na\xefve"), "na\\xefve");  // Latin-1
  EXPECT_EQ(shownText("\xc0\xaf \xed\xa0\x80"),
            "\\xc0\\xaf \\xed\\xa0\\x80");  // overlong, surrogate
  EXPECT_EQ(shownText("cut \xe2\x80"), "cut \\xe2\\x80");
}

TEST(ShownText, KnowsUtf8) {
  EXPECT_TRUE(isUtf8("plain \u00e9 \U0001F600"));
  for (const char* bad : {"\xff", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_FALSE(isUtf8(bad));
  }
}

class YamlLimits : public testing::Test {
 protected:
  std::optional<BadInput> refused(const std::string& text) const {
    const std::string path = folder_.write("file.yaml", text);
    return refusalOf([&] { (void)YamlMap::load(path, "a mapping"); });
  }
  TemporaryFolder folder_;
};

TEST_F(YamlLimits, ASecondDocumentIsNotPassedOver) {
  const auto refusal = refused("a: 1\nb: 2\n---\nc: 3\n");
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->line(), 4);
  EXPECT_THAT(refusal->what(), HasSubstr("second YAML document"));
  EXPECT_FALSE(refused("---\na: 1\n...\n"));
  EXPECT_FALSE(refused("%YAML:1.0\n---\na: 1\n"));
  EXPECT_FALSE(refused("a: 1\n---\n"));
}

// A zero byte is not the end of what is read.
TEST_F(YamlLimits, NorIsOneBehindJson) {
  EXPECT_FALSE(refused("{\"a\": 1}\n"));
  for (const char* more : {"b: 1", "\n---\nb: 1\n", "\n---\nb: \"\\uD800\"\n"}) {
    EXPECT_TRUE(refused(std::string("{\"a\": 1}") + '\0' + more)) << more;
    EXPECT_TRUE(refused(std::string("{\"a\": 1}\n") + more)) << more;
  }
}

TEST_F(YamlLimits, SizeDepthAndCodingAreBounded) {
  EXPECT_TRUE(refused("a: [" + std::string(5'000'000, '1') + "]\n"));
  EXPECT_TRUE(refused("a: " + std::string(100'000, '[')));
  EXPECT_TRUE(refused("a: " + std::string(2000, '[') + std::string(2000, ']')));
  std::string indented;
  for (int level = 0; level < 1000; ++level) indented += std::string(level, ' ') + "a:\n";
  EXPECT_TRUE(refused(indented));
  EXPECT_TRUE(refused("a: na\xefve\n"));
}

TEST_F(YamlLimits, AnEscapeThatGivesNoUtf8IsRefusedWithItsLine) {
  for (const char* escape : {"\\N", "\\_"}) {  // yaml-cpp 0.7 decodes both to a single byte
    const auto refusal = refused("a: 1\nb: \"/imu" + std::string(escape) + "0\"\n");
    ASSERT_TRUE(refusal) << escape;
    EXPECT_EQ(refusal->line(), 2);
    EXPECT_THAT(refusal->what(), HasSubstr("is not a Unicode character"));
  }
  EXPECT_FALSE(refused("a: \"/imu\\u00e9\\x41\\L0\"\n"));
}

// Each name stands for nine of the one before: 9^25 values if they were copied.
TEST_F(YamlLimits, AnAliasBombIsReadInNoTime) {
  std::string bomb = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (char name = 'b'; name <= 'z'; ++name) {
    bomb += std::string(1, name) + ": &" + name + " [";
    for (int i = 0; i < 9; ++i) bomb += std::string(i > 0 ? ", *" : "*") + char(name - 1);
    bomb += "]\n";
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(refused(bomb));
  EXPECT_TRUE(faultOf([&] { (void)readCalibration(folder_.write("bomb.yaml", bomb)); }));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

Calibration rig() {
  Calibration calibration;
  CameraCalibration camera;
  camera.name = "cam0";
  camera.intrinsics.resolution = {752, 480};
  camera.intrinsics.projection = Eigen::Vector4d(458.654, 457.296, 367.215, 248.375);
  camera.intrinsics.distortion = Eigen::Vector4d(-0.283, 0.074, 1e-5, 1e-5);
  calibration.cameras = {camera};
  calibration.imu.emplace();
  return calibration;
}

template <class Change>
std::optional<BadInput> exportRefused(const Change& change) {
  Calibration calibration = rig();
  change(calibration);
  ExportOptions options;
  options.source = "calibration.json";
  return refusalOf([&] { (void)exportCalibration(calibration, ExportTool::kKalibr, options); });
}

TEST(Plausible, ExportersRefuseWhatNoRigHas) {
  EXPECT_FALSE(exportRefused([](Calibration&) {}));
  const auto refused = [](const auto& change, const char* words) {
    const auto refusal = exportRefused(change);
    ASSERT_TRUE(refusal) << words;
    EXPECT_EQ(refusal->code(), InputFault::kOutOfRange);
    EXPECT_THAT(refusal->what(), HasSubstr(words));
    EXPECT_THAT(refusal->what(), HasSubstr("expected"));
  };
  const double nan = std::nan("");
  refused([](Calibration& c) { c.cameras[0].intrinsics.projection(0) = 0; }, "focal length is 0");
  refused([](Calibration& c) { c.cameras[0].intrinsics.projection(1) = -400; }, "focal length");
  refused([&](Calibration& c) { c.cameras[0].intrinsics.projection(2) = nan; }, "projection");
  refused([](Calibration& c) { c.cameras[0].intrinsics.distortion(3) = 1e30; }, "distortion");
  refused([](Calibration& c) { c.cameras[0].intrinsics.resolution.width = 1 << 30; }, "resolution");
  refused([](Calibration& c) { c.cameras[0].intrinsics.resolution.height = 0; }, "resolution");
  refused([](Calibration& c) { c.imu->noise.gyro_density = -1; }, "noise density of the IMU is -1");
  refused([&](Calibration& c) { c.imu->noise.accel_random_walk = nan; }, "noise density");
  refused([](Calibration& c) { c.imu->noise.rate_hz = -200; }, "rate");
  refused([](Calibration& c) { c.imu->gravity_m_s2 = -9.8; }, "gravity");
  refused([](Calibration& c) { c.imu->time_offsets = {{1e6}}; }, "time offset");
  refused([](Calibration& c) { c.imu->T_SC0.t.x() = 1e5; }, "IMU");
  refused([](Calibration& c) { c.imu->time_offset_std_s = -1; }, "deviation is -1");
  refused([](Calibration& c) { c.imu->T_SC0_std = -Vector6d::Ones(); }, "deviation is -1");
  refused([](Calibration& c) { c.cameras[0].T_C0Ci_std = -Vector6d::Ones(); }, "deviation is -1");
  refused([](Calibration& c) { c.cameras[0].intrinsics_std = -Eigen::VectorXd::Ones(8); },
          "deviation is -1");
  for (const char* name : {"", "../cam0", "a/b", ".hidden", "cam\n0", "\x1b[31m", "cam 0"}) {
    refused([&](Calibration& c) { c.cameras[0].name = name; }, "a camera is named");
  }
}

TEST(Plausible, ReadersNameTheLine) {
  const TemporaryFolder folder;
  const std::string good = kalibrCamchainText(rig());
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return refusalOf([&] { (void)readCalibration(folder.write("camchain.yaml", text)); });
  };
  const auto lineOf = [&](const std::string& key) {
    return 1 + static_cast<int>(std::count(good.begin(), good.begin() + good.find(key), '\n'));
  };
  EXPECT_FALSE(refusal("752", "1000"));
  for (const auto& [from, to, key] :
       {std::array{"458.654", "0.0", "intrinsics"}, std::array{"458.654", "-1.0", "intrinsics"},
        std::array{"[752, 480]", "[1e30, 480]", "resolution"},
        std::array{"[752, 480]", "[752, 0]", "resolution"},
        std::array{"-0.283", "1e20", "distortion_coeffs"},
        std::array{"timeshift_cam_imu: 0.0", "timeshift_cam_imu: 1e9", "timeshift_cam_imu"}}) {
    const auto refused = refusal(from, to);
    ASSERT_TRUE(refused) << to;
    EXPECT_EQ(refused->line(), lineOf(key)) << refused->what();
  }
  EXPECT_EQ(refusal("timeshift_cam_imu", "rolling_shutter: true\n  timeshift_cam_imu")->code(),
            InputFault::kUnsupported);
}

TEST(Plausible, ARollingShutterOfASensorIsRefused) {
  const TemporaryFolder folder;
  const std::string yaml = "resolution: [752, 480]\nrolling_shutter: ";
  const auto refusal = refusalOf(
      [&] { (void)readCameraDescription(folder.write("sensor.yaml", yaml + "true\n"), true); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->line(), 2);
  EXPECT_NO_THROW((void)readCameraDescription(folder.write("sensor.yaml", yaml + "false\n"), true));
}

TEST(Plausible, AListOfImagesCannotLeadElsewhere) {
  const TemporaryFolder folder;
  for (const char* name : {"../../secret.png", "/etc/passwd", "a\x1b[31m.png", "na\xefve.png"}) {
    folder.write("cam0/data.csv",
                 std::string("#timestamp [ns],filename\n1000000000,") + name + "\n");
    const auto refusal = refusalOf([&] { (void)readFrameList(folder.path("cam0")); });
    ASSERT_TRUE(refusal) << name;
    EXPECT_EQ(refusal->line(), 2);
  }
}

}  // namespace
}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <png.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/session_writer.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A folder of the test's own, removed at its end.
class SimulatedSessionFiles : public testing::Test {
 protected:
  SimulatedSessionFiles() {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    root_ = fs::temp_directory_path() / ("plumbline-" + name + "-" + std::to_string(getpid()));
    for (const char* folder : {"session", "1", "3", "other"}) {
      fs::create_directories(root_ / folder);
    }
  }
  ~SimulatedSessionFiles() override { fs::remove_all(root_); }

  /// Content of every file below a folder, by relative path.
  static std::map<std::string, std::string> contentOf(const fs::path& folder) {
    std::map<std::string, std::string> content;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream in(entry.path(), std::ios::binary);
      content[fs::relative(entry.path(), folder).string()] =
          std::string(std::istreambuf_iterator<char>(in), {});
    }
    return content;
  }

  fs::path root_;
};

/// A rig with small images, so that rendering costs little.
SimulatedRig smallRig() {
  SimulatedRig rig = simulatedRig("euroc");
  for (CameraCalibration& camera : rig.calibration.cameras) {
    camera.intrinsics.resolution = {188, 120};
    camera.intrinsics.projection *= 0.25;
  }
  return rig;
}

SimulationOptions briefOptions() {
  SimulationOptions o;
  o.duration_s = 0.25;
  o.min_tag_px = 4;
  return o;
}

/// A grey PNG as libpng reads it.
GrayImage readPng(const fs::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, path.c_str()) == 0) return {};
  if (png.format != PNG_FORMAT_GRAY) return {};
  GrayImage image(static_cast<int>(png.width), static_cast<int>(png.height));
  png_image_finish_read(&png, nullptr, image.data(), 0, nullptr);
  return image;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<double> fieldsOf(const std::string& line) {
  std::istringstream in(line);
  std::vector<double> fields;
  for (std::string field; std::getline(in, field, ',');) fields.push_back(std::stod(field));
  return fields;
}

TEST_F(SimulatedSessionFiles, CornersSessionHasTheEurocLayout) {
  const SimulatedSession s = simulateSession(smallRig(), briefOptions());
  writeSimulatedSession(s, briefOptions(), root_ / "session");
  std::vector<std::string> names;
  for (const auto& [name, text] : contentOf(root_ / "session")) names.push_back(name);
  EXPECT_THAT(names,
              ElementsAre("imu.yaml", "mav0/cam0/corners.csv", "mav0/cam0/data.csv",
                          "mav0/cam0/sensor.yaml", "mav0/cam1/corners.csv", "mav0/cam1/data.csv",
                          "mav0/cam1/sensor.yaml", "mav0/imu0/data.csv", "mav0/imu0/sensor.yaml",
                          "target.yaml", "truth/camchain-imucam.yaml", "truth/trajectory.csv",
                          "truth/truth.json"));
}

TEST_F(SimulatedSessionFiles, CornersAndSamplesAreThoseOfTheSession) {
  const SimulatedSession s = simulateSession(smallRig(), briefOptions());
  const auto files = sessionFiles(s.session, 20, ViewFormat::kCorners);
  const auto textOf = [&](const std::string& path) {
    for (const TextFile& f : files) {
      if (f.path == path) return linesOf(f.text);
    }
    return std::vector<std::string>{};
  };
  const auto corners = textOf("mav0/cam0/corners.csv");
  const ImageView& view = s.session.cameras[0].views.front();
  ASSERT_FALSE(view.corners.empty());
  ASSERT_GT(corners.size(), 1U);
  EXPECT_EQ(corners[0], "#timestamp [ns],corner_id,u [px],v [px]");
  EXPECT_THAT(corners[1],
              StartsWith(std::to_string(view.t) + "," + std::to_string(view.corners[0].id) + ","));
  EXPECT_NEAR(fieldsOf(corners[1])[2], view.corners[0].uv.x(), 1e-9);
  const auto samples = textOf("mav0/imu0/data.csv");
  ASSERT_EQ(samples.size(), s.session.imu->samples.size() + 1);
  const ImuSample& first = s.session.imu->samples.front();
  EXPECT_THAT(samples[1], StartsWith(std::to_string(first.t) + ","));
  EXPECT_NEAR(fieldsOf(samples[1])[1], first.gyro.x(), 1e-11);
  EXPECT_NEAR(fieldsOf(samples[1])[6], first.accel.z(), 1e-10);
}

TEST_F(SimulatedSessionFiles, ReadBackItIsTheSameRecording) {
  const SimulatedSession s = simulateSession(smallRig(), briefOptions());
  writeSimulatedSession(s, briefOptions(), root_ / "session");
  const Session read = readSession((root_ / "session").string());
  EXPECT_EQ(read.target.tag_size, s.session.target.tag_size);
  ASSERT_EQ(read.cameras.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const CameraStream& camera = read.cameras[i];
    const CameraStream& original = s.session.cameras[i];
    EXPECT_EQ(camera.resolution, original.resolution);
    EXPECT_EQ(camera.distortion_model, "radtan");
    EXPECT_EQ(camera.rostopic, original.rostopic);
    ASSERT_EQ(camera.views.size(), original.views.size());
    for (std::size_t k = 0; k < camera.views.size(); ++k) {
      const auto& corners = camera.views[k].corners;
      EXPECT_EQ(camera.views[k].t, original.views[k].t);
      ASSERT_EQ(corners.size(), original.views[k].corners.size());
      for (std::size_t c = 0; c < corners.size(); ++c) {
        ASSERT_EQ(corners[c].id, original.views[k].corners[c].id);
        ASSERT_LE((corners[c].uv - original.views[k].corners[c].uv).norm(), 1e-9);
      }
    }
  }
  ASSERT_TRUE(read.imu.has_value());
  ASSERT_EQ(read.imu->samples.size(), s.session.imu->samples.size());
  EXPECT_EQ(read.imu->noise.accel_density, s.session.imu->noise.accel_density);
  for (std::size_t k = 0; k < read.imu->samples.size(); ++k) {
    ASSERT_EQ(read.imu->samples[k].t, s.session.imu->samples[k].t);
    ASSERT_LE((read.imu->samples[k].accel - s.session.imu->samples[k].accel).norm(), 1e-9);
  }
}

TEST_F(SimulatedSessionFiles, ImagesTakeThePlaceOfCorners) {
  const SimulatedSession s = simulateSession(smallRig(), briefOptions());
  SimulatedSessionFormat format;
  format.views = ViewFormat::kImages;
  std::size_t reported = 0;
  format.progress = [&](std::size_t, std::size_t all) { reported += all == 10; };
  writeSimulatedSession(s, briefOptions(), root_ / "session", format);
  EXPECT_EQ(reported, 10U);  // 5 frames of 2 cameras
  const Recording recording = readRecording((root_ / "session").string());
  EXPECT_TRUE(recording.needsDetection());
  ASSERT_EQ(recording.images.size(), 2U);
  EXPECT_EQ(recording.images[1].size(), 5U);
  const fs::path camera = root_ / "session" / "mav0" / "cam1";
  EXPECT_FALSE(fs::exists(camera / "corners.csv"));
  const TimeNs t = s.session.cameras[1].views[3].t;
  const fs::path png = camera / "data" / (std::to_string(t) + ".png");
  const GrayImage image = readPng(png);
  ASSERT_EQ(image.width(), 188);
  ASSERT_EQ(image.height(), 120);
  const TargetRenderer renderer(s.truth.cameras[1].intrinsics, s.session.target);
  const GrayImage expected = renderer.render(s.cameraPose(1, t), (1ULL << 32U) + 3);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 188; ++x) ASSERT_EQ(image.at(x, y), expected.at(x, y));
  }
}

// Exposed later than stamped, in front of a board of another size than stated, with one camera
// turned: the image is that of the real pose and board under the wrong stamp.
TEST_F(SimulatedSessionFiles, ImagesShowWhatReallyStoodThere) {
  SimulationOptions o = briefOptions();
  o.faults = {{.kind = FaultKind::kExposureShift, .value = 0.01},
              {.kind = FaultKind::kBump, .value = 0.02, .at_s = 0},
              {.kind = FaultKind::kWrongSize, .value = 0.1}};
  const SimulatedSession s = simulateSession(smallRig(), o);
  SimulatedSessionFormat format;
  format.views = ViewFormat::kImages;
  writeSimulatedSession(s, o, root_ / "session", format);
  EXPECT_DOUBLE_EQ(readRecording((root_ / "session").string()).session.target.tag_size,
                   1.1 * o.target.tag_size);
  const TimeNs t = s.session.cameras[1].views[3].t;
  const Transform T_FS =
      s.trajectory.at(secondsBetween(s.start_ns, t) + s.truth.imu->timeOffset() + 0.01).T_FB;
  Transform T_FC1 = T_FS * s.truth.imu->T_SC0 * s.truth.cameras[1].T_C0Ci;
  T_FC1.R *= expSO3(Eigen::Vector3d::Constant(0.02 / std::sqrt(3.0)));
  const TargetRenderer renderer(s.truth.cameras[1].intrinsics, o.target);
  const GrayImage expected = renderer.render(T_FC1, (1ULL << 32U) + 3);
  const fs::path data = root_ / "session" / "mav0" / "cam1" / "data";
  const GrayImage image = readPng(data / (std::to_string(t) + ".png"));
  int different = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 188; ++x) different += image.at(x, y) != expected.at(x, y) ? 1 : 0;
  }
  EXPECT_LE(different, 2);  // the pose is the same but for the last bits, which may turn a rounding
}

TEST_F(SimulatedSessionFiles, FaultsThatImagesCannotShowAreRefused) {
  SimulationOptions o = briefOptions();
  SimulationOptions detector = o;
  detector.target.shape.terms[kTargetTerms - 1] = 1e-3;
  SimulatedSessionFormat images;
  images.views = ViewFormat::kImages;
  EXPECT_THROW(writeSimulatedSession(simulateSession(smallRig(), detector), detector,
                                     root_ / "session", images),
               InputError);
  o.faults = {{.kind = FaultKind::kBow, .value = 0.001}};
  const SimulatedSession s = simulateSession(smallRig(), o);
  SimulatedSessionFormat format;
  format.views = ViewFormat::kImages;
  EXPECT_THROW(writeSimulatedSession(s, o, root_ / "session", format), InputError);
  EXPECT_TRUE(fs::is_empty(root_ / "session"));
}

TEST_F(SimulatedSessionFiles, TruthListsTheFaultsWithValuesInstantsAndStamps) {
  SimulationOptions o = briefOptions();
  o.faults = {{.kind = FaultKind::kSlip, .value = 0.01, .at_s = 0.125, .axis = 2, .spec = "slip"},
              {.kind = FaultKind::kSpike, .value = 100, .extent = 3}};
  const SimulatedSession s = simulateSession(smallRig(), o);
  writeSimulatedSession(s, o, root_ / "session");
  std::ifstream in(root_ / "session" / "truth" / "truth.json");
  const auto faults = nlohmann::json::parse(in).at("faults");
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0], (nlohmann::json{{"name", "slip"},
                                       {"spec", "slip"},
                                       {"value", 0.01},
                                       {"unit", "rad"},
                                       {"at_s", 0.125},
                                       {"axis", "z"}}));
  EXPECT_EQ(faults[1].at("extent"), 3);
  EXPECT_EQ(faults[1].at("extent_unit"), "rad/s");
  EXPECT_FALSE(s.faults[1].stamps.empty());
  EXPECT_EQ(faults[1].at("stamps_ns").get<std::vector<TimeNs>>(), s.faults[1].stamps);
}

TEST_F(SimulatedSessionFiles, SameSeedSameBytesWhateverTheThreads) {
  SimulatedSessionFormat format;
  format.views = ViewFormat::kImages;
  for (const int threads : {1, 3}) {
    format.threads = threads;
    const SimulatedSession s = simulateSession(smallRig(), briefOptions());
    writeSimulatedSession(s, briefOptions(), root_ / std::to_string(threads), format);
  }
  EXPECT_TRUE(contentOf(root_ / "1") == contentOf(root_ / "3"));
  SimulationOptions other = briefOptions();
  other.seed = 2;
  writeSimulatedSession(simulateSession(smallRig(), other), other, root_ / "other", format);
  EXPECT_FALSE(contentOf(root_ / "1") == contentOf(root_ / "other"));
}

TEST_F(SimulatedSessionFiles, NoFileIsWrittenOver) {
  fs::create_directories(root_ / "taken");
  std::ofstream(root_ / "taken" / "target.yaml") << "keep me";
  const SimulatedSession s = simulateSession(smallRig(), briefOptions());
  EXPECT_THROW(writeSimulatedSession(s, briefOptions(), root_ / "taken"), InputError);
  EXPECT_EQ(contentOf(root_ / "taken").at("target.yaml"), "keep me");
}

TEST(SimulatedTruth, JsonHoldsTheCalibrationExactly) {
  const SimulatedSession s = simulateSession(simulatedRig("tumvi"), briefOptions());
  const auto truth = nlohmann::json::parse(truthJson(s, briefOptions()));
  EXPECT_EQ(truth["imu"]["time_offset_s"].get<double>(), s.truth.imu->timeOffset());
  EXPECT_EQ(truth["imu"]["T_SC0"][1][3].get<double>(), s.truth.imu->T_SC0.t.y());
  EXPECT_EQ(truth["cameras"][1]["T_C0Ci"][0][3].get<double>(), s.truth.cameras[1].T_C0Ci.t.x());
  EXPECT_EQ(truth["cameras"][0]["distortion"], "equidistant");
  EXPECT_EQ(truth["options"]["seed"], 1);
  EXPECT_EQ(truth["gravity_F"][1].get<double>(), s.gravity_F.y());
}

// truth.json has the fields of calibration.json.
TEST(SimulatedTruth, CamerasThatContradictEachOtherAreRefused) {
  const TemporaryFolder folder;
  const SimulatedSession s = simulateSession(simulatedRig("tumvi"), briefOptions());
  const auto good = nlohmann::json::parse(truthJson(s, briefOptions()));
  const auto fault = [&](const nlohmann::json& json) {
    const std::string path = folder.write("truth.json", json.dump(2));
    return faultOf([&] { (void)readCalibration(path); });
  };
  EXPECT_EQ(fault(good), std::nullopt);
  auto moved = good;
  moved["cameras"][0]["T_C0Ci"] = good["cameras"][1]["T_C0Ci"];
  EXPECT_EQ(fault(moved), InputFault::kContradiction);
  auto alike = good;
  alike["cameras"][1]["name"] = good["cameras"][0]["name"];
  EXPECT_EQ(fault(alike), InputFault::kDuplicate);
}

TEST(SimulatedTruth, CamchainIsInKalibrsDirections) {
  const Calibration c = simulatedRig("euroc").calibration;
  const std::string text = kalibrCamchainText(c);
  // Camera 1 stands 11 cm to the right of camera 0, so camera 0 is at -11 cm in camera 1.
  EXPECT_THAT(text, HasSubstr("cam1:\n  T_cam_imu:"));
  const std::string chain = text.substr(text.find("T_cn_cnm1:"));
  EXPECT_NEAR(
      std::stod(chain.substr(chain.find(", ", chain.find(", ", chain.find(", ") + 1) + 1) + 2)),
      -0.11007, 1e-4);
  EXPECT_THAT(text, HasSubstr("timeshift_cam_imu: 0.0021\n"));
  EXPECT_THAT(text, HasSubstr("intrinsics: [458.654, 457.296, 367.215, 248.375]"));
  EXPECT_THAT(text, HasSubstr("cam_overlaps: [1]"));
}

TEST(SimulatedTruth, TrajectoryIsInTheWorldAtTheSamplesStamps) {
  const SimulatedSession s = simulateSession(simulatedRig("euroc"), briefOptions());
  const auto lines = linesOf(trajectoryCsv(s));
  ASSERT_EQ(lines.size(), s.session.imu->samples.size() + 1);
  const TimeNs t = s.session.imu->samples[7].t;
  EXPECT_THAT(lines[8], StartsWith(std::to_string(t) + ","));
  const auto f = fieldsOf(lines[8]);
  ASSERT_EQ(f.size(), 17U);
  const MotionState m = s.motionAtImuTime(t);
  const Transform T_WS = s.T_WF() * m.T_FB;
  EXPECT_LE((Eigen::Vector3d(f[1], f[2], f[3]) - T_WS.t).norm(), 1e-11);
  const Transform read(Eigen::Quaterniond(f[4], f[5], f[6], f[7]), T_WS.t);
  EXPECT_LE((read.R - T_WS.R).norm(), 1e-10);
  // The accelerometer in W: R_WS f = a - g, so a rig at rest would read +9.8 along z of W.
  const Eigen::Vector3d force_W = T_WS.R * (s.session.imu->samples[7].accel - s.biases[7].accel);
  const Eigen::Vector3d a_W = s.T_WF().R * m.a_F;
  EXPECT_NEAR((force_W - a_W).z(), 9.80655, 0.2);  // white noise of 0.03 m/s^2
  EXPECT_NEAR(f[14], s.biases[7].accel.x(), 1e-12);
}

}  // namespace
}  // namespace plumbline

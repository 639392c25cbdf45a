// SPDX-License-Identifier: BSD-3-Clause
// Readers of a recording's files.
#include <algorithm>

#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulate_session.h"
#include "datasets/calibration/kalibr/camchain.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/file_io.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/camera_description.h"
#include "datasets/session/corner_cache.h"
#include "datasets/session/corners.h"
#include "datasets/session/image_list.h"
#include "datasets/session/imu.h"
#include "datasets/session/session_writer.h"
#include "datasets/session/study_reader.h"
#include "datasets/session/suggestions_reader.h"
#include "datasets/session/target.h"
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

constexpr double kCameraRate = 20;
constexpr Resolution kResolution{752, 480};

/// The file of that ending among those that the writer of sessions makes of this one.
std::string written(const Session& session, const std::string& ending) {
  for (const TextFile& file : sessionFiles(session, kCameraRate, ViewFormat::kCorners)) {
    if (file.path.ends_with(ending)) return file.text;
  }
  throw std::logic_error("no file " + ending);
}

/// A tenth of a second, of which each view keeps a few corners.
Session smallSession(const std::string& rig) {
  SimulationOptions options;
  options.duration_s = 0.1;
  options.imu_margin_s = 0;
  Session session = simulateSession(simulatedRig(rig), options).session;
  for (CameraStream& camera : session.cameras) {
    for (ImageView& view : camera.views) {
      view.corners.resize(std::min<std::size_t>(view.corners.size(), 6));
    }
  }
  session.imu->samples.resize(std::min<std::size_t>(session.imu->samples.size(), 12));
  return session;
}

std::vector<std::string> seedsOf(const std::string& ending) {
  std::vector<std::string> seeds;
  for (const std::string& rig : simulatedRigNames()) {
    seeds.push_back(written(smallSession(rig), ending));
  }
  return seeds;
}

Session withViews(std::vector<ImageView> views) {
  Session session;
  session.cameras.push_back({"cam0", "", kResolution, "", "", std::move(views)});
  return session;
}

std::string imuText(const ImuDescription& imu) {
  Session session;
  session.imu = ImuStream{imu.rostopic, imu.noise, {}};
  return written(session, "imu.yaml");
}

std::string describedText(const CameraDescription& camera) {
  Session session = withViews({});
  session.cameras[0].resolution = *camera.resolution;
  session.cameras[0].camera_model = camera.camera_model;
  session.cameras[0].distortion_model = camera.distortion_model;
  session.cameras[0].rostopic = camera.rostopic;
  return written(session, "cam0/sensor.yaml");
}

}  // namespace

Parser corners() {
  const auto read = [](const std::string& path) {
    return readCorners(path, {AprilGrid{}.cornerCount(), kResolution, true});
  };
  const auto write = [](const std::vector<ImageView>& views) {
    return written(withViews(views), "corners.csv");
  };
  return {[=](const std::string& path) { expectStable(path, read(path), write, read); },
          [] { return seedsOf("cam0/corners.csv"); }};
}

Parser imu_samples() {
  const auto write = [](const std::vector<ImuSample>& samples) {
    Session session;
    session.imu = ImuStream{"", {}, samples};
    return written(session, "imu0/data.csv");
  };
  return {[=](const std::string& path) {
            expectStable(path, readImuSamples(path), write, readImuSamples);
          },
          [] { return seedsOf("imu0/data.csv"); },
          {"a_x", "a_y", "a_z", "w_x", "[deg", "[g]"}};
}

Parser image_list() {
  const auto read = [](const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const std::vector<ImageFile> frames = readFrameList(folder);
    std::filesystem::create_directories(folder / "data");
    try {
      listImages(folder);
    } catch (const InputError&) {  // most often an image that is not there
    }
    for (std::size_t i = 1; i < frames.size(); ++i) {
      if (frames[i].t <= frames[i - 1].t) throw Unstable("stamps that do not ascend");
    }
  };
  return {read, [] { return seedsOf("cam0/data.csv"); }, {}, "data.csv"};
}

Parser target() {
  return {[](const std::string& path) {
            expectStable(path, readTarget(path), kalibrTargetText, readTarget);
          },
          [] { return seedsOf("target.yaml"); },
          {"checkerboard", "circlegrid"}};
}

Parser sensor() {
  const auto read = [](const std::string& path) { return readCameraDescription(path, false); };
  return {[=](const std::string& path) {
            const CameraDescription camera = read(path);
            if (camera.resolution) expectStable(path, camera, describedText, read);
          },
          [] { return seedsOf("cam0/sensor.yaml"); },
          {"line_delay", "omni", "eucm", "ds", "fov", "none", "equidistant", "plumb_bob"}};
}

Parser imu_yaml() {
  const auto read = [](const std::string& path) {
    YamlMap::load(path, "an IMU");  // once where it is no YAML
    try {
      readKalibrImus(path);
    } catch (const InputError&) {  // refuses less of the models and more of the keys
    }
    expectStable(path, readImuDescription(path), imuText, readImuDescription);
  };
  const auto seeds = [] {
    std::vector<std::string> texts = seedsOf("imu.yaml");
    texts.push_back(kalibrImuText(ImuNoise{}, "/imu0"));
    texts.push_back(written(smallSession("euroc"), "imu0/sensor.yaml"));
    return texts;
  };
  return {read, seeds, {"scale-misalignment", "scale-misalignment-size-effect", "imu1", "A"}};
}

Parser suggestions() {
  const auto seeds = [] {
    return std::vector<std::string>{
        "#t_ns,stage,id,T_FC0\n0,camera,1,0.1,0.2,0.6,0,0,0.6,0.8\n"
        "2000000000,camera,2,0.1,0.2,0.6,0,1,0,0\n2000000000,camera-imu,1,0,0,0.5,1,0,0,0\n",
        "5,camera,0,1,0,0,0.1,0,1,0,0.2,0,0,1,0.3,0,0,0,1\n"
        "6,camera-imu,-7,0,-1,0,0.1,1,0,0,0.2,0,0,1,0.3\n"};
  };
  return {[](const std::string& path) { readSuggestions(path); }, seeds, {}};
}

Parser study() {
  const std::vector<std::string> known{"offsets-ms", "corner-noise-px", "noise-factors"};
  const auto seeds = [] {
    return std::vector<std::string>{"offsets-ms: [100, 10, 1]\ncorner-noise-px: 0.1:0.1:0.5\n",
                                    "noise-factors:\n  - 0.5\n  - 2\noffsets-ms: -3\n"};
  };
  return {[=](const std::string& path) { readStudyDefinition(path, known); }, seeds, {}};
}

Parser corner_cache() {
  constexpr const char* kKey = "00000000000000000000000000000000";
  const auto read = [=](const std::string& path) {
    const CornerCache cache(std::filesystem::path(path).parent_path(), AprilGrid{}, {});
    // As it is, and as a body under its right hash: random bytes seldom have it.
    if (const auto found = cache.find(kKey)) cache.store(kKey, *found);
    const std::string bytes = readBytes(path);
    const std::string body = bytes.substr(std::min<std::size_t>(bytes.size(), 37));
    writeBytes(path, bytes.substr(0, 20) + contentHash(body) + "\n" + body);
    const auto found = cache.find(kKey);
    if (!found) return;
    const std::string stored = readBytes(path);
    cache.store(kKey, *found);
    if (cache.find(kKey)->corners.size() != found->corners.size()) throw Unstable("other corners");
    if (readBytes(path) != stored) throw Unstable("a file that was found is stored otherwise");
  };
  const auto seeds = [=] {
    const Scratch scratch;
    const CornerCache cache(scratch.path("."), AprilGrid{}, {});
    std::vector<std::string> texts;
    for (const std::size_t count : {0, 1, 6}) {
      Detection found;
      found.corners.assign(count, Corner{3, {100.25, 200.5}});
      if (count > 1) found.spacing = 0.3;
      cache.store(kKey, found);
      texts.push_back(readBytes(scratch.path(std::string(kKey) + ".corners")));
    }
    return texts;
  };
  return {read, seeds, {}, std::string(kKey) + ".corners"};
}

}  // namespace plumbline::fuzz

// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/kalibr/run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "datasets/files/file_io.h"
#include "datasets/files/table.h"
#include "datasets/files/yaml_map.h"
#include "datasets/trajectory/trajectory_reader.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using Kind = KalibrFileKind;
using Files = std::map<Kind, std::vector<std::string>>;

// Rounding to eight decimals costs 5e-9; the rest is room.
constexpr double kRounding = 2e-8;  // the text has eight decimals

// By keys that the one kind alone has; densities stand at the top of an imu.yaml that a user wrote,
// and below imu0 in one that Kalibr wrote.
std::optional<Kind> yamlKind(const std::string& path) {
  const YamlMap file = YamlMap::load(path, "Kalibr's output");
  if (file.hasMap("cam0")) {
    if (!file.map("cam0", "a camera").has("camera_model")) return std::nullopt;
    // Any camera may place the IMU; the others follow by the chain.
    for (int i = 0; file.has("cam" + std::to_string(i)); ++i) {
      const std::string key = "cam" + std::to_string(i);
      if (!file.hasMap(key)) continue;
      const YamlMap camera = file.map(key, "a camera");
      if (camera.has("T_cam_imu") || camera.has("T_imu_cam")) return Kind::kCamchainImu;
    }
    return Kind::kCamchain;
  }
  const YamlMap imu = file.hasMap("imu0") ? file.map("imu0", "an IMU") : file;
  return imu.has("gyroscope_noise_density") ? std::optional(Kind::kImu) : std::nullopt;
}

std::optional<Kind> textKind(std::string_view text) {
  TextLines lines(text);
  if (!lines.next()) return std::nullopt;
  if (lines.text().starts_with("Calibration results")) {
    const bool cameras = text.find("Camera-system parameters") != std::string_view::npos;
    return cameras ? Kind::kResultsCameras : Kind::kResultsImu;
  }
  return isKalibrPosesHeader(lines.text()) ? std::optional(Kind::kPoses) : std::nullopt;
}

/// Equal up to the text's rounding, relative for numbers above 1.
bool isNear(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         (a - b).cwiseAbs().maxCoeff() <= kRounding * std::max(1.0, b.cwiseAbs().maxCoeff());
}

// Each tool's text by what that tool estimated: the projections, or the cameras' places at the IMU.
bool belongs(const KalibrResults& text, const KalibrCamchain& chain) {
  if (text.cameras.size() != chain.cameras.size()) return false;
  for (std::size_t i = 0; i < chain.cameras.size(); ++i) {
    const KalibrTextCamera& a = text.cameras[i];
    const KalibrCamera& b = chain.cameras[i];
    if (text.tool == KalibrResults::Tool::kCameras) {
      if (!isNear(a.projection, b.intrinsics.projection)) return false;
    } else if (!a.T_cam_imu || !b.T_cam_imu ||
               boxminus(*a.T_cam_imu, *b.T_cam_imu).cwiseAbs().maxCoeff() > 1e-6) {
      return false;
    }
  }
  return true;
}

bool belongs(const KalibrImuFile& file, const ImuNoise& noise) {
  const ImuNoise& own = file.imus.front().noise;
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(b); };
  return near(own.gyro_density, noise.gyro_density) &&
         near(own.accel_density, noise.accel_density) && near(own.rate_hz, noise.rate_hz);
}

// Names are the user's, and a folder may hold several runs: files are told by content alone.
Files filesIn(const fs::path& folder) {
  Files files;
  std::vector<std::string> paths;
  std::error_code fault;  // of a link that leads nowhere
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file(fault)) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());  // nothing depends on the order of the listing
  for (const std::string& path : paths) {
    if (const auto kind = kalibrFileKind(path)) files[*kind].push_back(path);
  }
  return files;
}

// The camera-IMU tool starts from the camera tool's camchain and keeps its intrinsics, so that
// equal intrinsics make a pair.
bool haveSameIntrinsics(const KalibrCamchain& a, const KalibrCamchain& b) {
  const auto projection = [](const KalibrCamera& c) { return c.intrinsics.projection; };
  return std::ranges::equal(a.cameras, b.cameras, isNear, projection, projection);
}

/// A file beside the camchain; nothing, and a remark, where it cannot be read: it may be another
/// run's.
template <class Read>
auto readBeside(const std::string& path, Read read, KalibrRun& run)
    -> std::optional<decltype(read(path))> {
  try {
    return read(path);
  } catch (const InputError& error) {
    run.remarks.emplace_back(error.what());
    return std::nullopt;
  }
}

// The first text of a kind that rounds the chain's values.
std::optional<KalibrResults> textOf(const std::vector<std::string>& paths,
                                    const KalibrCamchain& chain, KalibrRun& run) {
  std::optional<KalibrResults> found;
  for (const std::string& path : paths) {
    auto text = readBeside(path, readKalibrResults, run);
    if (!text) continue;
    if (!belongs(*text, chain)) {
      run.remarks.push_back(path + " does not have the values of " + chain.path);
    } else if (found) {
      run.remarks.push_back(path + " is left out: " + found->path + " has the same values");
    } else {
      found = std::move(text);
    }
  }
  return found;
}

// A wrapped file (a result) goes before a flat one (an input).
std::optional<KalibrImuFile> imuOf(const std::vector<std::string>& paths, KalibrRun& run) {
  std::vector<KalibrImuFile> candidates;
  for (const std::string& path : paths) {
    auto file = readBeside(path, readKalibrImus, run);
    if (file && (!run.results_imu || belongs(*file, *run.results_imu->noise))) {
      candidates.push_back(std::move(*file));
    }
  }
  std::ranges::stable_sort(candidates, std::greater(), &KalibrImuFile::wrapped);
  // With a results text all candidates have its noise; without, only their form can tell.
  const bool clear = candidates.size() == 1 || run.results_imu ||
                     (candidates.size() > 1 && candidates[0].wrapped && !candidates[1].wrapped);
  if (!candidates.empty() && clear) return candidates.front();
  if (!paths.empty()) run.remarks.push_back("no imu.yaml is known to belong to the camchain");
  return std::nullopt;
}

std::string namesOf(const std::vector<std::string>& paths) {
  std::string text;
  for (const std::string& path : paths) {
    text += (text.empty() ? "" : ", ") + fs::path(path).filename().string();
  }
  return text;
}

// Of several camchains, the one that `path` is or whose values it rounds.
std::optional<KalibrCamchain> chainOf(const std::vector<std::string>& paths,
                                      const std::string& path) {
  if (paths.empty()) return std::nullopt;
  if (paths.size() == 1) return readKalibrCamchain(paths.front());
  if (std::find(paths.begin(), paths.end(), path) != paths.end()) return readKalibrCamchain(path);
  const auto kind = kalibrFileKind(path);
  if (kind == Kind::kResultsCameras || kind == Kind::kResultsImu) {
    const KalibrResults text = readKalibrResults(path);
    for (const std::string& candidate : paths) {
      KalibrCamchain chain = readKalibrCamchain(candidate);
      if (belongs(text, chain)) return chain;
    }
  }
  throw badInput(
      path, {InputFault::kAmbiguous, "contains several runs of Kalibr (" + namesOf(paths) + ")",
             "one run", "name the camchain that is meant"});
}

/// The camchain of the other tool in the same run: it has the same intrinsics.
std::optional<KalibrCamchain> partnerOf(const KalibrCamchain& chain,
                                        const std::vector<std::string>& paths, KalibrRun& run) {
  std::optional<KalibrCamchain> partner;
  std::vector<std::string> partners;
  for (const std::string& path : paths) {
    auto other = readBeside(path, readKalibrCamchain, run);
    if (!other) continue;
    if (haveSameIntrinsics(*other, chain)) {
      partners.push_back(path);
      partner = std::move(other);
    } else {
      run.remarks.push_back(path + " does not have the intrinsics of " + chain.path);
    }
  }
  if (partners.size() < 2) return partner;
  run.remarks.push_back("several camchains (" + namesOf(partners) + ") have the intrinsics of " +
                        chain.path);
  return std::nullopt;
}

/// The camchain that is named, or in a folder the camera-IMU tool's, decides which run it is.
void readChains(Files& files, const std::string& path, KalibrRun& run) {
  const auto kind = fs::is_directory(path) ? std::nullopt : kalibrFileKind(path);
  const bool cameras_first = kind == Kind::kCamchain || kind == Kind::kResultsCameras;
  const auto& first = files[cameras_first ? Kind::kCamchain : Kind::kCamchainImu];
  const auto& second = files[cameras_first ? Kind::kCamchainImu : Kind::kCamchain];
  auto chain = chainOf(first, path);
  auto other = chain ? partnerOf(*chain, second, run) : chainOf(second, path);
  run.cameras = std::move(cameras_first ? chain : other);
  run.camera_imu = std::move(cameras_first ? other : chain);
}

void readPoses(const std::string& path, KalibrRun& run) {
  auto file = readBeside(path, readKalibrPoses, run);
  if (!file) return;
  run.poses = std::move(file->trajectory);
  for (const std::string& remark : file->remarks) run.remarks.push_back(path + ": " + remark);
}

void addStandardDeviations(Calibration& calibration, const KalibrResults& text) {
  for (std::size_t i = 0; i < calibration.cameras.size() && i < text.cameras.size(); ++i) {
    CameraCalibration& camera = calibration.cameras[i];
    const KalibrTextCamera& printed = text.cameras[i];
    const Eigen::Index n = printed.projection_std.size() + printed.distortion_std.size();
    // Deviations of other intrinsics than these.
    if (!isNear(printed.projection, camera.intrinsics.projection)) continue;
    if (n != camera.intrinsics.stacked().size()) continue;
    Eigen::VectorXd std(n);
    std << printed.projection_std, printed.distortion_std;
    camera.intrinsics_std = std;
  }
}

}  // namespace

std::optional<KalibrFileKind> kalibrFileKind(const std::string& path) {
  try {
    const MappedFile file(path);
    if (const auto kind = textKind(file.text())) return kind;
    const std::string ending = fs::path(path).extension().string();
    // A parser of YAML builds a tree of everything before a key can be asked for, and a table of
    // hours of samples may lie in the folder.
    if (ending == ".csv" || file.text().size() > 1'000'000)
      return std::nullopt;  // no YAML of theirs
    return yamlKind(path);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Calibration KalibrRun::calibration() const {
  Calibration result = calibrationOf(camera_imu ? *camera_imu : *cameras);
  if (result.imu && imu) {
    result.imu->noise = imu->imus.front().noise;
    result.imu->rostopic = imu->imus.front().rostopic;
  } else if (result.imu && results_imu) {
    result.imu->noise = *results_imu->noise;
  }
  // Kalibr estimates gravity's direction; the norm of what it prints is the value that it took.
  if (result.imu && results_imu) result.imu->gravity_m_s2 = results_imu->gravity_F->norm();
  if (results_cameras) addStandardDeviations(result, *results_cameras);
  return result;
}

std::optional<KalibrResults> KalibrRun::results() const {
  return camera_imu ? results_imu : results_cameras;
}

KalibrRun readKalibrRun(const std::string& path) {
  const bool folder = fs::is_directory(path);
  if (!folder && !kalibrFileKind(path)) {
    (void)MappedFile(path);  // a missing file says so
    throw badInput(path, {InputFault::kUnknownFile, "this is not an output of Kalibr",
                          "camchain*.yaml, imu*.yaml, results-*.txt or poses-*.csv"});
  }
  const fs::path place = folder ? fs::path(path) : fs::absolute(path).parent_path();
  Files files = filesIn(place);
  // As filesIn() lists it, whatever separators were given.
  const std::string named = folder ? path : (place / fs::path(path).filename()).string();
  KalibrRun run;
  readChains(files, named, run);
  if (!run.camera_imu && !run.cameras) {
    throw badInput(path,
                   {InputFault::kUnknownFile, "there is no camchain of Kalibr", "camchain*.yaml",
                    "a results text is rounded: the values are in the YAML"});
  }
  if (run.cameras) {
    run.results_cameras = textOf(files[Kind::kResultsCameras], *run.cameras, run);
  }
  if (run.camera_imu) {
    run.results_imu = textOf(files[Kind::kResultsImu], *run.camera_imu, run);
    run.imu = imuOf(files[Kind::kImu], run);
  }
  const auto& poses = files[Kind::kPoses];
  if (poses.size() == 1) readPoses(poses.front(), run);
  if (poses.size() > 1) run.remarks.push_back("several files of poses (" + namesOf(poses) + ")");
  return run;
}

}  // namespace plumbline

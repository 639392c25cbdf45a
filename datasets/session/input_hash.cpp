// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/input_hash.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "datasets/files/content_hash.h"
#include "datasets/files/mapped_file.h"
#include "datasets/session/session_folder.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// One line for each file: its name and what stands for its content.
class Manifest {
 public:
  void addContent(const std::string& path, const std::string& name) {
    if (!fs::exists(path)) return;
    lines_.push_back(fmt::format("{} {}\n", name, toHex(contentHash(MappedFile(path).text()))));
  }

  void addSizes(const std::string& folder, const std::string& name) {
    if (!fs::is_directory(folder)) return;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string file = entry.path().filename().string();
      lines_.push_back(fmt::format("{}/{} {} bytes\n", name, file, entry.file_size()));
    }
  }

  std::string hash() {
    std::sort(lines_.begin(), lines_.end());
    std::string all;
    for (const std::string& line : lines_) all += line;
    return "xxh64:" + toHex(contentHash(all));
  }

 private:
  std::vector<std::string> lines_;
};

void addCamera(Manifest& manifest, const std::string& camera) {
  const std::string name = fs::path(camera).filename().string();
  for (const char* file : {"corners.csv", "data.csv", "sensor.yaml"}) {
    manifest.addContent(camera + "/" + file, name + "/" + file);
  }
  if (!fs::exists(camera + "/corners.csv")) manifest.addSizes(camera + "/data", name + "/data");
}

}  // namespace

std::string inputHash(const std::string& session, const SessionReadOptions& options,
                      const std::vector<std::string>& others) {
  const SessionFolder folder = findSession(session);
  Manifest manifest;
  const auto beside = [&](const std::string& name, const std::optional<std::string>& given) {
    const auto path = given ? given : findBeside(folder.beside, name);
    if (path) manifest.addContent(*path, name);
  };
  beside("target.yaml", options.target_path);
  for (const std::string& camera : folder.cameras) addCamera(manifest, camera);
  if (folder.imu && options.read_imu) {
    beside("imu.yaml", options.imu_path);
    manifest.addContent(*folder.imu + "/sensor.yaml", "imu0/sensor.yaml");
    manifest.addContent(*folder.imu + "/data.csv", "imu0/data.csv");
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    manifest.addContent(others[i], fmt::format("given/{}", i));
  }
  return manifest.hash();
}

}  // namespace plumbline

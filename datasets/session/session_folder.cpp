// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/session_folder.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/session/session_reader.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSessionLayout =
    "a EuRoC ASL folder: cam0/corners.csv (or cam0/data/<ns>.png), cam0/sensor.yaml, "
    "imu0/data.csv, target.yaml and imu.yaml, optionally below mav0/";

// N of "camN", or -1.
int cameraNumber(const std::string& name) {
  // A sign is no part of a number here.
  if (!name.starts_with("cam") || name.size() < 4 || !isDigit(name[3])) return -1;
  int number = -1;
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + 3, end, number);
  return error == std::errc() && stop == end ? number : -1;
}

std::vector<std::string> camerasIn(const fs::path& folder) {
  std::vector<std::pair<int, std::string>> found;
  std::error_code fault;  // of a link that leads nowhere
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const int number = cameraNumber(entry.path().filename().string());
    if (number >= 0 && entry.is_directory(fault)) found.emplace_back(number, entry.path().string());
  }
  // By number: cam10 comes behind cam2.
  std::sort(found.begin(), found.end());
  std::vector<std::string> folders;
  for (auto& [number, camera] : found) folders.push_back(std::move(camera));
  return folders;
}

// One line for each file that is read: its name and what stands for its content.
using FileLines = std::vector<std::string>;

void addContent(FileLines& lines, const std::string& path, const std::string& name) {
  if (!fs::exists(path)) return;
  lines.push_back(fmt::format("{} {}\n", name, contentHash(MappedFile(path).text())));
}

// Of images, gigabytes of which would have to be read for a hash.
void addSizes(FileLines& lines, const std::string& folder, const std::string& name) {
  if (!fs::is_directory(folder)) return;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file(fault)) continue;
    const std::string file = entry.path().filename().string();
    lines.push_back(fmt::format("{}/{} {} bytes\n", name, file, entry.file_size()));
  }
}

/// What it recorded: corners, or names and sizes of its images, which beside corners are not read.
void addViews(FileLines& lines, const std::string& camera, const std::string& name) {
  addContent(lines, camera + "/corners.csv", name + "/corners.csv");
  if (!fs::exists(camera + "/corners.csv")) addSizes(lines, camera + "/data", name + "/data");
}

void addCamera(FileLines& lines, const std::string& camera) {
  const std::string name = fs::path(camera).filename().string();
  for (const char* file : {"data.csv", "sensor.yaml"}) {
    addContent(lines, camera + "/" + file, name + "/" + file);
  }
  addViews(lines, camera, name);
}

/// Whether there is a corner, or else an image: tables of corners without a row are all alike.
bool hasViews(const std::string& camera) {
  const std::string corners = camera + "/corners.csv";
  if (!fs::exists(corners)) return true;
  const MappedFile file(corners);
  const std::string_view text = file.text();
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] != '#' && text[at] != '\n' && text[at] != '\r') return true;
    at = std::min(text.find('\n', at), text.size());
  }
  return false;
}

std::string hashOf(FileLines lines) {
  // A folder is listed in no order.
  std::sort(lines.begin(), lines.end());
  return "xxh64:" + contentHash(fmt::format("{}", fmt::join(lines, "")));
}

}  // namespace

std::vector<std::string> besideSession(const std::string& path) {
  const fs::path top = fs::weakly_canonical(path);
  // What stands in the folder that was named goes before the other level's.
  std::vector<std::string> folders{path};
  if (top.filename() == "mav0") {
    folders.push_back(top.parent_path().string());
  } else if (fs::is_directory(fs::path(path) / "mav0")) {
    folders.push_back((fs::path(path) / "mav0").string());
  }
  return folders;
}

SessionFolder findSession(const std::string& path) {
  if (!fs::exists(path)) {
    throw badInput(path, {InputFault::kMissingFile, "does not exist", kSessionLayout,
                          "check the path of the session"});
  }
  if (!fs::is_directory(path)) {
    throw badInput(path, {InputFault::kMissingFile, "is not a folder", kSessionLayout,
                          "give the session's folder"});
  }
  // "." and a path that ends in a slash have no name of their own.
  const fs::path top = fs::weakly_canonical(path);
  const bool is_mav = top.filename() == "mav0";
  SessionFolder folder;
  folder.name = (is_mav ? top.parent_path() : top).filename().string();
  if (!isUtf8(folder.name)) {
    throw badInput(path, {InputFault::kSyntax, "the name '" + folder.name + "' is not UTF-8",
                          "a name in UTF-8", "rename the folder, or link to it"});
  }
  folder.beside = besideSession(path);
  folder.root = is_mav ? path : folder.beside.back();  // its mav0, if it has one
  folder.cameras = camerasIn(folder.root);
  if (folder.cameras.empty()) {
    throw badInput(folder.root, {InputFault::kEmpty, "contains no camera folder (cam0, cam1, ...)",
                                 kSessionLayout, "give the folder that contains cam0"});
  }
  const fs::path imu = fs::path(folder.root) / "imu0";
  if (fs::is_directory(imu)) folder.imu = imu.string();
  return folder;
}

std::optional<std::string> findBeside(const std::vector<std::string>& folders,
                                      const std::string& name) {
  for (const std::string& folder : folders) {
    const fs::path candidate = fs::path(folder) / name;
    if (fs::exists(candidate)) return candidate.string();
  }
  return std::nullopt;
}

std::string inputHash(const std::string& session, const SessionReadOptions& options,
                      const std::vector<std::string>& others) {
  const SessionFolder folder = findSession(session);
  FileLines lines;
  const auto beside = [&](const std::string& name, const std::optional<std::string>& given) {
    const auto path = given ? given : findBeside(folder.beside, name);
    if (path) addContent(lines, *path, name);
  };
  beside("target.yaml", options.target_path);
  for (const std::string& camera : folder.cameras) addCamera(lines, camera);
  if (folder.imu && options.read_imu) {
    beside("imu.yaml", options.imu_path);
    addContent(lines, *folder.imu + "/sensor.yaml", "imu0/sensor.yaml");
    addContent(lines, *folder.imu + "/data.csv", "imu0/data.csv");
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    addContent(lines, others[i], fmt::format("given/{}", i));
  }
  return hashOf(std::move(lines));
}

std::vector<std::string> cameraHashes(const std::string& session) {
  std::vector<std::string> hashes;
  for (const std::string& camera : findSession(session).cameras) {
    FileLines lines;
    // Under any name: a folder may have been renamed.
    if (hasViews(camera)) addViews(lines, camera, "");
    if (!lines.empty()) hashes.push_back(hashOf(std::move(lines)));
  }
  return hashes;
}

}  // namespace plumbline

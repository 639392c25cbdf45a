// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>

#include "datasets/bag/bag.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kConvert = "convert a copy with `ros2 bag convert` to sqlite3, uncompressed";

/// How files of a kind begin.
constexpr std::string_view kRos1 = "#ROSBAG V2.0";
constexpr std::string_view kOlderRos1 = "#ROSBAG V1";
constexpr std::string_view kSqlite = "SQLite format 3";
constexpr std::string_view kMcap = "\x89MCAP";
constexpr std::string_view kZstd = "\x28\xb5\x2f\xfd";

std::string beginningOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw badInput(path, {InputFault::kMissingFile, "cannot be opened", "a bag of ROS"});
  }
  std::string begin(16, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return begin;
}

/// The files that rosbag2's metadata.yaml lists, in its order.
std::unique_ptr<Bag> openRos2Folder(const std::string& folder) {
  const std::string path = (fs::path(folder) / kMetadata).string();
  if (!fs::is_regular_file(path)) {
    throw badInput(folder, {InputFault::kMissingFile, "holds no metadata.yaml",
                            "a bag of ROS 2, or its .db3 files",
                            "a session in EuRoC's layout needs no import"});
  }
  const YamlMap info = YamlMap::load(path, "rosbag2's metadata")
                           .map("rosbag2_bagfile_information", "what `ros2 bag record` writes");
  const std::string storage = info.textOr("storage_identifier", "sqlite3");
  const std::string compression = info.textOr("compression_format", "");
  if (storage != "sqlite3" || !compression.empty()) {
    throw info.fault(compression.empty() ? "storage_identifier" : "compression_format",
                     {InputFault::kUnsupported,
                      "storage " + storage + (compression.empty() ? "" : ", " + compression) +
                          " is not supported",
                      "storage sqlite3 without compression", kConvert});
  }
  std::vector<std::string> files;
  for (const YAML::Node& file : info.node("relative_file_paths")) {
    files.push_back((fs::path(folder) / fs::path(file.as<std::string>()).filename()).string());
    if (!fs::is_regular_file(files.back())) {
      throw info.fault("relative_file_paths",
                       {InputFault::kMissingFile, files.back() + " is missing"});
    }
  }
  if (files.empty()) {
    throw info.fault("relative_file_paths", {InputFault::kEmpty, "the bag has no files"});
  }
  return openRos2Bag(folder, files);
}

}  // namespace

std::unique_ptr<Bag> openBag(const std::string& path) {
  if (fs::is_directory(path)) return openRos2Folder(path);
  const std::string begin = beginningOf(path);
  if (begin.starts_with(kRos1)) return openRos1Bag(path);
  if (begin.starts_with(kSqlite)) return openRos2Bag(path, {path});
  if (begin.starts_with(kMcap) || begin.starts_with(kZstd)) {
    throw badInput(path,
                   {InputFault::kUnsupported,
                    begin.starts_with(kMcap) ? "MCAP is not supported yet" : "is compressed (zstd)",
                    "a .bag of ROS 1 or a .db3 of ROS 2", kConvert});
  }
  if (begin.starts_with(kOlderRos1)) {
    throw badInput(path, {InputFault::kUnsupported, "is of an older format of ROS 1", "format 2.0",
                          "convert a copy with `rosbag fix`"});
  }
  throw badInput(path, {InputFault::kUnknownFile, "is no bag of ROS",
                        "a .bag of ROS 1, or a .db3 of ROS 2 or its folder"});
}

}  // namespace plumbline

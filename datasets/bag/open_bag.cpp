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
constexpr const char* kConvert = "unpack a copy with `ros2 bag convert`";

/// How files of a kind begin.
constexpr std::string_view kRos1 = "#ROSBAG V2.0";
constexpr std::string_view kOlderRos1 = "#ROSBAG V1";
constexpr std::string_view kSqlite = "SQLite format 3";
constexpr std::string_view kMcap = "\x89MCAP";
constexpr std::string_view kZstd = "\x28\xb5\x2f\xfd";

std::string beginningOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw badInput(path, {InputFault::kMissingFile, "cannot be opened", "a recording of ROS"});
  }
  std::string begin(16, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return begin;
}

}  // namespace

std::string ros1Type(std::string type) {
  constexpr std::string_view kMiddle = "/msg/";
  const auto middle = type.find(kMiddle);
  if (middle != std::string::npos) type.replace(middle, kMiddle.size(), "/");
  return type;
}

std::vector<std::string> bagFiles(const std::string& path) {
  if (!fs::is_directory(path)) return {path};
  const std::string metadata = (fs::path(path) / kMetadata).string();
  if (!fs::is_regular_file(metadata)) {
    throw badInput(path, {InputFault::kMissingFile, "holds no metadata.yaml",
                          "the folder of a recording of ROS 2",
                          "of one that was not closed give the files (.mcap, .db3) themselves; a "
                          "session in EuRoC's layout needs no import"});
  }
  const YamlMap info = YamlMap::load(metadata, "rosbag2's metadata")
                           .map("rosbag2_bagfile_information", "what `ros2 bag record` writes");
  if (const std::string word = info.textOr("compression_format", ""); !word.empty()) {
    throw info.fault("compression_format",
                     {InputFault::kUnsupported, "compression " + word + " is not supported",
                      "no compression, or MCAP's own", kConvert});
  }
  std::vector<std::string> files;
  for (const YAML::Node& file : info.node("relative_file_paths")) {
    if (!file.IsScalar()) {
      throw info.fault("relative_file_paths", {InputFault::kSyntax, "is no list of names"});
    }
    files.push_back((fs::path(path) / fs::path(file.as<std::string>()).filename()).string());
    if (!fs::is_regular_file(files.back())) {
      throw info.fault("relative_file_paths",
                       {InputFault::kMissingFile, files.back() + " is missing"});
    }
  }
  if (files.empty()) {
    throw info.fault("relative_file_paths", {InputFault::kEmpty, "the recording has no files"});
  }
  return files;
}

std::unique_ptr<Bag> openBag(const std::string& path) {
  const std::string begin = beginningOf(path);
  if (begin.starts_with(kRos1)) return openRos1Bag(path);
  if (begin.starts_with(kSqlite)) return openRos2Bag(path);
  if (begin.starts_with(kMcap)) return openMcapBag(path);
  if (begin.starts_with(kZstd)) {
    throw badInput(path, {InputFault::kUnsupported, "is compressed (zstd)", "an uncompressed file",
                          "`zstd -d FILE -o COPY` unpacks it"});
  }
  if (begin.starts_with(kOlderRos1)) {
    throw badInput(path, {InputFault::kUnsupported, "is of an older format of ROS 1", "format 2.0",
                          "convert a copy with `rosbag fix`"});
  }
  throw badInput(path, {InputFault::kUnknownFile, "is no recording of ROS",
                        "a .bag of ROS 1, a .db3 of ROS 2 or an MCAP file"});
}

}  // namespace plumbline

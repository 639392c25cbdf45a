// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "datasets/files/file_io.h"
#include "evaluate/results/provenance.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

bool isImage(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

/// Images by size alone: reading gigabytes of them takes longer than what is done with them.
std::string hashOfFile(const fs::path& file) {
  return isImage(file) ? fmt::format("{} bytes", fs::file_size(file))
                       : contentHash(MappedFile(file.string()).text());
}

std::string hashOfFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  // A folder is listed in no order of its own.
  std::sort(files.begin(), files.end());
  std::string listed;
  for (const fs::path& file : files) {
    listed += fmt::format("{} {}\n", fs::relative(file, folder).string(), hashOfFile(file));
  }
  return contentHash(listed);
}

}  // namespace

std::string inputFilesHash(const std::vector<std::string>& inputs) {
  return inputFilesHash("", inputs);
}

std::string inputFilesHash(const std::string& recording, const std::vector<std::string>& inputs) {
  // A hash of the other inputs alone would call runs equal that are not.
  if (std::find(inputs.begin(), inputs.end(), "-") != inputs.end()) return "";
  std::string listed = recording;
  for (const std::string& input : inputs) {
    listed += "\n" + (fs::is_directory(input) ? hashOfFolder(input) : hashOfFile(input));
  }
  return "xxh64:" + contentHash(listed);
}

}  // namespace plumbline

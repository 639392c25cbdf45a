// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/input_hash.h"

#include <algorithm>
#include <filesystem>

#include "datasets/content_hash.h"
#include "datasets/internal/mapped_file.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

bool isText(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".csv" || extension == ".yaml" || extension == ".yml";
}

}  // namespace

std::string inputHash(const std::string& folder, const std::vector<std::string>& further) {
  std::vector<fs::path> files;
  constexpr auto kFollow = fs::directory_options::follow_directory_symlink;
  for (const auto& entry : fs::recursive_directory_iterator(folder, kFollow)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  ContentHash hash;
  for (const fs::path& file : files) {
    hash.add(fs::relative(file, folder).generic_string());
    if (isText(file)) {
      hash.add(MappedFile(file.string()).text());
    } else {
      hash.add(std::to_string(fs::file_size(file)));
    }
  }
  for (const std::string& file : further) hash.add(MappedFile(file).text());
  return "xxh3-128:" + hash.hex();
}

}  // namespace plumbline

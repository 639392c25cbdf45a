// SPDX-License-Identifier: BSD-3-Clause
// The exported files of third_party_configs, byte for byte; its README says how to write them anew.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

const fs::path kConfigs = fs::path(PLUMBLINE_SOURCE_DIR) / "third_party_configs";

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

// The version that wrote the goldens; it may be older than this one, and is all that may differ.
std::string versionOfGoldens() {
  const std::string text = contentOf(kConfigs / "kalibr/imu.yaml");
  const std::size_t begin = text.find(kExportMark) + std::string(kExportMark).size() + 1;
  return text.substr(begin, text.find(' ', begin) - begin);
}

class Goldens : public testing::TestWithParam<ExportTool> {};

TEST_P(Goldens, AreWhatTheSourceGives) {
  const std::string source = (kConfigs / "source/calibration.json").string();
  const auto exported = exportCalibration(readCalibration(source), GetParam(),
                                          {source, versionOfGoldens(), true, 20.0});
  const fs::path folder = kConfigs / toString(GetParam());
  std::set<std::string> names;
  for (const ExportFile& file : exported.files) {
    names.insert(file.name);
    EXPECT_EQ(file.text, contentOf(folder / file.name)) << file.name;
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    EXPECT_TRUE(names.contains(entry.path().filename().string()))
        << entry.path() << " is not among the files exported";
  }
}

INSTANTIATE_TEST_SUITE_P(EveryTool, Goldens, testing::ValuesIn(exportTools()), [](const auto& run) {
  std::string name = toString(run.param);
  std::erase_if(name, [](char c) { return c == '-' || c == '_'; });
  return name;
});

}  // namespace
}  // namespace plumbline

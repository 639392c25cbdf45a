// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/read_compared.h"

#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFolders = 8;

/// The name without ending, with `folders` of its folders in front.
std::string nameOf(const fs::path& path, int folders) {
  std::string name = path.stem().string();
  fs::path folder = path.parent_path();
  for (int i = 0; i < folders && folder.has_filename(); ++i, folder = folder.parent_path()) {
    name = folder.filename().string() + "/" + name;
  }
  return name;
}

std::vector<std::string> uniqueNames(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (int folders = 0; folders <= kMostFolders; ++folders) {
    names.clear();
    for (const std::string& path : paths) {
      names.push_back(nameOf(fs::absolute(path).lexically_normal(), folders));
    }
    if (std::set(names.begin(), names.end()).size() == names.size()) return names;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {  // the same file twice
    names[i] = fmt::format("{} #{}", nameOf(fs::path(paths[i]), 0), i + 1);
  }
  return names;
}

/// What Kalibr says of its own run, in sample.
void addOwnFigures(const KalibrResults& results, ComparedFile& file) {
  std::vector<std::string> parts;
  for (const KalibrTextCamera& camera : results.cameras) {
    if (const auto rms = camera.rmsPx()) {
      parts.push_back(fmt::format("{} {:.4f} px", camera.name, *rms));
    }
  }
  if (results.gyro_rad_s) {
    parts.push_back(fmt::format("gyroscope {:.3g} rad/s", results.gyro_rad_s->rms()));
  }
  if (results.accel_m_s2) {
    parts.push_back(fmt::format("accelerometer {:.3g} m/s^2", results.accel_m_s2->rms()));
  }
  if (parts.empty()) return;
  Finding f;
  f.rule = "Kalibr's own errors";
  f.evidence = fmt::format("RMS in sample, from its text: {}", fmt::join(parts, ", "));
  file.remarks.push_back(std::move(f));
}

void readKalibr(ComparedFile& file) {
  const KalibrRun run = readKalibrRun(file.path);
  file.compared.calibration = run.calibration();
  file.states_noise = run.imu.has_value() || (run.results_imu && run.results_imu->noise);
  if (const auto results = run.results()) addOwnFigures(*results, file);
  for (const std::string& remark : run.remarks) {
    Finding f;
    f.rule = "Files beside it";
    f.evidence = remark;
    file.remarks.push_back(std::move(f));
  }
}

}  // namespace

std::vector<ComparedFile> readCompared(const std::vector<std::string>& paths,
                                       const std::vector<std::string>& labels) {
  const std::vector<std::string> names = labels.empty() ? uniqueNames(paths) : labels;
  std::vector<ComparedFile> files;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    ComparedFile file;
    file.path = paths[i];
    file.compared.calibration = readCalibration(paths[i]);
    file.extras = readCalibrationExtras(paths[i]);
    file.states_noise = statesImuNoise(paths[i]);
    if (file.extras.tool == "kalibr") readKalibr(file);
    file.compared.label = names[i];
    file.compared.file = fs::path(paths[i]).filename().string();
    file.compared.tool = file.extras.tool;
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace plumbline

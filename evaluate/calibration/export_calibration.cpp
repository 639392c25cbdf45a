// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/export_calibration.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "calibrator/base/error.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/session/imu.h"
#include "evaluate/results/result_folder.h"
#include "generated/version.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Calibration requestedCalibration(const ExportRequest& request) {
  Calibration calibration =
      selectCameras(readCalibration(request.calibration), request.only, request.calibration);
  if (!request.imu) return calibration;
  if (!calibration.imu) {
    throw InputError(request.calibration, 0, "has no IMU; leave --imu out, or calibrate with one");
  }
  const ImuDescription imu = readImuDescription(*request.imu);
  calibration.imu->noise = imu.noise;
  if (!imu.rostopic.empty()) calibration.imu->rostopic = imu.rostopic;
  return calibration;
}

// A JSON file carries no mark of its own: the notes beside it do.
bool isOurs(const fs::path& path, const std::vector<ExportFile>& files) {
  if (contentOf(path).find(kExportMark) != std::string::npos) return true;
  if (path.extension() != ".json") return false;
  for (const ExportFile& file : files) {
    const fs::path beside = path.parent_path() / file.name;
    if (beside == path || !fs::is_regular_file(beside)) continue;
    if (contentOf(beside).find(kExportMark) != std::string::npos) return true;
  }
  return false;
}

void refuseForeignFiles(const fs::path& out, const std::vector<ExportFile>& files) {
  for (const ExportFile& file : files) {
    const fs::path path = out / file.name;
    if (!fs::is_regular_file(path) || isOurs(path, files)) continue;  // folders: the writer refuses
    throw InputError(path.string(), 0,
                     "exists already and no export of Plumbline wrote it; choose another --out or "
                     "remove it");
  }
}

}  // namespace

ExportOutcome exportCalibrationFile(const ExportRequest& request) {
  refuseUnwritable(request.out);
  const ExportOptions options{request.calibration, kVersion,
                              request.imu.has_value() || statesImuNoise(request.calibration),
                              request.camera_rate_hz};
  const ExportedFiles exported =
      exportCalibration(requestedCalibration(request), request.tool, options);
  const fs::path out(request.out);
  refuseForeignFiles(out, exported.files);
  std::vector<ResultFile> files;
  for (const ExportFile& file : exported.files) files.push_back({file.name, file.text});
  writeResultFiles(request.out, files);
  ExportOutcome outcome{{}, exported.warnings};
  for (const ExportFile& file : exported.files) outcome.paths.push_back((out / file.name).string());
  return outcome;
}

}  // namespace plumbline

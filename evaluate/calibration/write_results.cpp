// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/write_results.h"

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/file_io.h"
#include "evaluate/calibration/calibration_document.h"
#include "evaluate/results/result_folder.h"
#include "report/html/calibration/page.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

Calibration calibrationOf(const CalibrationRecord& record) {
  Calibration calibration;
  calibration.cameras = record.cameras();
  if (record.camera_imu) calibration.imu = record.camera_imu->imu;
  return calibration;
}

// Every name that a run may write.
const std::vector<std::string> kResultFiles{
    "calibration.json", "camchain-imucam.yaml", "camchain.yaml", "imu.yaml",
    "residuals.csv",    kRecordsFile,           "report.html"};

// Renders everything into `folder`.
void writeFiles(const CalibrationRecord& record, const fs::path& folder,
                const WriteOptions& options) {
  const auto write = [&](const char* name, const std::string& text) {
    writeFileAtomically((folder / name).string(), text);
  };
  const Calibration calibration = calibrationOf(record);
  const bool with_imu = calibration.imu.has_value();
  write("calibration.json", calibrationDocument(record));
  write(with_imu ? "camchain-imucam.yaml" : "camchain.yaml", kalibrCamchainText(calibration));
  if (with_imu) {
    write("imu.yaml", kalibrImuText(calibration.imu->noise, calibration.imu->rostopic));
  }
  if (options.residuals) write("residuals.csv", residualsTable(record));
  Store(folder / kRecordsFile).save(record);
  if (options.report) write("report.html", renderCalibrationPage(record));
}

}  // namespace

void writeCalibrationPage(const CalibrationRecord& record, const std::string& path) {
  writeFileAtomically(path, renderCalibrationPage(record));
}

void writeCalibrationResults(const CalibrationRecord& record, const std::string& out,
                             const WriteOptions& options) {
  writeResultFolder(out, kResultFiles,
                    [&](const fs::path& folder) { writeFiles(record, folder, options); });
}

}  // namespace plumbline

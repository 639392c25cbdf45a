// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/workflow/write_results.h"

#include <filesystem>
#include <system_error>

#include <unistd.h>

#include "calibrator/base/error.h"
#include "datasets/atomic_file.h"
#include "datasets/kalibr_writer.h"
#include "evaluate/workflow/calibration_document.h"
#include "report/html/calibration_page.h"
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

// A store with this record alone, in place of an older one.
void writeRecords(const CalibrationRecord& record, const fs::path& path) {
  const fs::path fresh = path.string() + ".new";
  std::error_code ignored;
  fs::remove(fresh, ignored);
  Store(fresh).save(record);
  fs::rename(fresh, path);
}

// The uppermost folder of `path` that does not exist; empty where all of it does.
fs::path firstMissing(const fs::path& path) {
  fs::path missing;
  std::error_code error;
  for (fs::path p = path; !p.empty() && !fs::exists(p, error); p = p.parent_path()) missing = p;
  return missing;
}

fs::path parentOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void writeFiles(const CalibrationRecord& record, const fs::path& folder,
                const WriteOptions& options) {
  // What a run does not write is removed, so that the folder never mixes the results of two runs.
  const auto write = [&](const char* name, bool wanted, const auto& text) {
    std::error_code ignored;
    if (wanted) {
      writeFileAtomically((folder / name).string(), text());
    } else {
      fs::remove(folder / name, ignored);
    }
  };
  const Calibration calibration = calibrationOf(record);
  const auto camchain = [&] { return kalibrCamchainText(calibration); };
  const bool with_imu = calibration.imu.has_value();
  write("calibration.json", true, [&] { return calibrationDocument(record); });
  write("camchain-imucam.yaml", with_imu, camchain);
  write("camchain.yaml", !with_imu, camchain);
  write("imu.yaml", with_imu,
        [&] { return kalibrImuText(calibration.imu->noise, calibration.imu->rostopic); });
  write("residuals.csv", options.residuals, [&] { return residualsTable(record); });
  writeRecords(record, folder / kRecordsFile);
  write("report.html", options.report, [&] { return renderCalibrationPage(record); });
}

}  // namespace

void writeCalibrationPage(const CalibrationRecord& record, const std::string& path) {
  writeFileAtomically(path, renderCalibrationPage(record));
}

void refuseUnwritable(const std::string& out) {
  if (out.empty()) throw InputError("--out is empty: expected the folder for the results");
  const fs::path missing = firstMissing(out);
  const fs::path there = missing.empty() ? fs::path(out) : parentOf(missing);
  std::error_code error;
  if (!fs::is_directory(there, error)) {
    throw InputError(there.string(), 0,
                     "is in the way: expected a folder for the results; give another --out");
  }
  if (::access(there.c_str(), W_OK | X_OK) != 0) {
    throw InputError(there.string(), 0,
                     "is not writable: expected a folder for the results; give another --out");
  }
}

void writeCalibrationResults(const CalibrationRecord& record, const std::string& out,
                             const WriteOptions& options) {
  refuseUnwritable(out);
  const fs::path missing = firstMissing(out);
  try {
    fs::create_directories(out);
    writeFiles(record, out, options);
  } catch (...) {
    std::error_code ignored;
    if (!missing.empty()) fs::remove_all(missing, ignored);
    throw;
  }
}

}  // namespace plumbline

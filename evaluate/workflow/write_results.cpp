// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/workflow/write_results.h"

#include <array>
#include <filesystem>
#include <system_error>

#include <unistd.h>

#include "calibrator/base/error.h"
#include "datasets/atomic_file.h"
#include "datasets/kalibr_writer.h"
#include "datasets/pending_folder.h"
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

// Every name that a run may write.
constexpr std::array kResultFiles{"calibration.json", "camchain-imucam.yaml", "camchain.yaml",
                                  "imu.yaml",         "residuals.csv",        kRecordsFile,
                                  "report.html"};

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

void refuseFoldersInTheWay(const fs::path& out) {
  for (const char* name : kResultFiles) {
    if (!fs::is_directory(out / name)) continue;
    throw InputError((out / name).string(), 0,
                     "is a folder where a result belongs; remove it or give another --out");
  }
}

// Moves what was written into its place; what this run did not write is removed, so that the folder
// never mixes the results of two runs.
void moveFiles(const fs::path& from, const fs::path& out) {
  for (const char* name : kResultFiles) {
    if (fs::exists(from / name)) {
      fs::rename(from / name, out / name);
    } else {
      fs::remove(out / name);
    }
  }
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
    refuseFoldersInTheWay(out);
    const PendingFolder pending(fs::path(out) / ".results");  // never committed: its files move
    writeFiles(record, pending.path(), options);
    moveFiles(pending.path(), out);
  } catch (...) {
    std::error_code ignored;
    if (!missing.empty()) fs::remove_all(missing, ignored);
    throw;
  }
}

}  // namespace plumbline

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/workflow/write_results.h"

#include <filesystem>
#include <system_error>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/atomic_file.h"
#include "datasets/simulated_files.h"
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

// Kalibr's imu.yaml as its calibrator writes it.
std::string imuYaml(const ImuCalibration& imu) {
  return fmt::format(
      "imu0:\n  T_i_b:\n  - [1.0, 0.0, 0.0, 0.0]\n  - [0.0, 1.0, 0.0, 0.0]\n"
      "  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n"
      "  accelerometer_noise_density: {}\n  accelerometer_random_walk: {}\n"
      "  gyroscope_noise_density: {}\n  gyroscope_random_walk: {}\n"
      "  model: calibrated\n  rostopic: {}\n  time_offset: 0.0\n  update_rate: {}\n",
      imu.noise.accel_density, imu.noise.accel_random_walk, imu.noise.gyro_density,
      imu.noise.gyro_random_walk, imu.rostopic.empty() ? "/imu0" : imu.rostopic, imu.noise.rate_hz);
}

// A store with this record alone, in place of an older one.
void writeRecords(const CalibrationRecord& record, const fs::path& path) {
  const fs::path fresh = path.string() + ".new";
  std::error_code ignored;
  fs::remove(fresh, ignored);
  Store(fresh).save(record);
  fs::rename(fresh, path);
}

}  // namespace

void writeCalibrationPage(const CalibrationRecord& record, const std::string& path) {
  writeFileAtomically(path, renderCalibrationPage(record));
}

void writeCalibrationResults(const CalibrationRecord& record, const std::string& out,
                             const WriteOptions& options) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw InputError(out, 0, "cannot be made: " + error.message());
  const fs::path folder(out);
  const auto write = [&](const char* name, const std::string& text) {
    writeFileAtomically((folder / name).string(), text);
  };
  const Calibration calibration = calibrationOf(record);
  write("calibration.json", calibrationDocument(record));
  write(calibration.imu ? "camchain-imucam.yaml" : "camchain.yaml", camchainText(calibration));
  if (calibration.imu) write("imu.yaml", imuYaml(*calibration.imu));
  if (options.residuals) write("residuals.csv", residualsTable(record));
  writeRecords(record, folder / kRecordsFile);
  if (options.report) writeCalibrationPage(record, (folder / "report.html").string());
}

}  // namespace plumbline

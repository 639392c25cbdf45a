// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/imu.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "datasets/calibration/kalibr/camchain.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/stamps.h"

namespace plumbline {
namespace {

constexpr const char* kImuKeys =
    "update_rate [Hz] and accelerometer_noise_density, accelerometer_random_walk, "
    "gyroscope_noise_density, gyroscope_random_walk (continuous-time densities), flat or below "
    "imu0:";
constexpr const char* kRefusedModel =
    "IMU scale and misalignment are not supported yet (they would be silently ignored); calibrate "
    "with model: calibrated";

/// Scale, misalignment and axes that Kalibr estimated would have to be applied to the samples
/// first.
void refuseModel(const YamlMap& map) {
  const std::string model = map.textOr("model", "calibrated");
  // OpenVINS' words for how its matrices are meant, which refuseDistorted() judges.
  if (model == "calibrated" || model == "kalibr" || model == "rpng") return;
  throw map.fault("model", {InputFault::kUnsupported, "the IMU model is '" + model + "'",
                            "model: calibrated", kRefusedModel});
}

void refuseDistorted(const YamlMap& map, const KalibrImu& imu) {
  if (!imu.isDistorted()) return;
  const char* const key = imu.openvins_distorted      ? "Tw"
                          : map.has("accelerometers") ? "accelerometers"
                                                      : "gyroscopes";
  throw map.fault(key, {InputFault::kUnsupported,
                        std::string(imu.openvins_distorted
                                        ? "Tw, Ta, R_IMUtoGYRO, R_IMUtoACC or Tg"
                                        : "M, A or C_gyro_i of the accelerometers or gyroscopes") +
                            " is not that of an IMU without faults",
                        "model: calibrated", kRefusedModel});
}

/// Kalibr's results stand below imu0:, its inputs at the top.
YamlMap unwrapped(const YamlMap& file) {
  for (const std::string& key : file.keys()) {
    // Of a second IMU nothing would be read, though its user believes it to count.
    if (key.starts_with("imu") && key != "imu0" && file.hasMap(key)) {
      throw file.fault(key,
                       {InputFault::kUnsupported, "the file describes a second IMU ('" + key + "')",
                        "one IMU, imu0", "delete the other IMUs"});
    }
  }
  return file.has("imu0") ? file.map("imu0", kImuKeys) : file;
}

constexpr const char* kImuLayout = "timestamp [ns], w_x, w_y, w_z [rad/s], a_x, a_y, a_z [m/s^2]";

bool isOneOf(const std::string& name, const char* part,
             std::initializer_list<const char*> prefixes) {
  return name.find(part) != std::string::npos ||
         std::ranges::any_of(prefixes, [&](const char* p) { return name.starts_with(p); });
}

/// "w_RS_S_x", "gyro_x", "xgyro", "gx", "omega_x", "angular_velocity.x" in small letters.
bool namesGyro(const std::string& name) {
  return isOneOf(name, "gyr", {"w", "omega", "ang", "g_", "gx", "gy", "gz"});
}
// Not "a" alone, with which "angular" begins, too.
bool namesAccel(const std::string& name) {
  return isOneOf(name, "acc", {"a_", "ax", "ay", "az", "lin", "f_"});
}

/// What the header states and the numbers cannot tell: degrees, or g.
void refuseUnits(const std::string& path, int line, const std::string& name) {
  const bool degrees = name.find("deg") != std::string::npos;
  const bool gravities = name.find("[g]") != std::string::npos;
  if (!degrees && !gravities) return;
  throw badInput(path, line,
                 {InputFault::kWrongUnit, "the header states '" + name + "'", "rad/s and m/s^2",
                  degrees ? "multiply the rates by pi / 180" : "multiply by 9.80665"});
}

// Whether a line of the header puts the accelerations before the rates.
bool accelerationFirst(const std::string& path, std::string_view text,
                       const std::vector<std::string_view>& header) {
  for (const std::string_view line : header) {
    std::vector<std::string> names;
    for (const std::string_view name : csvCells(line)) names.push_back(lowered(name));
    if (names.back().empty()) names.pop_back();  // a comma may end the line, as a row
    // A stamp and six axes; a table of another width is refused at its first row.
    if (names.size() != 7) continue;
    const auto number = 1 + std::count(text.data(), line.data(), '\n');
    for (std::size_t i = 1; i < 7; ++i) refuseUnits(path, static_cast<int>(number), names[i]);
    const auto all = [&](std::size_t first, bool (*is)(const std::string&)) {
      return is(names[first]) && is(names[first + 1]) && is(names[first + 2]);
    };
    if (all(1, namesAccel) && all(4, namesGyro)) return true;
  }
  return false;
}

}  // namespace

ImuDescription readImuDescription(const std::string& path) {
  const YamlMap file = YamlMap::load(path, kImuKeys);
  const YamlMap map = unwrapped(file);
  refuseModel(map);
  // The word of EuRoC's sensor.yaml.
  const bool euroc = map.has("rate_hz") && !map.has("update_rate");
  KalibrImu imu = kalibrImu(map, euroc ? "rate_hz" : "update_rate");
  refuseDistorted(map, imu);
  return {imu.noise, std::move(imu.rostopic)};
}

std::vector<ImuSample> readImuSamples(const std::string& path) {
  const MappedFile file(path);
  TextTable table(path, file.text(), kImuLayout);
  const bool accel_first = accelerationFirst(path, file.text(), table.readHeader());
  std::vector<ImuSample> samples;
  while (table.nextRow()) {
    ImuSample sample;
    sample.t = table.stamp();
    if (!samples.empty()) {
      checkAscending(table, sample.t, samples.back().t,
                     "sort the rows by time; was the clock set back?");
    }
    Eigen::Vector3d& first = accel_first ? sample.accel : sample.gyro;
    Eigen::Vector3d& second = accel_first ? sample.gyro : sample.accel;
    for (int i = 0; i < 3; ++i) first[i] = table.number(accel_first ? "a" : "w");
    for (int i = 0; i < 3; ++i) second[i] = table.number(accel_first ? "w" : "a");
    table.endRow();
    samples.push_back(sample);
  }
  checkStampUnit(path, intervalsOf(samples), kShortestImuInterval, "samples");
  return samples;
}

}  // namespace plumbline

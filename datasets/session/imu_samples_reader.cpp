// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "datasets/files/csv_table.h"
#include "datasets/session/imu_reader.h"
#include "datasets/session/stamps.h"

namespace plumbline {
namespace {

constexpr const char* kLayout = "timestamp [ns], w_x, w_y, w_z [rad/s], a_x, a_y, a_z [m/s^2]";

std::string lowered(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool startsWith(const std::string& text, std::initializer_list<const char*> prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const char* prefix) { return text.rfind(prefix, 0) == 0; });
}

bool namesGyro(const std::string& name) { return startsWith(name, {"w", "gyr", "omega", "ang"}); }
bool namesAccel(const std::string& name) {
  return startsWith(name, {"a_", "ax", "ay", "az", "acc", "lin", "f_"});
}

void refuseUnits(const CsvTable& table, const std::string& name) {
  const bool degrees = name.find("deg") != std::string::npos;
  const bool gravities = name.find("[g]") != std::string::npos;
  if (!degrees && !gravities) return;
  throw badInput(table.path(), 1,
                 {"the header states '" + name + "'", "rad/s and m/s^2",
                  degrees ? "multiply the rates by pi / 180" : "multiply by 9.80665"});
}

// Whether the header puts the accelerations before the rates.
bool accelerationFirst(const CsvTable& table) {
  if (table.header().size() != 7) return false;
  std::vector<std::string> names;
  for (const std::string& name : table.header()) names.push_back(lowered(name));
  for (std::size_t i = 1; i < 7; ++i) refuseUnits(table, names[i]);
  const auto all = [&](std::size_t first, bool (*is)(const std::string&)) {
    return is(names[first]) && is(names[first + 1]) && is(names[first + 2]);
  };
  return all(1, namesAccel) && all(4, namesGyro);
}

void checkOrder(const CsvTable& table, TimeNs t, TimeNs before) {
  if (t > before) return;
  const bool twice = t == before;
  throw table.fault({twice ? fmt::format("the stamp {} is given twice", t)
                           : fmt::format("the stamp {} is earlier than that of the row above", t),
                     "stamps that ascend strictly",
                     twice ? duplicateCure(t) : "sort the rows by time; was the clock set back?"});
}

}  // namespace

std::vector<ImuSample> readImuSamples(const std::string& path) {
  CsvTable table(path, kLayout);
  const bool accel_first = accelerationFirst(table);
  std::vector<ImuSample> samples;
  std::vector<TimeNs> stamps;
  while (table.next()) {
    ImuSample sample;
    sample.t = table.stamp();
    if (!samples.empty()) checkOrder(table, sample.t, samples.back().t);
    Eigen::Vector3d& first = accel_first ? sample.accel : sample.gyro;
    Eigen::Vector3d& second = accel_first ? sample.gyro : sample.accel;
    for (int i = 0; i < 3; ++i) first[i] = table.number(accel_first ? "a" : "w");
    for (int i = 0; i < 3; ++i) second[i] = table.number(accel_first ? "w" : "a");
    table.endRow();
    samples.push_back(sample);
    stamps.push_back(sample.t);
  }
  checkStampUnit(path, stamps, kShortestImuInterval, "samples");
  return samples;
}

}  // namespace plumbline

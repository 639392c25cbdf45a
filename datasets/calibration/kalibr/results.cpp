// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "datasets/calibration/kalibr/run.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"

namespace plumbline {
namespace {

constexpr const char* kAgain = "copy the file again, or calibrate again";

bool isSeparator(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r'; }

/// Walks the lines of a results text; lists in brackets may go on over several lines. Numbers that
/// are not finite are an InputError at their line.
class ResultsLines {
 public:
  ResultsLines(std::string path, std::string_view text) : path_(std::move(path)) {
    TextLines lines(text);
    while (lines.next()) lines_.push_back(lines.text());
  }

  /// Moves to the next line, trimmed, from its first character; false at the end.
  bool next() {
    if (atEnd()) return false;
    ++index_;
    column_ = 0;
    return !atEnd();
  }

  /// Moves on to the next line that starts with `prefix`; false at the end.
  bool skipTo(std::string_view prefix) {
    while (next()) {
      if (startsWith(prefix)) return true;
    }
    return false;
  }

  bool startsWith(std::string_view prefix) const { return line().starts_with(prefix); }
  bool contains(std::string_view part) const { return line().find(part) != part.npos; }
  /// Whether a line that starts with `prefix` was passed.
  bool sawLine(std::string_view prefix) const {
    const auto end = lines_.begin() + std::min<std::ptrdiff_t>(index_ + 1, std::ssize(lines_));
    return std::any_of(lines_.begin(), end,
                       [&](std::string_view l) { return l.starts_with(prefix); });
  }

  /// The first "camN" in the line; empty if there is none.
  std::string cameraName() const {
    for (std::size_t at = line().find("cam"); at != std::string_view::npos;
         at = line().find("cam", at + 1)) {
      std::size_t end = at + 3;
      while (end < line().size() && std::isdigit(static_cast<unsigned char>(line()[end])) != 0)
        ++end;
      // Without a number it is part of a word, such as "camera".
      if (end > at + 3) return std::string(line().substr(at, end - at));
    }
    return {};
  }

  std::string between(char open, char close) const {
    const std::size_t from = line().find(open);
    const std::size_t to = line().rfind(close);
    if (from == std::string_view::npos || to == std::string_view::npos || to < from) return {};
    return std::string(line().substr(from + 1, to - from - 1));
  }

  /// The number that follows `key` (or `other`, where that is not in the line).
  double numberAfter(std::string_view key, std::string_view other = {}) const {
    const bool first = other.empty() || line().find(key) != std::string_view::npos;
    // "median " also begins "median: " where the colon follows.
    const std::string_view used = first ? key : other;
    const std::size_t at = line().find(used);
    if (at == std::string_view::npos) {
      throw fault(fmt::format("'{}' is missing", used), "a line as Kalibr writes it",
                  InputFault::kMissingKey);
    }
    std::string_view rest = trimmedText(line().substr(at + used.size()));
    // Also at the underscore of "T_1_0" and at the bracket of a unit.
    const std::size_t end = std::min(rest.find_first_of(" ,_[\t"), rest.size());
    return number(rest.substr(0, end));
  }

  /// The numbers of the next [...] from here on, nested or not, `count` of them if that is not 0.
  /// Over as many lines as it takes: a matrix has its rows in brackets of their own, and numpy,
  /// which prints these, breaks long arrays.
  std::vector<double> bracket(std::size_t count = 0) {
    std::vector<double> numbers;
    int depth = 0;
    while (!atEnd()) {
      for (; column_ < line().size(); ++column_) {
        const char c = line()[column_];
        if (c == '[') ++depth;
        if (c == ']' && depth > 0 && --depth == 0) {
          ++column_;
          if (count == 0 || numbers.size() == count) return numbers;
          throw fault(fmt::format("{} numbers in brackets", numbers.size()), std::to_string(count));
        }
        if (depth == 0 || isSeparator(c) || c == '[' || c == ']') continue;
        std::size_t end = column_;
        while (end < line().size() && !isSeparator(line()[end]) && line()[end] != ']') ++end;
        numbers.push_back(number(line().substr(column_, end - column_)));
        column_ = end - 1;
      }
      if (depth == 0) break;
      next();
    }
    if (depth > 0) throw ended("the end of a list in brackets");
    throw fault("no list in brackets", "[ numbers ]");
  }

  BadInput fault(const std::string& what, const std::string& expected,
                 InputFault code = InputFault::kBadNumber) const {
    const int shown = std::clamp(index_ + 1, 1, std::max<int>(1, static_cast<int>(lines_.size())));
    return badInput(path_, shown, {code, what, expected, kAgain});
  }

  /// The file ends before something that it should hold.
  BadInput ended(const std::string& missing) const {
    return badInput(path_, static_cast<int>(lines_.size()),
                    {InputFault::kTruncated, "the file ends before " + missing,
                     "the whole results text of Kalibr", kAgain});
  }

 private:
  bool atEnd() const { return index_ >= std::ssize(lines_); }
  std::string_view line() const {
    return index_ >= 0 && !atEnd() ? lines_[index_] : std::string_view();
  }

  double number(std::string_view text) const {
    const auto value = parseNumber(text);
    if (!value) throw fault(fmt::format("'{}' is not a number", text), "a number");
    if (std::isfinite(*value)) return *value;
    throw badInput(
        path_, index_ + 1,
        {InputFault::kNotFinite, fmt::format("a result is {}: the optimisation diverged", text),
         "finite numbers", "nothing in this file can be used: calibrate again"});
  }

  std::string path_;
  std::vector<std::string_view> lines_;
  int index_ = -1;
  std::size_t column_ = 0;  // where bracket() goes on
};

constexpr const char* kNoise = "the noise densities of 'IMU configuration'";

// The camera that the text of a line names: "cam1" in "Reprojection error (cam1):".
KalibrTextCamera& cameraNamed(KalibrResults& results, const ResultsLines& lines) {
  const std::string name = lines.cameraName();
  for (KalibrTextCamera& camera : results.cameras) {
    if (camera.name == name) return camera;
  }
  if (name.empty())
    throw lines.fault("no camera is named here", "cam0, cam1, ...", InputFault::kMissingKey);
  results.cameras.emplace_back();
  results.cameras.back().name = name;
  return results.cameras.back();
}

KalibrErrorStatistics statisticsOf(const ResultsLines& lines) {
  return {lines.numberAfter("mean "), lines.numberAfter("median ", "median: "),
          lines.numberAfter("std: ")};
}

/// Errors in units have them in brackets ("[px]"). Without brackets they are normalised by the
/// assumed noise, and of squares in old versions: none of ours is compared with them.
void readErrorLine(KalibrResults& results, const ResultsLines& lines) {
  if (lines.contains("no corners")) return;
  const KalibrErrorStatistics s = statisticsOf(lines);
  const bool raw = lines.contains("[");
  if (lines.startsWith("Reprojection")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    if (raw) camera.error_px = s;
  } else if (raw) {
    // Of the first IMU, as the noise.
    auto& imu = lines.startsWith("Gyro") ? results.gyro_rad_s : results.accel_m_s2;
    if (!imu) imu = s;
  }
}

Transform matrixOf(ResultsLines& lines) {
  const std::vector<double> numbers = lines.bracket(16);
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  return Transform::fromMatrix(T);
}

Eigen::VectorXd vectorOf(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

// "[mean] +- [std]": numpy's mean and std (ddof 0) per axis over all corners of the camera (Kalibr,
// CameraCalibrator.py, getReprojectionErrorStatistics()).
KalibrAxisStatistics axisStatistics(ResultsLines& lines) {
  return {vectorOf(lines.bracket(2)), vectorOf(lines.bracket(2))};
}

// ---- the camera tool

Transform baselineOf(ResultsLines& lines) {
  // Each is followed by "+- [deviations]", which the next skipTo() passes over.
  lines.skipTo("q:");
  const std::vector<double> q = lines.bracket(4);
  lines.skipTo("t:");
  const std::vector<double> t = lines.bracket(3);
  // x, y, z, w of the conjugate (JPL), as in the table of poses; the text states no order.
  return {Eigen::Quaterniond(q[3], -q[0], -q[1], -q[2]), Eigen::Vector3d(t[0], t[1], t[2])};
}

void readCameraToolLine(KalibrResults& results, ResultsLines& lines) {
  if (lines.startsWith("cam") && lines.contains("(") && lines.contains("):")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    camera.rostopic = lines.between('(', ')');
    return;
  }
  if (lines.startsWith("baseline T_")) {
    const double to = lines.numberAfter("baseline T_");
    if (!(to >= 1 && to < static_cast<double>(results.cameras.size())) || to != std::floor(to)) {
      throw lines.fault("a baseline of a camera that is not listed", "baseline T_1_0");
    }
    results.cameras[static_cast<std::size_t>(to)].T_cn_cnm1 = baselineOf(lines);
    return;
  }
  if (results.cameras.empty()) return;
  KalibrTextCamera& camera = results.cameras.back();
  if (lines.startsWith("distortion:")) {
    camera.distortion = vectorOf(lines.bracket());
    camera.distortion_std = vectorOf(lines.bracket());
  } else if (lines.startsWith("projection:")) {
    camera.projection = vectorOf(lines.bracket());
    camera.projection_std = vectorOf(lines.bracket());
  } else if (lines.startsWith("reprojection error:")) {
    camera.axis_error_px = axisStatistics(lines);
  }
}

/// A text that was cut is refused rather than taken for one of fewer cameras.
void requireCameraTool(const KalibrResults& results, const ResultsLines& lines) {
  for (const KalibrTextCamera& camera : results.cameras) {
    if (camera.projection.size() == 0) throw lines.ended(camera.name + "'s projection");
    if (!camera.axis_error_px) throw lines.ended(camera.name + "'s reprojection error");
  }
  if (results.cameras.empty()) throw lines.ended("the cameras' parameters");
  // The section that ends the text.
  if (!lines.sawLine("Target configuration")) throw lines.ended("'Target configuration'");
}

// ---- the camera-IMU tool

// The IMU's section lists first the accelerometer's densities, then the gyroscope's.
ImuNoise noiseOf(ResultsLines& lines) {
  ImuNoise noise;
  const auto valueOf = [&](const char* key) {
    if (!lines.skipTo(key)) throw lines.ended(kNoise);
    return lines.numberAfter(key);
  };
  noise.rate_hz = valueOf("Update rate:");
  if (!lines.skipTo("Accelerometer:")) throw lines.ended(kNoise);
  noise.accel_density = valueOf("Noise density:");
  noise.accel_random_walk = valueOf("Random walk:");
  if (!lines.skipTo("Gyroscope:")) throw lines.ended(kNoise);
  noise.gyro_density = valueOf("Noise density:");
  noise.gyro_random_walk = valueOf("Random walk:");
  return noise;
}

void readImuToolLine(KalibrResults& results, ResultsLines& lines) {
  // "error" or "Error", whichever the layout has.
  if (lines.contains("rror") && lines.contains("(") &&
      (lines.startsWith("Reprojection") || lines.startsWith("Gyro") ||
       lines.startsWith("Accelerometer error"))) {
    readErrorLine(results, lines);
  } else if (lines.startsWith("T_ci:")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    lines.next();
    camera.T_cam_imu = matrixOf(lines);
  } else if (lines.startsWith("timeshift cam")) {
    KalibrTextCamera& camera = cameraNamed(results, lines);
    if (!lines.next()) throw lines.ended("the time shift");
    camera.timeshift_cam_imu = lines.numberAfter("");
  } else if (lines.startsWith("Gravity vector")) {
    lines.next();
    results.gravity_F = vectorOf(lines.bracket(3));
  } else if (lines.startsWith("IMU configuration") && !results.noise) {
    // Of the first IMU, by which the rig goes; others have sections of their own.
    results.noise = noiseOf(lines);
  }
}

void requireImuTool(const KalibrResults& results, const ResultsLines& lines) {
  if (results.cameras.empty()) throw lines.ended("the cameras' errors");
  for (const KalibrTextCamera& camera : results.cameras) {
    if (!camera.T_cam_imu) throw lines.ended(camera.name + "'s T_ci");
  }
  if (!results.gravity_F) throw lines.ended("the gravity vector");
  if (!results.noise) throw lines.ended(kNoise);
}

}  // namespace

std::optional<double> KalibrTextCamera::rmsPx() const {
  if (axis_error_px) return axis_error_px->rms();
  if (error_px) return error_px->rms();
  return std::nullopt;
}

KalibrResults readKalibrResults(const std::string& path) {
  const MappedFile file(path);
  ResultsLines lines(path, file.text());
  KalibrResults results;
  results.path = path;
  if (!lines.next() || !lines.startsWith("Calibration results")) {
    throw lines.fault("this is not a results text of Kalibr",
                      "'Calibration results' in its first line", InputFault::kUnknownFile);
  }
  const bool cameras = file.text().find("Camera-system parameters") != std::string_view::npos;
  results.tool = cameras ? KalibrResults::Tool::kCameras : KalibrResults::Tool::kCameraImu;
  while (lines.next()) {
    cameras ? readCameraToolLine(results, lines) : readImuToolLine(results, lines);
  }
  cameras ? requireCameraTool(results, lines) : requireImuTool(results, lines);
  return results;
}

}  // namespace plumbline

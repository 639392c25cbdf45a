// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/export/tools.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

// Of a line of notes, its prefix included.
constexpr std::size_t kColumns = 96;

/// A topic with characters that would need quotes from any YAML reader gives way to the usual one.
std::string topicOr(const std::string& topic, const std::string& otherwise) {
  const bool good = std::ranges::all_of(topic, [](char c) { return isPlain(c, "_/"); });
  return good && !topic.empty() ? topic : otherwise;
}

std::string wrappedParagraph(const std::string& paragraph, const std::string& prefix) {
  std::istringstream words(paragraph);
  std::string text;
  std::string line = prefix;
  for (std::string word; words >> word;) {
    const bool first = line.size() == prefix.size();
    if (!first && line.size() + 1 + word.size() > kColumns) {
      text += line + "\n";
      line = prefix;
    }
    line += (line.size() == prefix.size() ? "" : " ") + word;
  }
  return text + line + "\n";
}

}  // namespace

void ExportSource::refuse(InputFault code, const std::string& what, const std::string& cure) const {
  throw badInput(options.source, {code, fmt::format("{}: {}", tool, what), "", cure});
}

void ExportSource::atMostCameras(std::size_t count) const {
  if (calibration.cameras.size() <= count) return;
  refuse(InputFault::kTooManyCameras,
         fmt::format("it supports at most {} cameras, this calibration has {}", count,
                     calibration.cameras.size()),
         "choose the cameras, e.g. cam0 and cam1");
}

void ExportSource::alike(const std::string& what, const char* verb, TextOf textOf,
                         const std::string& cure) const {
  const CameraCalibration& first = calibration.cameras.front();
  for (const CameraCalibration& camera : calibration.cameras) {
    const std::string one = textOf(first.intrinsics), other = textOf(camera.intrinsics);
    if (one == other) continue;
    refuse(InputFault::kTooManyCameras,
           fmt::format("it supports one {}, {} {} {} and {} {} {}", what, first.name, verb, one,
                       camera.name, verb, other),
           cure);
  }
}

void ExportSource::oneResolution() const {
  const auto sizeText = [](const Intrinsics& k) {
    return fmt::format("{}x{}", k.resolution.width, k.resolution.height);
  };
  alike("image size", "has", sizeText, "export one camera");
}

void ExportSource::oneModel() const {
  alike("camera model", "is", modelName,
        "calibrate both cameras with the same model, or export one camera");
}

const ImuCalibration& ExportSource::neededImu() const {
  if (!calibration.imu) {
    refuse(InputFault::kMissingKey, "it needs an IMU, and this calibration has none",
           "calibrate with the recording's IMU, or export to kalibr, orbslam3 or camera_info");
  }
  knownNoise();
  return *calibration.imu;
}

// What stands in a calibration whose file states no noise is nobody's measurement, and a tool would
// take it for one. A density of zero, which a file may hold, is a weight without bound.
void ExportSource::knownNoise() const {
  if (!calibration.imu) return;
  if (!options.noise_known) {
    refuse(InputFault::kNoImuNoise,
           "it needs the IMU's noise densities, and this file does not state them");
  }
  const ImuNoise& n = calibration.imu->noise;
  const bool positive = n.gyro_density > 0 && n.gyro_random_walk > 0 && n.accel_density > 0 &&
                        n.accel_random_walk > 0 && n.rate_hz > 0;
  if (!positive) {
    refuse(InputFault::kNoImuNoise, "a noise density or the IMU's rate is not positive");
  }
}

void ExportSource::refuseModel(const CameraCalibration& camera, const std::string& known) const {
  refuse(InputFault::kUnsupported,
         fmt::format("it cannot represent {}, which is {}; it has {}", camera.name,
                     modelName(camera.intrinsics), known),
         "calibrate this camera with a model that the tool has, or export to another tool "
         "(docs/export.md)");
}

const char* ExportSource::distortionWord(const CameraCalibration& camera,
                                         const PinholeWords& words) const {
  const Intrinsics& k = camera.intrinsics;
  const bool rational = words.rational != nullptr;
  if (isPinhole(k, DistortionModel::kEquidistant)) return words.equidistant;
  if (isPinhole(k, DistortionModel::kRational) && rational) return words.rational;
  if (isPinhole(k, DistortionModel::kRadtan) || isPinhole(k, DistortionModel::kNone)) {
    return words.radtan;
  }
  refuseModel(camera, rational ? "pinhole with radtan, equidistant, rational or no distortion"
                               : "pinhole with radtan, equidistant or no distortion");
}

std::string modelName(const Intrinsics& intrinsics) {
  return toString(intrinsics.projection_model) + "-" + toString(intrinsics.distortion_model);
}

bool isPinhole(const Intrinsics& intrinsics, DistortionModel distortion) {
  return intrinsics.projection_model == ProjectionModel::kPinhole &&
         intrinsics.distortion_model == distortion;
}

Eigen::Vector4d fourCoefficients(const Intrinsics& intrinsics) {
  if (intrinsics.distortion_model == DistortionModel::kNone) return Eigen::Vector4d::Zero();
  assert(intrinsics.distortion.size() == 4);
  return intrinsics.distortion;
}

std::string provenanceLine(const ExportOptions& options) {
  // A line end in a name would end the comment that it stands in.
  std::string file = std::filesystem::path(options.source).filename().string();
  std::ranges::replace_if(
      file, [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; }, '?');
  return fmt::format("{} {} from {}.", kExportMark, options.version, file);
}

std::string wrapped(const std::vector<std::string>& paragraphs, const std::string& prefix) {
  std::string text;
  for (const std::string& paragraph : paragraphs) text += wrappedParagraph(paragraph, prefix);
  return text;
}

std::string commentHeader(const ExportOptions& options,
                          const std::vector<std::string>& paragraphs) {
  return wrapped({provenanceLine(options)}, "# ") + wrapped(paragraphs, "# ");
}

// cv::FileStorage knows YAML by this first line and opens nothing without it.
std::string opencvHeader(const ExportOptions& options, const std::vector<std::string>& paragraphs) {
  return "%YAML:1.0\n---\n" + commentHeader(options, paragraphs);
}

std::string opencvMatrix(const std::string& key, const Transform& T, char dt) {
  return fmt::format("{}: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: {}\n   data: {}\n", key,
                     dt, sixteenNumbers(T, "         "));
}

// Row by row, as OpenCV stores a matrix.
std::string sixteenNumbers(const Transform& T, const std::string& indent) {
  const Eigen::Matrix4d M = T.matrix();
  std::string text = "[";
  for (Eigen::Index i = 0; i < 4; ++i) {
    const std::string row = yamlList(M.row(i));
    text += (i == 0 ? "" : ",\n" + indent + " ") + row.substr(1, row.size() - 2);
  }
  return text + "]";
}

std::string numberLine(const std::string& key, double value) {
  return fmt::format("{}: {}\n", key, yamlNumber(value));
}

long long nanosecondsOf(double seconds) { return std::llround(seconds * 1e9); }

// In both units, as tools differ in which they take.
std::string secondsText(double seconds) {
  return fmt::format("{} s ({} ns)", yamlNumber(seconds), nanosecondsOf(seconds));
}

std::vector<std::string> offsetWarnings(const ExportSource& source, const std::string& instead,
                                        const char* estimated_by) {
  const Calibration& calibration = source.calibration;
  std::vector<std::string> warnings;
  if (!calibration.imu) return warnings;
  if (!source.options.offset_known) {
    return {
        "The time offset between camera and IMU is unknown: the calibration does not state it. " +
        instead +
        (estimated_by != nullptr
             ? fmt::format(" Estimate it, or let {} do so ({}).", source.tool, estimated_by)
             : fmt::format(" Estimate it first: {} does not do so.", source.tool))};
  }
  for (std::size_t i = 1; i < calibration.cameras.size(); ++i) {
    if (!hasOwnOffset(calibration.imu->time_offsets, i)) continue;
    // t_imu = t_i + t_d,i = (t_i + shift) + t_d,0.
    const double shift = calibration.imu->timeOffset(i) - calibration.imu->timeOffset();
    warnings.push_back(fmt::format(
        "The cameras are not synchronised, but this tool uses one time offset, that of {}: add {} "
        "to the image stamps of {} first.",
        calibration.cameras.front().name, secondsText(shift), calibration.cameras[i].name));
  }
  return warnings;
}

std::string topicOf(const CameraCalibration& camera) {
  return topicOr(camera.rostopic, "/" + plainName(camera.name) + "/image_raw");
}

std::string topicOf(const ImuCalibration& imu) { return topicOr(imu.rostopic, "/imu0"); }

std::string plainName(const std::string& name) {
  std::string text = name;
  std::ranges::replace_if(
      text, [](char c) { return !isPlain(c, "_-"); }, '_');
  return text;
}

}  // namespace plumbline
